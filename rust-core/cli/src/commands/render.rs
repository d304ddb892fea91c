//! `trapeze render`.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use clap::{Args, ValueEnum};
use trapeze_cpu::{Renderer, reference};
use trapeze_formats::write_npy;
use trapeze_gpu::{Gpu, GpuOptions};
use trapeze_scene::{
    Camera, ClusterSet, ColorSource, Frame, FrameSettings, NO_SPLAT, Rgba8, Scene, Selection,
    ShDegree,
};

use crate::dataset_input::parse_color;
use crate::error::CliError;
use crate::output::{progress_bar, write_animation, write_png};
use crate::scene_input::{SceneArguments, ViewArguments};

#[derive(Debug, Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    scene: SceneArguments,
    #[command(flatten)]
    view: ViewArguments,
    /// Where to write: .png for an image, .npy for raw values, .webp for an animation, and with
    /// `--path` and .png a sequence name-0000.png, name-0001.png, ….
    #[arg(long)]
    out: PathBuf,
    /// Time of the frame, or of the first frame of a path.
    #[arg(long, default_value_t = 0.0, allow_hyphen_values = true)]
    time: f32,
    /// What computes the image.
    #[arg(long, value_enum, default_value_t)]
    backend: Backend,
    /// What the image shows.
    #[arg(long, value_enum, default_value_t)]
    mode: Mode,
    /// Let this share of the splats (0-100, least motion first) rest at t = 0.
    #[arg(long, value_name = "PERCENTILE")]
    static_percentile: Option<f32>,
    /// Highest SH degree to evaluate.
    #[arg(long, default_value_t = 3, value_parser = clap::value_parser!(u32).range(0..=3))]
    sh_degree: u32,
    /// Show only these clusters.
    #[arg(long, value_name = "IDS", value_delimiter = ',', conflicts_with = "hide")]
    isolate: Vec<u32>,
    /// Hide these clusters.
    #[arg(long, value_name = "IDS", value_delimiter = ',')]
    hide: Vec<u32>,
    /// Colour behind the scene, or `none` for a transparent image.
    #[arg(long, default_value = "black", value_parser = parse_background)]
    background: Background,
    /// Move the camera or the time.
    #[arg(long, value_enum)]
    path: Option<PathKind>,
    /// Frames of the path.
    #[arg(long, default_value_t = 60, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    frames: u32,
    /// Frames per second of an animation.
    #[arg(long, default_value_t = 20.0)]
    fps: f64,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum Backend {
    /// SIMD and threads.
    #[default]
    Cpu,
    /// Metal or Vulkan.
    Gpu,
    /// The f64 specification: slow.
    Reference,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum Mode {
    /// The trained colours.
    #[default]
    Color,
    /// Expected depth.
    Depth,
    /// Depth where half of the light is stopped.
    DepthMedian,
    /// Coverage.
    Alpha,
    /// The clusters' display colours.
    Clusters,
    /// Id of the cluster that contributes most; -1 where nothing does.
    ClusterId,
    /// Heat map of the motion values; as .npy the value of the splat that contributes most.
    Motion,
}

/// What moves along a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum PathKind {
    /// Once around the scene, and once through time where there is a deformation network.
    Turntable,
    /// Once through time, with a fixed camera.
    Time,
}

#[derive(Clone, Copy, Debug)]
struct Background(Option<[f32; 3]>);

pub(crate) fn run(arguments: &Arguments) -> Result<(), CliError> {
    let scene = Arc::new(arguments.scene.load()?);
    let settings = arguments.settings(&scene)?;
    let mut painter = Painter::new(arguments.backend, scene)?;
    match arguments.path {
        None => render_one(arguments, &mut painter, &settings),
        Some(path) => render_path(arguments, path, &mut painter, &settings),
    }
}

impl Arguments {
    fn settings(&self, scene: &Scene) -> Result<FrameSettings, CliError> {
        let set = |ids: &[u32]| -> Result<ClusterSet, CliError> {
            ids.iter().map(|&id| label_of(scene, id)).collect()
        };
        let selection = if !self.isolate.is_empty() {
            Selection::Isolate(set(&self.isolate)?)
        } else if !self.hide.is_empty() {
            Selection::Hide(set(&self.hide)?)
        } else {
            Selection::All
        };
        Ok(FrameSettings {
            time: self.time,
            static_threshold: static_threshold(scene, self.static_percentile)?,
            max_sh_degree: ShDegree::try_from(self.sh_degree)?,
            selection,
            color_source: match self.mode {
                Mode::Clusters => ColorSource::Clusters,
                Mode::Motion => ColorSource::Motion,
                _ => ColorSource::SphericalHarmonics,
            },
            depth: matches!(self.mode, Mode::Depth | Mode::DepthMedian),
            top_contributor: matches!(self.mode, Mode::ClusterId | Mode::Motion),
        })
    }
}

