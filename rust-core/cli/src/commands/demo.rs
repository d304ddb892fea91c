//! `trapeze demo`: the other commands, one after the other, and a page that shows what they made.

use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use clap::{Args, Parser};
use trapeze_formats::{ParseError, ReadError, load_scene, write_atomically};
use trapeze_query::crops::CropOptions;
use trapeze_query::ranking::QueryOptions;
use trapeze_train::trainer::TrainingSummary;

use super::Command;
use crate::error::CliError;
use crate::search::{SearchArguments, search};

#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// The scene folder to show.
    #[arg(long, default_value = "assets/sample-scene")]
    scene: PathBuf,
    /// Folder for everything that is made.
    #[arg(long, default_value = "out/demo")]
    out: PathBuf,
    /// Frames of the turntable.
    #[arg(long, default_value_t = 72)]
    frames: u32,
    /// The photographs to train on.
    #[arg(long, default_value = "assets/sample-dataset/transforms_static.json")]
    photographs: PathBuf,
    /// The search model's folder.
    #[arg(long, default_value = "assets/search-model")]
    models: PathBuf,
    /// Steps of the training run.
    #[arg(long, default_value_t = 3000)]
    steps: u32,
}

/// One picture of the demo: file, caption, and the arguments that make it.
struct Picture {
    file: &'static str,
    caption: &'static str,
    arguments: &'static [&'static str],
}

const VIEW: &[&str] = &["--orbit", "35,24", "--size", "800x600", "--fov", "34", "--zoom", "1.6"];

const PICTURES: [Picture; 8] = [
    Picture { file: "color-t0.png", caption: "Colour at t = 0", arguments: &[] },
    Picture { file: "color-t5.png", caption: "Colour at t = 0.5", arguments: &["--time", "0.5"] },
    Picture {
        file: "masked-t5.png",
        caption: "The same with 45 % of the splats left out of the network",
        arguments: &["--time", "0.5", "--static-percentile", "45"],
    },
    Picture {
        file: "clusters.png",
        caption: "Instance clusters",
        arguments: &["--mode", "clusters", "--time", "0.5"],
    },
    Picture {
        file: "depth.png",
        caption: "Depth, near is bright",
        arguments: &["--mode", "depth", "--time", "0.5"],
    },
    Picture {
        file: "motion.png",
        caption: "Motion: how far each splat ever moves, turns or grows",
        arguments: &["--mode", "motion", "--time", "0.5"],
    },
    Picture {
        file: "isolated.png",
        caption: "One cluster isolated",
        arguments: &["--isolate", "2", "--time", "0.5", "--background", "white"],
    },
    Picture {
        file: "hidden.png",
        caption: "The same cluster hidden",
        arguments: &["--hide", "2", "--time", "0.5", "--background", "white"],
    },
];

pub(crate) fn run(arguments: &Arguments) -> Result<(), CliError> {
    std::fs::create_dir_all(&arguments.out).map_err(|e| CliError::file(&arguments.out, e))?;
    let scene = arguments.scene.display().to_string();
    let out = |file: &str| arguments.out.join(file).display().to_string();
    let render = |file: &str, extra: &[&str]| {
        eprintln!("rendering {file}");
        let file = out(file);
        let mut words = vec!["render", &scene, "--out", &file];
        words.extend(VIEW);
        words.extend(extra);
        command(&words)
    };
    for picture in &PICTURES {
        render(picture.file, picture.arguments)?;
    }
    let frames = arguments.frames.to_string();
    let turntable = ["--path", "turntable", "--frames", &frames, "--size", "480x360"];
    eprintln!("rendering turntable.webp");
    let mut words = vec!["render", &scene, "--fov", "34", "--orbit", "35,24", "--zoom", "1.6"];
    let file = out("turntable.webp");
    words.extend(["--out", &file]);
    words.extend(turntable);
    command(&words)?;
    eprintln!("comparing speed and error of every variant");
    let folder = out("");
    command(&[
        "report", &scene, "--out", &folder, "--size", "640x480", "--fov", "34", "--zoom", "1.6",
    ])?;
    eprintln!("searching");
    let found = search_section(arguments)?;
    eprintln!("training on {}", arguments.photographs.display());
    train(arguments)?;
    let page = page(arguments, &found)?;
    let path = arguments.out.join("index.html");
    write_atomically(&path, |file| std::io::Write::write_all(file, page.as_bytes()))?;
    eprintln!("open {}", path.display());
    Ok(())
}

