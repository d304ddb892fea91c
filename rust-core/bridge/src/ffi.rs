//! The surface: everything that Swift can call. `build.rs` makes the C headers and the Swift code
//! from this file.
//!
//! Rules: bulk data cross as slices or as pointer and length, a slice is never empty on Swift's
//! side (it would have no address), what can fail throws a [`Failure`], what takes long is given a
//! [`Work`]. Objects may be used from any thread. What is unknown or absent is NaN.

// The macro's code.
#![allow(missing_docs, unreachable_pub, clippy::unnecessary_cast)]

use crate::dataset::{Dataset, inspect_dataset};
use crate::device::{Device, open_device};
use crate::edits::Edits;
use crate::export::Exported;
use crate::failure::{Failure, provoke_panic};
use crate::image::Image;
use crate::measure::Measurements;
use crate::renderer::{Renderer, make_renderer};
use crate::scene::{Scene, core_version, open_scene};
use crate::searcher::{Hits, SearchModel, Searcher, make_searcher, open_search_model};
use crate::self_check::{SelfCheck, check_device};
use crate::trainer::{Trainer, make_trainer};
use crate::work::Work;

pub(crate) use ffi::*;

#[swift_bridge::bridge]
mod ffi {
    // What a long work is at.
    enum Stage {
        Preparing,
        Reading,
        Uploading,
        Compiling,
        Encoding,
        Rendering,
        Measuring,
        Writing,
    }

    // What a frame shows.
    enum FrameMode {
        Color,
        Clusters,
        Depth,
        Motion,
    }

    // What the clusters that go with a frame are for.
    enum Visibility {
        All,
        Isolate,
        Hide,
    }

    enum ExportFormat {
        Ply,
        Spz,
        Folder,
    }

    // Which devices may draw, or train.
    enum Backend {
        // The graphics device, or the CPU where there is none.
        Automatic,
        Gpu,
        Cpu,
    }

    enum TrainEventKind {
        Report,
        Saved,
        RolledBack,
    }

    #[swift_bridge(swift_repr = "struct")]
    struct WorkProgress {
        stage: Stage,
        // 0–1; NaN where the end is not known.
        fraction: f64,
    }

    #[swift_bridge(swift_repr = "struct")]
    struct Box3 {
        min_x: f64,
        min_y: f64,
        min_z: f64,
        max_x: f64,
        max_y: f64,
        max_z: f64,
    }

    #[swift_bridge(swift_repr = "struct")]
    struct SceneFigures {
        splats: u64,
        harmonics_degree: u32,
        // NaN in a scene without splats.
        framing: Box3,
        deformable: bool,
        has_motion: bool,
        // 0–100; NaN where nothing is recommended.
        recommended_percentile: f64,
        memory_bytes: u64,
        clusters: usize,
    }

    #[swift_bridge(swift_repr = "struct")]
    struct ClusterFigures {
        id: u32,
        red: f32,
        green: f32,
        blue: f32,
        splats: u64,
    }

    // The camera's intrinsics; its `world_to_camera` goes beside it, 16 numbers, row by row.
    #[swift_bridge(swift_repr = "struct")]
    struct Lens {
        width: u32,
        height: u32,
        fx: f64,
        fy: f64,
        cx: f64,
        cy: f64,
    }

    #[swift_bridge(swift_repr = "struct")]
    struct FrameParameters {
        lens: Lens,
        time: f64,
        mode: FrameMode,
        visibility: Visibility,
        // NaN moves every splat.
        static_threshold: f32,
        background_red: f32,
        background_green: f32,
        background_blue: f32,
    }

    #[swift_bridge(swift_repr = "struct")]
    struct RendererParameters {
        half_precision: bool,
        max_harmonics_degree: u32,
    }

    // Seconds are NaN where the device has not told.
    #[swift_bridge(swift_repr = "struct")]
    struct DrawFigures {
        needs_redraw: bool,
        frame_seconds: f64,
        deform_seconds: f64,
        sort_seconds: f64,
        rasterize_seconds: f64,
        deformed_splats: u64,
        visible_splats: u64,
        total_splats: u64,
        device_bytes: u64,
    }

    #[swift_bridge(swift_repr = "struct")]
    struct PickFigures {
        is_hit: bool,
        splat: u32,
        has_cluster: bool,
        cluster: u32,
        depth: f64,
    }

    #[swift_bridge(swift_repr = "struct")]
    struct MeasurementFigures {
        frame_milliseconds: f64,
        // Infinite when the images are equal.
        psnr: f64,
    }

    #[swift_bridge(swift_repr = "struct")]
    struct HitFigures {
        cluster: u32,
        // The text's share against texts that mean nothing in particular, 0–1.
        score: f64,
    }

    // Decibels are NaN for equal images.
    #[swift_bridge(swift_repr = "struct")]
    struct CheckFigures {
        psnr: f64,
        milliseconds: f64,
        passed: bool,
    }

    #[swift_bridge(swift_repr = "struct")]
    struct DatasetFigures {
        views: usize,
        width: u32,
        height: u32,
        points: u64,
    }

