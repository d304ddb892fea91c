//! Equal depths and identical splats: the same bits for every number of threads.

use super::*;

#[test]
fn equal_splats_train_to_the_same_bits_on_any_number_of_threads() {
    let mut splats = splats(600);
    for i in 0..300 {
        // Pairs of identical splats, and all of them at one depth.
        splats.positions[2 * i][2] = 0.25;
        for array in [&mut splats.positions, &mut splats.log_scales, &mut splats.sh_dc] {
            array[2 * i + 1] = array[2 * i];
        }
        splats.rotations[2 * i + 1] = splats.rotations[2 * i];
        splats.opacity_logits[2 * i + 1] = splats.opacity_logits[2 * i];
    }
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let (mut backend, view) =
                loaded(splats.clone(), camera(70, 50), photograph(0, (70, 50)));
            let reports = take_steps(&mut backend, &view, &TrainingConfig::growing(25, 600));
            (backend.state().unwrap(), reports)
        })
    };
    let (expected, reports) = run(1);
    assert!(reports.iter().all(StepReport::is_sound));
    for threads in [2, 3, 5] {
        let (state, others) = run(threads);
        assert!(state == expected && others == reports, "{threads} threads");
    }
}
