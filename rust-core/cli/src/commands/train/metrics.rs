//! Figures as JSON lines.

use std::fs::{File, OpenOptions};
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use trapeze_formats::write_atomically;
use trapeze_train::trainer::{Report, TrainingSummary};

use crate::error::CliError;

/// One line per report, and a last one. Steps of a trial may not be kept, so they are not written.
pub(super) struct Metrics {
    to: Sink,
}

enum Sink {
    Nowhere,
    StandardOutput,
    File { path: PathBuf, file: File },
}

#[derive(Debug, Serialize)]
struct Line {
    step: u32,
    seconds: f64,
    loss: f64,
    psnr: f64,
    splats: u32,
}

#[derive(Debug, Serialize)]
struct LastLine {
    done: bool,
    steps: u32,
    seconds: f64,
    steps_per_second: f64,
    splats: u32,
    test_psnr: Option<f64>,
    test_ssim: Option<f64>,
}

impl Metrics {
    /// To a file, to standard output (`-`) or nowhere. What a file has of steps up to `step` stays:
    /// it belongs to the run that goes on.
    pub(super) fn to(path: Option<&Path>, step: u32) -> Result<Self, CliError> {
        let to = match path {
            None => Sink::Nowhere,
            Some(path) if path.as_os_str() == "-" => Sink::StandardOutput,
            Some(path) => {
                let kept = kept_lines(path, step)?;
                write_atomically(path, |file| file.write_all(kept.as_bytes()))?;
                let file = OpenOptions::new().append(true).open(path);
                Sink::File { path: path.into(), file: file.map_err(|e| CliError::file(path, e))? }
            }
        };
        Ok(Self { to })
    }

    pub(super) fn report(&mut self, report: &Report) -> Result<(), CliError> {
        if report.is_trial {
            return Ok(());
        }
        self.write(&Line {
            step: report.step,
            seconds: report.seconds,
            loss: report.loss,
            psnr: report.psnr,
            splats: report.splats,
        })
    }

    pub(super) fn finish(&mut self, summary: &TrainingSummary) -> Result<(), CliError> {
        let test = summary.test.as_ref().map(|test| test.mean);
        self.write(&LastLine {
            done: true,
            steps: summary.steps,
            seconds: summary.seconds,
            steps_per_second: summary.steps_per_second,
            splats: summary.splats,
            test_psnr: test.map(|mean| mean.psnr),
            test_ssim: test.map(|mean| mean.ssim),
        })
    }

    fn write(&mut self, line: &impl Serialize) -> Result<(), CliError> {
        match &mut self.to {
            Sink::Nowhere => Ok(()),
            Sink::StandardOutput => crate::output::print_json(line),
            Sink::File { path, file } => {
                let json = serde_json::to_string(line).map_err(std::io::Error::from);
                json.and_then(|json| writeln!(file, "{json}"))
                    .map_err(|error| CliError::file(path.clone(), error))
            }
        }
    }
}

/// The lines of an earlier process up to `step`; one that it was killed over is left out.
fn kept_lines(path: &Path, step: u32) -> Result<String, CliError> {
    #[derive(Deserialize)]
    struct Stepped {
        step: u32,
    }
    if step == 0 || !path.exists() {
        return Ok(String::new());
    }
    let file = File::open(path).map_err(|error| CliError::file(path, error))?;
    let mut kept = String::new();
    for line in BufReader::new(file).lines() {
        let line = line.map_err(|error| CliError::file(path, error))?;
        if serde_json::from_str(&line).is_ok_and(|Stepped { step: at }| at <= step) {
            kept += &line;
            kept.push('\n');
        }
    }
    Ok(kept)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_resumed_run_continues_the_file_where_its_state_is() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("metrics.json");
        let report = |step: u32, is_trial: bool| Report {
            step,
            steps: 100,
            seconds: 0.5,
            steps_per_second: 2.0,
            loss: 0.25,
            psnr: 20.0,
            splats: 7,
            sh_degree: 0,
            is_trial,
        };
        let mut metrics = Metrics::to(Some(&path), 0).unwrap();
        for step in [10, 20, 30] {
            metrics.report(&report(step, false)).unwrap();
        }
        metrics.report(&report(40, true)).unwrap();
        let mut text = std::fs::read_to_string(&path).unwrap();
        assert_eq!(text.lines().count(), 3);
        assert_eq!(
            text.lines().next(),
            Some(r#"{"step":10,"seconds":0.5,"loss":0.25,"psnr":20.0,"splats":7}"#)
        );
        text += r#"{"step":4"#;
        std::fs::write(&path, text).unwrap();
        let mut metrics = Metrics::to(Some(&path), 20).unwrap();
        metrics.report(&report(30, false)).unwrap();
        let text = std::fs::read_to_string(&path).unwrap();
        let steps: Vec<&str> = text.lines().map(|line| &line[8..10]).collect();
        assert_eq!(steps, ["10", "20", "30"]);
    }
}
