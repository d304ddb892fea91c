//! Opacities at and beyond their limits.

use trapeze_train::schedule::DensifyPlan;

use super::*;

#[test]
fn extreme_opacities_train_and_leave_every_parameter_finite() {
    let mut splats = splats(200);
    for (i, logit) in [1e4, -1e4, 40.0, -40.0].into_iter().enumerate() {
        splats.opacity_logits[10 * i] = logit;
    }
    let (mut backend, view) = loaded(splats, camera(40, 30), photograph(0, (40, 30)));
    let reports = take_steps(&mut backend, &view, &TrainingConfig::growing(20, 300));
    assert!(reports.iter().all(StepReport::is_sound), "{reports:?}");
    assert!(reports[19].loss.total < reports[0].loss.total);
    assert!(is_finite(&backend.state().unwrap().splats));
}

#[test]
fn what_is_not_finite_stays_where_it_is_is_counted_and_is_moved_by_relocation() {
    let mut splats = splats(200);
    let poison = [f32::INFINITY, f32::NEG_INFINITY, f32::NAN];
    for (i, logit) in poison.into_iter().enumerate() {
        splats.opacity_logits[10 * i] = logit;
    }
    let (mut backend, view) = loaded(splats, camera(40, 30), photograph(0, (40, 30)));
    let reports = take_steps(&mut backend, &view, &TrainingConfig::fixed(20));
    // The loss is finite, and only the three logits were skipped.
    assert!(reports.iter().all(|r| r.loss.total.is_finite() && r.not_finite <= 3), "{reports:?}");
    assert!(reports.iter().all(|report| report.not_finite > 0));
    let mut after = backend.state().unwrap();
    for (i, logit) in poison.into_iter().enumerate() {
        let found = std::mem::take(&mut after.splats.opacity_logits[10 * i]);
        assert_eq!(found.to_bits(), logit.to_bits());
    }
    assert!(is_finite(&after.splats) && is_finite(&after.first_moments));
    backend.densify(&DensifyPlan { seed: 1, dead_opacity: 0.005, count: 200 }).unwrap();
    assert!(is_finite(&backend.state().unwrap().splats));
}

#[test]
fn ten_thousand_splats_on_one_pixel_train() {
    for logit in [-5.0, 0.0, 9.0] {
        let mut splats = splats(10_000);
        for (i, position) in splats.positions.iter_mut().enumerate() {
            *position = [0.0, 0.0, i as f32 * 1e-4];
        }
        splats.opacity_logits.fill(logit);
        let (mut backend, view) = loaded(splats, camera(15, 11), photograph(0, (15, 11)));
        let reports = take_steps(&mut backend, &view, &TrainingConfig::fixed(5));
        assert!(reports.iter().all(StepReport::is_sound), "{logit}: {reports:?}");
        assert!(is_finite(&backend.state().unwrap().splats));
    }
}
