//! The report as a Markdown table.

use std::fmt::Write;

use super::Report;

/// The table, with a line that names scene and machine.
pub(crate) fn markdown(report: &Report) -> String {
    let machine = |key: &str| {
        report
            .machine
            .get(key)
            .map_or(String::new(), |v| v.as_str().map_or(v.to_string(), Into::into))
    };
    let gpu = report.device.as_ref().map_or(String::new(), |device| {
        format!("; GPU {}", device["name"].as_str().unwrap_or_default())
    });
    let mut text = format!(
        "`{}`: {} splats, {} × {} px, {} views × {} times; {} threads of {} ({}){}.\n\n",
        report.scene,
        report.splats,
        report.size[0],
        report.size[1],
        report.views,
        report.times.len(),
        machine("threads"),
        machine("cpu"),
        machine("simd"),
        gpu,
    );
    text += "| variant | median ms | p10–p90 ms | speed-up | PSNR dB | max abs. error | p99.9 | splats through the network | MB on the GPU |\n";
    text += "|---|---:|---:|---:|---:|---:|---:|---:|---:|\n";
    for row in &report.rows {
        let psnr = row.psnr.map_or("∞".into(), |p| format!("{p:.1}"));
        let kernel = match &row.network_kernel {
            Some(kernel) if kernel != "f32" => format!(" ({kernel})"),
            _ => String::new(),
        };
        let megabytes =
            row.device_bytes.map_or(String::new(), |bytes| format!("{:.1}", bytes as f64 / 1e6));
        // Writing to a String cannot fail.
        let _ = writeln!(
            text,
            "| {}{kernel} | {:.1} | {:.1}–{:.1} | {:.1}× | {psnr} | {:.1e} | {:.1e} | {} | {megabytes} |",
            row.variant,
            row.median_ms,
            row.p10_ms,
            row.p90_ms,
            row.speed_up,
            row.max,
            row.p999,
            row.deformed_splats,
        );
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::Row;

    #[test]
    fn every_row_shows_speed_and_error_side_by_side() {
        let row = Row {
            variant: "AVX2".into(),
            backend: "cpu".into(),
            median_ms: 12.34,
            p10_ms: 12.0,
            p90_ms: 13.0,
            frames: 20,
            speed_up: 8.0,
            psnr: Some(81.25),
            max: 2e-3,
            p999: 1e-6,
            deformed_splats: 7,
            ..Row::default()
        };
        let gpu = Row {
            variant: "GPU f16 network".into(),
            network_kernel: Some("f16".into()),
            device_bytes: Some(12_300_000),
            ..row.clone()
        };
        let report = Report {
            scene: "a.ply".into(),
            splats: 3,
            size: [4, 5],
            views: 2,
            times: vec![0.0],
            machine: serde_json::json!({"cpu": "X", "threads": 2, "simd": "AVX2"}),
            device: Some(serde_json::json!({"name": "Y"})),
            rows: vec![row, gpu],
        };
        let text = markdown(&report);
        assert!(
            text.contains("| AVX2 | 12.3 | 12.0–13.0 | 8.0× | 81.2 | 2.0e-3 | 1.0e-6 | 7 |  |"),
            "{text}"
        );
        assert!(text.contains("| GPU f16 network (f16) | 12.3 |"), "{text}");
        assert!(text.contains("| 7 | 12.3 |"), "{text}");
        assert!(text.contains("2 threads of X (AVX2); GPU Y"), "{text}");
    }
}