/// A short training run; one that was interrupted goes on.
fn train(arguments: &Arguments) -> Result<(), CliError> {
    let steps = arguments.steps.to_string();
    let photographs = arguments.photographs.display().to_string();
    let out = arguments.out.join("training").display().to_string();
    command(&[
        "train",
        &photographs,
        "--out",
        &out,
        "--resume",
        "--static",
        "--steps",
        &steps,
        "--preview",
        &steps,
        "--max-splats",
        "10000",
        "--random-splats",
        "6000",
        "--sh-degree",
        "1",
    ])
}

/// What the training run says of itself.
fn training_section(arguments: &Arguments) -> Result<String, CliError> {
    let folder = arguments.out.join("training");
    let path = folder.join("training.json");
    let summary: TrainingSummary = serde_json::from_str(&read(&path)?)
        .map_err(|error| ReadError::new(&path, ParseError::value("summary", "figures", error)))?;
    let test = summary.test.map_or("no view held out".into(), |test| {
        format!("{:.2} dB on {} views that it never saw", test.mean.psnr, test.views.len())
    });
    Ok(format!(
        "<h2>Training</h2>\n<p>{}: {} splats in {} steps, {:.0} s ({:.1} steps a second): {test}.</p>\n\
         <figure><img src=\"training/previews/step-{:06}.png\" alt=\"A training view, rendered\">\
         <figcaption>A training view as the trained splats show it</figcaption></figure>\n",
        escape(&summary.dataset),
        summary.splats,
        summary.steps,
        summary.seconds,
        summary.steps_per_second,
        summary.steps,
    ))
}

/// What the demo looks for in the sample scene.
const PHRASES: [&str; 4] = ["red ball", "green ball", "blue and yellow box", "checkered floor"];

/// Searches the scene; without a model or a runtime the page says what is missing.
fn search_section(arguments: &Arguments) -> Result<String, CliError> {
    let phrases = PHRASES.map(String::from);
    let sheet = arguments.out.join("search.png");
    let features = arguments.out.join("features.bin");
    let report = search(
        &Arc::new(load_scene(&arguments.scene)?),
        &SearchArguments {
            path: &arguments.scene,
            phrases: &phrases,
            models: &arguments.models,
            features: Some(&features),
            crops: CropOptions::default(),
            query: QueryOptions { top_k: 3, threshold: Some(0.0) },
            sheet: Some(&sheet),
        },
    );
    let report = match report {
        Ok(report) => report,
        Err(error @ CliError::Search(_)) => {
            eprintln!("no search: {error}");
            return Ok(format!(
                "<h2>Search</h2>\n<p>Not run: {}</p>\n",
                escape(&error.to_string())
            ));
        }
        Err(error) => return Err(error),
    };
    let mut html = format!(
        "<h2>Search</h2>\n<p>{}: {} clusters looked at in {:.1} s ({} crops); {} texts answered in {:.0} ms.</p>\n\
         <figure><img src=\"search.png\" alt=\"What was found\"><figcaption>A row per text, the three best \
         clusters, the score as a bar</figcaption></figure>\n<table>\n\
         <tr><th>text</th><th>best</th><th>second</th><th>third</th></tr>\n",
        escape(&report.model),
        report.encoded_clusters,
        report.encode_ms / 1e3,
        report.crops,
        phrases.len(),
        report.query_ms,
    );
    for phrase in &phrases {
        let found = report.results.iter().filter(|found| found.text == *phrase);
        let cells: String = found
            .map(|found| {
                let name = found.name.clone().unwrap_or_else(|| found.cluster.to_string());
                format!("<td>{} {:.2}</td>", escape(&name), found.score)
            })
            .collect();
        // Writing to a String cannot fail.
        let _ = writeln!(html, "<tr><td>{}</td>{cells}</tr>", escape(phrase));
    }
    Ok(html + "</table>\n")
}

