//! The report as a plot: error over time.

use plotters::prelude::*;

use super::{Report, Row};

type PlotError = Box<dyn std::error::Error>;

/// Drawn for an image without error, dB: above anything that single precision reaches.
const EQUAL_IMAGES_DB: f64 = 110.0;
const SIZE: (u32, u32) = (860, 480);

/// An SVG with one point per variant: milliseconds to the right (logarithmic), PSNR upwards.
pub(crate) fn plot(report: &Report) -> Result<String, PlotError> {
    let mut svg = String::new();
    let root = SVGBackend::with_string(&mut svg, SIZE).into_drawing_area();
    root.fill(&WHITE)?;
    let quality = |row: &Row| row.psnr.unwrap_or(EQUAL_IMAGES_DB);
    let times = report.rows.iter().map(|row| row.median_ms.max(1e-3));
    let fastest = times.clone().fold(f64::INFINITY, f64::min);
    let slowest = times.fold(0.0, f64::max);
    let lowest = report.rows.iter().map(quality).fold(EQUAL_IMAGES_DB, f64::min);
    let mut chart = ChartBuilder::on(&root)
        .caption(format!("{}: error over time", report.scene), ("sans-serif", 18))
        .margin(14)
        .x_label_area_size(44)
        .y_label_area_size(56)
        .build_cartesian_2d(
            (fastest / 1.5..slowest * 3.0).log_scale(),
            (lowest - 8.0)..(EQUAL_IMAGES_DB + 8.0),
        )?;
    chart
        .configure_mesh()
        .x_desc("median time per frame, ms")
        .y_desc("PSNR against the f64 reference, dB")
        .light_line_style(WHITE)
        .draw()?;
    chart.draw_series(report.rows.iter().map(|row| {
        let color = match row.backend.as_str() {
            "reference" => BLACK,
            "gpu" => RGBColor(190, 80, 20),
            _ => RGBColor(20, 90, 180),
        };
        Circle::new((row.median_ms, quality(row)), 4, color.filled())
    }))?;
    chart.draw_series(report.rows.iter().enumerate().map(|(i, row)| {
        // Neighbours are labelled above and below in turn, or they would cover each other.
        let shift = if i % 2 == 0 { -14 } else { 4 };
        EmptyElement::at((row.median_ms, quality(row)))
            + Text::new(row.variant.clone(), (7, shift), ("sans-serif", 12))
    }))?;
    root.present()?;
    drop(chart);
    drop(root);
    Ok(svg)
}
