//! Times the deformation stage on the sample scene and prints one JSON array: milliseconds per
//! frame of all splats, and of masked frames.

#[path = "../tests/support/sample_scene.rs"]
mod sample_scene;

use std::time::Instant;

use trapeze_cpu::deform::{DeformationOptions, DeformationStage};

const FRAMES: usize = 40;

/// (median, 10th, 90th percentile) of the milliseconds of a frame.
fn time_frames(stage: &mut DeformationStage, dynamic: Option<&[u32]>) -> [f64; 3] {
    stage.evaluate(0.5, dynamic);
    let mut times: Vec<f64> = (0..FRAMES)
        .map(|frame| {
            let start = Instant::now();
            stage.evaluate(frame as f32 / FRAMES as f32, dynamic);
            start.elapsed().as_secs_f64() * 1e3
        })
        .collect();
    times.sort_by(f64::total_cmp);
    [times[FRAMES / 2], times[FRAMES / 10], times[FRAMES * 9 / 10]]
}

fn case(name: &str, splats: usize, [median, p10, p90]: [f64; 3]) -> String {
    format!(
        "  {{\"case\": \"{name}\", \"threads\": {}, \"splats\": {splats}, \
         \"median_ms\": {median:.2}, \"p10_ms\": {p10:.2}, \"p90_ms\": {p90:.2}}}",
        rayon::current_num_threads(),
    )
}

fn main() {
    let scene = sample_scene::load();
    let n = scene.len();
    let motion = scene.motion.as_ref().map_or(&[][..], |motion| &motion.values);
    let mut by_motion: Vec<u32> = (0..motion.len() as u32).collect();
    by_motion.sort_by(|&a, &b| motion[b as usize].total_cmp(&motion[a as usize]));

    let start = Instant::now();
    let mut stage = DeformationStage::new(&scene);
    let mut cases = vec![case("setup", n, [start.elapsed().as_secs_f64() * 1e3; 3])];
    cases.push(case("all", n, time_frames(&mut stage, None)));
    for percent in [5, 15, 50] {
        let dynamic = &by_motion[..n * percent / 100];
        let times = time_frames(&mut stage, Some(dynamic));
        cases.push(case(&format!("masked {percent} %"), dynamic.len(), times));
    }
    let options = DeformationOptions { position_term_budget: 0, ..DeformationOptions::default() };
    let mut stage = DeformationStage::with_options(&scene, options);
    cases.push(case("all, nothing kept", n, time_frames(&mut stage, None)));
    println!("[\n{}\n]", cases.join(",\n"));
}