/// Runs one of the program's own commands.
fn command(words: &[&str]) -> Result<(), CliError> {
    #[derive(Parser)]
    struct Line {
        #[command(subcommand)]
        command: Command,
    }
    let line = Line::try_parse_from(std::iter::once(&"trapeze").chain(words))
        .map_err(|e| CliError::argument("demo", "a command line", e))?;
    line.command.run()
}

fn page(arguments: &Arguments, found: &str) -> Result<String, CliError> {
    let scene = load_scene(&arguments.scene)?;
    let table = read(&arguments.out.join("report.md"))?;
    let mut html = String::from(HEAD);
    // Writing to a String cannot fail.
    let _ = writeln!(
        html,
        "<h1>Trapeze</h1>\n<p>{} splats, {} clusters, deformation network {}.</p>",
        scene.len(),
        scene.clusters.as_ref().map_or(0, |c| c.table.len()),
        scene.deformation.as_ref().map_or("none".into(), |d| escape(&d.describe())),
    );
    html += "<figure><img src=\"turntable.webp\" alt=\"Turntable through time\">\
             <figcaption>Once around, once through time</figcaption></figure>\n<div class=\"grid\">\n";
    for picture in &PICTURES {
        let _ = writeln!(
            html,
            "<figure><img src=\"{0}\" alt=\"{1}\"><figcaption>{1}</figcaption></figure>",
            picture.file,
            escape(picture.caption),
        );
    }
    html += "</div>\n";
    html += found;
    html += &training_section(arguments)?;
    html += "<h2>Speed against error</h2>\n";
    html += &table_to_html(&table);
    html += "<p><img src=\"report.svg\" alt=\"Error over time of every variant\"></p>\n</main>\n";
    Ok(html)
}

const HEAD: &str = "<!doctype html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n\
<meta name=\"viewport\" content=\"width=device-width\">\n<title>Trapeze demo</title>\n<style>\n\
body { font: 16px/1.5 system-ui, sans-serif; color: #222; background: #fafafa; }\n\
main { max-width: 1100px; margin: 2rem auto; padding: 0 1rem; }\n\
.grid { display: grid; grid-template-columns: repeat(auto-fill, minmax(300px, 1fr)); gap: 1rem; }\n\
figure { margin: 0; } img { max-width: 100%; background: #000; }\n\
figcaption { color: #555; font-size: 0.9rem; }\n\
table { border-collapse: collapse; } td, th { padding: 0.2rem 0.6rem; border-bottom: 1px solid #ddd; }\n\
td { text-align: right; } td:first-child { text-align: left; }\n</style>\n<main>\n";

/// The report's own Markdown (a line of text and one table) as HTML.
fn table_to_html(markdown: &str) -> String {
    let mut html = String::new();
    let mut rows = Vec::new();
    for line in markdown.lines() {
        match line.strip_prefix('|').and_then(|l| l.strip_suffix('|')) {
            Some(cells) if !cells.starts_with("---") => {
                rows.push(cells.split('|').map(|c| escape(c.trim())).collect::<Vec<_>>());
            }
            None if !line.is_empty() => {
                let _ = writeln!(html, "<p>{}</p>", escape(&line.replace('`', "")));
            }
            _ => {}
        }
    }
    html += "<table>\n";
    for (i, row) in rows.iter().enumerate() {
        let tag = if i == 0 { "th" } else { "td" };
        let cells: String = row.iter().map(|cell| format!("<{tag}>{cell}</{tag}>")).collect();
        let _ = writeln!(html, "<tr>{cells}</tr>");
    }
    html + "</table>\n"
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

fn read(path: &Path) -> Result<String, CliError> {
    std::fs::read_to_string(path).map_err(|e| CliError::file(path, e))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_report_table_becomes_html() {
        let html = table_to_html("`a<b`: text.\n\n| x | y |\n|---|---:|\n| 1 | 2 |\n");
        assert!(html.contains("<p>a&lt;b: text.</p>"), "{html}");
        assert!(html.contains("<tr><th>x</th><th>y</th></tr>"), "{html}");
        assert!(html.contains("<tr><td>1</td><td>2</td></tr>"), "{html}");
        assert!(!html.contains("---"));
    }
}