    #[swift_bridge(swift_repr = "struct")]
    struct TrainParameters {
        steps: u32,
        // 0 lets the run find out.
        max_splats: u32,
        harmonics_degree: u32,
        // Bytes; 0 asks the system.
        memory_limit: u64,
        backend: Backend,
    }

    #[swift_bridge(swift_repr = "struct")]
    struct TrainFigures {
        step: u32,
        steps: u32,
        seconds: f64,
        steps_per_second: f64,
        loss: f64,
        psnr: f64,
        splats: u32,
    }

    #[swift_bridge(swift_repr = "struct")]
    struct TrainEventFigures {
        // Whether there was an event; the rest means nothing otherwise.
        is_event: bool,
        kind: TrainEventKind,
        report: TrainFigures,
        // Step that was saved or left.
        step: u32,
        // Step that was returned to.
        to: u32,
    }

    // NaN where no view is held out.
    #[swift_bridge(swift_repr = "struct")]
    struct TestFigures {
        psnr: f64,
        ssim: f64,
    }

    extern "Rust" {
        #[swift_bridge(Sendable)]
        type Failure;
        fn code(self: &Failure) -> i32;
        fn message(self: &Failure) -> String;
        fn provoke_panic(message: String) -> Result<(), Failure>;
        fn core_version() -> String;
    }

    extern "Rust" {
        #[swift_bridge(Sendable)]
        type Work;
        #[swift_bridge(init)]
        fn new() -> Work;
        fn cancel(self: &Work);
        fn progress(self: &Work) -> WorkProgress;
    }

    extern "Rust" {
        #[swift_bridge(Sendable)]
        type Image;
        fn width(self: &Image) -> u32;
        fn height(self: &Image) -> u32;
        // The first of `byte_count` bytes, which live as long as the image.
        fn bytes(self: &Image) -> *const u8;
        fn byte_count(self: &Image) -> usize;
    }

    extern "Rust" {
        #[swift_bridge(Sendable)]
        type Scene;
        fn open_scene(path: String, work: &Work) -> Result<Scene, Failure>;
        fn figures(self: &Scene) -> SceneFigures;
        fn warnings(self: &Scene) -> Vec<String>;
        // `index` counts the clusters; all zero beyond the last.
        fn cluster(self: &Scene, index: usize) -> ClusterFigures;
        fn cluster_name(self: &Scene, index: usize) -> Option<String>;
        // NaN in a scene without motion values.
        fn static_threshold(self: &Scene, percentile: f64) -> f32;
        // NaN where the cluster has no splats.
        fn cluster_bounds(self: &Scene, cluster: u32, time: f64) -> Result<Box3, Failure>;
        fn edited(self: &Scene, edits: &Edits, work: &Work) -> Result<Scene, Failure>;
        fn with_motion(self: &Scene, work: &Work) -> Result<Scene, Failure>;
        fn export_to(
            self: &Scene,
            path: String,
            format: ExportFormat,
            work: &Work,
        ) -> Result<Exported, Failure>;
    }

    extern "Rust" {
        #[swift_bridge(Sendable)]
        type Exported;
        fn splat_count(self: &Exported) -> u64;
        fn file_bytes(self: &Exported) -> u64;
        fn warnings(self: &Exported) -> Vec<String>;
    }

    extern "Rust" {
        #[swift_bridge(Sendable)]
        type Edits;
        #[swift_bridge(init)]
        fn new() -> Edits;
        fn crop(self: &Edits, bounds: Box3);
        fn delete_clusters(self: &Edits, clusters: &[u32]);
        fn keep_clusters(self: &Edits, clusters: &[u32]);
        fn delete_faint(self: &Edits, below: f64);
        fn remove_floaters(self: &Edits, sigmas: f64);
        fn rename(self: &Edits, cluster: u32, name: Option<String>);
        fn recolor(self: &Edits, cluster: u32, red: f32, green: f32, blue: f32);
    }

    extern "Rust" {
        #[swift_bridge(Sendable)]
        type Device;
        fn open_device(backend: Backend, work: &Work) -> Result<Device, Failure>;
        fn name(self: &Device) -> String;
    }