/// The threshold at which a share of the splats rests.
pub(crate) fn static_threshold(
    scene: &Scene,
    percentile: Option<f32>,
) -> Result<Option<f32>, CliError> {
    let Some(percentile) = percentile else { return Ok(None) };
    if !(0.0..=100.0).contains(&percentile) {
        return Err(CliError::argument("--static-percentile", "0 to 100", percentile));
    }
    let motion = scene.motion.as_ref().ok_or_else(|| {
        CliError::argument(
            "--static-percentile",
            "a scene with motion values (run `trapeze motion SCENE --write` first)",
            "none",
        )
    })?;
    Ok(Some(motion.threshold_at_percentile(percentile)))
}

fn label_of(scene: &Scene, id: u32) -> Result<u32, CliError> {
    let Some(clusters) = &scene.clusters else {
        return Err(CliError::argument("cluster", "a scene with clusters", "none"));
    };
    clusters.label_of(id).ok_or_else(|| {
        let ids: Vec<String> = clusters.table.iter().take(20).map(|c| c.id.to_string()).collect();
        CliError::argument("cluster", format!("one of {}", ids.join(", ")), id)
    })
}

/// Renders frames with any backend.
pub(crate) struct Painter {
    scene: Arc<Scene>,
    renderer: AnyRenderer,
}

enum AnyRenderer {
    Cpu(Box<Renderer>),
    Gpu(Box<trapeze_gpu::Renderer>),
    /// Keeps nothing between frames.
    Reference,
}

impl Painter {
    pub(crate) fn new(backend: Backend, scene: Arc<Scene>) -> Result<Self, CliError> {
        let renderer = match backend {
            Backend::Cpu => AnyRenderer::Cpu(Box::new(Renderer::new(scene.clone()))),
            Backend::Gpu => {
                AnyRenderer::Gpu(Box::new(trapeze_gpu::Renderer::new(&open_gpu()?, scene.clone())?))
            }
            Backend::Reference => AnyRenderer::Reference,
        };
        Ok(Self { scene, renderer })
    }

    pub(crate) fn paint(
        &mut self,
        camera: &Camera,
        settings: &FrameSettings,
    ) -> Result<Frame, CliError> {
        camera.validate()?;
        Ok(match &mut self.renderer {
            AnyRenderer::Cpu(renderer) => renderer.render(camera, settings)?,
            AnyRenderer::Gpu(renderer) => renderer.render(camera, settings)?,
            AnyRenderer::Reference => reference::render(&self.scene, camera, settings).to_frame(),
        })
    }
}

/// The device that GPU commands run on; TRAPEZE_GPU names a part of its name.
pub(crate) fn open_gpu() -> Result<Gpu, CliError> {
    let adapter = std::env::var("TRAPEZE_GPU").ok();
    Ok(Gpu::open(&GpuOptions { adapter, ..GpuOptions::default() })?)
}

fn render_one(
    arguments: &Arguments,
    painter: &mut Painter,
    settings: &FrameSettings,
) -> Result<(), CliError> {
    let camera = arguments.view.camera(&painter.scene)?;
    let frame = painter.paint(&camera, settings)?;
    match extension(&arguments.out).as_str() {
        "png" => write_png(&arguments.out, &picture(arguments, painter, &frame)),
        "npy" => write_raw(arguments, painter, &frame),
        other => Err(CliError::argument("--out", "a file ending in .png or .npy", other)),
    }
}

fn render_path(
    arguments: &Arguments,
    path: PathKind,
    painter: &mut Painter,
    settings: &FrameSettings,
) -> Result<(), CliError> {
    let kind = extension(&arguments.out);
    if kind != "png" && kind != "webp" {
        return Err(CliError::argument("--out", "a file ending in .webp or .png", kind));
    }
    if !(arguments.fps > 0.0 && arguments.fps <= 1000.0) {
        return Err(CliError::argument("--fps", "more than 0 and at most 1000", arguments.fps));
    }
    let progress = progress_bar(u64::from(arguments.frames), "rendering");
    let mut pictures = Vec::new();
    for i in 0..arguments.frames {
        let share = f64::from(i) / f64::from(arguments.frames);
        let (camera, time) = path_moment(arguments, path, painter, share)?;
        let frame = painter.paint(&camera, &FrameSettings { time, ..settings.clone() })?;
        let picture = picture(arguments, painter, &frame);
        if kind == "png" {
            write_png(&numbered(&arguments.out, i), &picture)?;
        } else {
            pictures.push(picture);
        }
        progress.inc(1);
    }
    progress.finish_and_clear();
    if kind == "webp" {
        let milliseconds = (1000.0 / arguments.fps).round().max(1.0) as u32;
        write_animation(&arguments.out, &pictures, milliseconds)?;
    }
    Ok(())
}

/// Camera and time at a share (0–1) of a path.
fn path_moment(
    arguments: &Arguments,
    path: PathKind,
    painter: &Painter,
    share: f64,
) -> Result<(Camera, f32), CliError> {
    let time = arguments.time + share as f32;
    match path {
        PathKind::Time => Ok((arguments.view.camera(&painter.scene)?, time)),
        PathKind::Turntable => {
            let (azimuth, elevation) = arguments.view.orbit.unwrap_or((0.0, 20.0));
            let orbit = (azimuth + 360.0 * share, elevation);
            Ok((arguments.view.orbit_camera(&painter.scene, orbit)?, time))
        }
    }
}

/// The frame as it is looked at.
fn picture(arguments: &Arguments, painter: &Painter, frame: &Frame) -> Rgba8 {
    let (width, height) = (frame.width, frame.height);
    match arguments.mode {
        Mode::Color | Mode::Clusters | Mode::Motion => {
            Rgba8::of_colors(frame, arguments.background.0)
        }
        Mode::Depth => Rgba8::of_depth(&frame.expected_depth, width, height),
        Mode::DepthMedian => Rgba8::of_depth(&frame.median_depth, width, height),
        Mode::Alpha => {
            let grey = |&[.., a]: &[f32; 4]| {
                let v = (a.clamp(0.0, 1.0) * 255.0).round() as u8;
                [v, v, v, 255]
            };
            Rgba8 { width, height, pixels: frame.color.iter().flat_map(grey).collect() }
        }
        Mode::ClusterId => {
            let color = |&splat: &u32| match (&painter.scene.clusters, splat) {
                (_, NO_SPLAT) => [0; 4],
                (None, _) => [128, 128, 128, 255],
                (Some(clusters), splat) => {
                    let label = clusters.labels[splat as usize];
                    let [r, g, b] = clusters.table[label as usize]
                        .color
                        .map(|v| (v.clamp(0.0, 1.0) * 255.0).round() as u8);
                    [r, g, b, 255]
                }
            };
            Rgba8 { width, height, pixels: frame.top_contributor.iter().flat_map(color).collect() }
        }
    }
}

/// The frame's raw values: H × W × 4, or H × W for depth, cluster id and motion.
fn write_raw(arguments: &Arguments, painter: &Painter, frame: &Frame) -> Result<(), CliError> {
    let plane = [frame.height as usize, frame.width as usize];
    let scene = &painter.scene;
    let of_top = |value: &dyn Fn(usize) -> f32, nothing: f32| -> Vec<f32> {
        let top = frame.top_contributor.iter();
        top.map(|&i| if i == NO_SPLAT { nothing } else { value(i as usize) }).collect()
    };
    let values = match arguments.mode {
        Mode::Color | Mode::Clusters => {
            let shape = [plane[0], plane[1], 4];
            return Ok(write_npy(&arguments.out, &shape, frame.color.as_flattened())?);
        }
        Mode::Depth => frame.expected_depth.clone(),
        Mode::DepthMedian => frame.median_depth.clone(),
        Mode::Alpha => frame.color.iter().map(|&[.., a]| a).collect(),
        Mode::ClusterId => of_top(
            &|i| scene.clusters.as_ref().map_or(-1.0, |c| c.table[c.labels[i] as usize].id as f32),
            -1.0,
        ),
        Mode::Motion => of_top(&|i| scene.motion.as_ref().map_or(0.0, |m| m.values[i]), f32::NAN),
    };
    Ok(write_npy(&arguments.out, &plane, &values)?)
}

fn extension(path: &Path) -> String {
    path.extension().map_or(String::new(), |e| e.to_string_lossy().to_lowercase())
}

/// name.png → name-0007.png.
fn numbered(path: &Path, i: u32) -> PathBuf {
    let stem = path.file_stem().map_or("frame".into(), |s| s.to_string_lossy());
    path.with_file_name(format!("{stem}-{i:04}.png"))
}

fn parse_background(text: &str) -> Result<Background, String> {
    if text == "none" {
        return Ok(Background(None));
    }
    parse_color(text).map(|color| Background(Some(color))).map_err(|error| error + ", or none")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn backgrounds_are_names_or_numbers() {
        assert_eq!(parse_background("white").unwrap().0, Some([1.0; 3]));
        assert_eq!(parse_background("0.1, 0.2,0.3").unwrap().0, Some([0.1, 0.2, 0.3]));
        assert_eq!(parse_background("none").unwrap().0, None);
        assert!(parse_background("0.1,2,0.3").is_err());
        assert!(parse_background("pink").unwrap_err().contains("expected"));
    }

    #[test]
    fn sequence_names_sort_in_order() {
        assert_eq!(numbered(Path::new("out/a.png"), 7), Path::new("out/a-0007.png"));
    }
}