    extern "Rust" {
        #[swift_bridge(Sendable)]
        type Renderer;
        fn make_renderer(
            device: &Device,
            scene: &Scene,
            options: RendererParameters,
            work: &Work,
        ) -> Result<Renderer, Failure>;
        fn device_name(self: &Renderer) -> String;
        // `layer` is the address of a CAMetalLayer that lives until another one is attached; 0
        // detaches.
        fn attach(self: &Renderer, layer: usize, width: u32, height: u32) -> Result<(), Failure>;
        fn show(
            self: &Renderer,
            scene: &Scene,
            options: RendererParameters,
            work: &Work,
        ) -> Result<(), Failure>;
        fn draw(
            self: &Renderer,
            frame: FrameParameters,
            world_to_camera: &[f64],
            clusters: &[u32],
        ) -> Result<DrawFigures, Failure>;
        fn render(
            self: &Renderer,
            frame: FrameParameters,
            world_to_camera: &[f64],
            clusters: &[u32],
        ) -> Result<Image, Failure>;
        fn pick(
            self: &Renderer,
            frame: FrameParameters,
            world_to_camera: &[f64],
            clusters: &[u32],
            x: u32,
            y: u32,
        ) -> Result<PickFigures, Failure>;
        // One variant per entry of `half_precision` (0 or 1) and `percentiles` (NaN moves all).
        fn measure(
            self: &Renderer,
            lens: Lens,
            world_to_camera: &[f64],
            times: &[f64],
            half_precision: &[u8],
            percentiles: &[f64],
            work: &Work,
        ) -> Result<Measurements, Failure>;
        fn shed_memory(self: &Renderer) -> Result<(), Failure>;
        fn suspend(self: &Renderer) -> Result<(), Failure>;
        fn resume(self: &Renderer) -> Result<(), Failure>;
    }

    extern "Rust" {
        #[swift_bridge(Sendable)]
        type Measurements;
        fn measurement(self: &Measurements, index: usize) -> MeasurementFigures;
    }

    extern "Rust" {
        #[swift_bridge(Sendable)]
        type SearchModel;
        fn open_search_model(path: String, work: &Work) -> Result<SearchModel, Failure>;
        fn name(self: &SearchModel) -> String;
        // The least score of a match, 0–1.
        fn threshold(self: &SearchModel) -> f64;
    }

    extern "Rust" {
        #[swift_bridge(Sendable)]
        type Searcher;
        fn make_searcher(model: &SearchModel, scene: &Scene) -> Result<Searcher, Failure>;
        // Draws on the renderer's device. Features are kept in the folder `cache`; an empty name
        // keeps them nowhere.
        fn encode(
            self: &Searcher,
            renderer: &Renderer,
            cache: String,
            work: &Work,
        ) -> Result<(), Failure>;
        fn encoded_clusters(self: &Searcher) -> Vec<u32>;
        // The picture of an encoded cluster, once after each encoding.
        fn take_picture(self: &Searcher, cluster: u32) -> Result<Image, Failure>;
        fn search(self: &Searcher, text: String) -> Result<Hits, Failure>;
    }

    extern "Rust" {
        #[swift_bridge(Sendable)]
        type Hits;
        fn count(self: &Hits) -> usize;
        fn hit(self: &Hits, index: usize) -> HitFigures;
    }

    extern "Rust" {
        #[swift_bridge(Sendable)]
        type SelfCheck;
        fn check_device(device: &Device, work: &Work) -> Result<SelfCheck, Failure>;
        fn device_name(self: &SelfCheck) -> String;
        fn count(self: &SelfCheck) -> usize;
        fn check(self: &SelfCheck, index: usize) -> CheckFigures;
        fn check_name(self: &SelfCheck, index: usize) -> String;
        fn check_note(self: &SelfCheck, index: usize) -> Option<String>;
    }

    extern "Rust" {
        #[swift_bridge(Sendable)]
        type Dataset;
        // `holdout` of 0 holds out nothing.
        fn inspect_dataset(path: String, downscale: u32, holdout: u32) -> Result<Dataset, Failure>;
        fn figures(self: &Dataset) -> DatasetFigures;
        fn format_name(self: &Dataset) -> String;
        fn warnings(self: &Dataset) -> Vec<String>;
        fn view_lens(self: &Dataset, index: usize) -> Lens;
        fn view_world_to_camera(self: &Dataset, index: usize) -> Vec<f64>;
        // 0 in a dataset without times.
        fn view_time(self: &Dataset, index: usize) -> f32;
    }

    extern "Rust" {
        #[swift_bridge(Sendable)]
        type Trainer;
        // Trains on the device where `backend` allows it and it is faster than the CPU.
        fn make_trainer(
            device: &Device,
            dataset: &Dataset,
            parameters: TrainParameters,
            folder: String,
            work: &Work,
        ) -> Result<Trainer, Failure>;
        fn device_name(self: &Trainer) -> String;
        fn current_step(self: &Trainer) -> u32;
        fn is_finished(self: &Trainer) -> bool;
        // Takes steps for a tenth of a second, at least one.
        fn advance(self: &Trainer, work: &Work) -> Result<(), Failure>;
        // The oldest event that has not been taken yet.
        fn next_event(self: &Trainer) -> TrainEventFigures;
        // In words, what the last roll-back that was taken was for.
        fn rollback_reason(self: &Trainer) -> String;
        fn checkpoint(self: &Trainer) -> Result<(), Failure>;
        // Writes the scene, measures it on the held-out views, removes the checkpoints.
        fn finish(self: &Trainer, work: &Work) -> Result<TestFigures, Failure>;
        fn report(self: &Trainer) -> TrainFigures;
        fn preview(
            self: &Trainer,
            lens: Lens,
            world_to_camera: &[f64],
            time: f32,
        ) -> Result<Image, Failure>;
        fn trained_scene(self: &Trainer) -> Result<Scene, Failure>;
    }
}
