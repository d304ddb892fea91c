//! Steps, one at a time.

use trapeze_scene::ShDegree;
use trapeze_train::backend::BackendError;
use trapeze_train::config::Densification;
use trapeze_train::{CpuBackend, GpuMemoryPlan};

use super::*;

fn growing() -> TrainingConfig {
    let mut config = TrainingConfig::growing(100, 400);
    config.sh_interval = 20;
    config.sh_degree = 2;
    let densification =
        Densification { start: 15, interval: 15, max_splats: 400, ..Default::default() };
    config.densification = Some(densification);
    config
}

#[test]
fn one_step_is_that_of_the_cpu() {
    let Some(gpu) = device() else { return };
    let config = TrainingConfig::fixed(10);
    let mut reports = Vec::new();
    let mut states = Vec::new();
    let backends: [Box<dyn TrainingBackend>; 2] =
        [Box::new(CpuBackend::default()), Box::new(backend(&gpu))];
    for mut backend in backends {
        backend.load(TrainingState::new(splats(200)), 200).unwrap();
        let views = admitted(&mut *backend, 1);
        take_steps(&mut *backend, &views, &config, 0..1);
        reports.push(backend.reports(0).unwrap()[0]);
        states.push(backend.state().unwrap());
    }
    let (cpu, gpu) = (&states[0], &states[1]);
    assert_eq!((cpu.step, reports[0].visible), (gpu.step, reports[1].visible));
    let (expected, found) = (reports[0].loss.total, reports[1].loss.total);
    // Images agree to 2e-6 (cross-backend tests), the losses of equal images to 1e-5.
    assert!((found - expected).abs() <= 2e-5 * expected, "{found} {expected}");
    for group in ParameterGroup::ALL {
        let (expected, found) = (group.of(&cpu.first_moments), group.of(&gpu.first_moments));
        let largest = expected.iter().fold(0.0f32, |m, g| m.max(g.abs()));
        for (i, (e, f)) in expected.iter().zip(found).enumerate() {
            // What is asked of the gradients by themselves.
            assert!((e - f).abs() <= 1e-3 * largest, "{} {i}: {f} {e}", group.name());
        }
    }
}

#[test]
fn a_steady_run_creates_nothing_and_waits_for_nothing() {
    // Nobody else's objects are to be counted.
    let Some(gpu) = own_device() else { return };
    let mut backend = backend(&gpu);
    let config = growing();
    backend.load(TrainingState::new(splats(200)), 400).unwrap();
    let views = admitted(&mut backend, 3);
    // Every view once, every change of the set and of its bands once.
    take_steps(&mut backend, &views, &config, 0..46);
    backend.reports(45).unwrap();
    let (created, waits) = (backend.created(), backend.report_waits());
    take_steps(&mut backend, &views, &config, 46..59);
    assert_eq!(backend.created(), created, "between two changes");
    take_steps(&mut backend, &views, &config, 59..90);
    assert_eq!(backend.created(), created, "over two changes");
    assert_eq!(backend.report_waits(), waits);
    // One wait for a batch of eight steps at most, and none for what has arrived.
    let reports = backend.reports(89).unwrap();
    assert!(reports.iter().map(|report| report.step).eq(46..90));
    assert!(reports.iter().all(StepReport::is_sound), "{reports:?}");
    assert!(backend.report_waits() - waits <= 7, "{}", backend.report_waits() - waits);
    assert_eq!(backend.created(), created);
    assert_eq!(backend.halts(), 0);
}

#[test]
fn entries_that_do_not_fit_change_nothing_of_the_result() {
    let Some(gpu) = device() else { return };
    let run = |initial_entries: Option<u32>, asks: bool| {
        let options = GpuBackendOptions { initial_entries, ..Default::default() };
        let mut backend = GpuBackend::new(&gpu, options).unwrap();
        let config = growing();
        backend.load(TrainingState::new(splats(200)), 400).unwrap();
        let views = admitted(&mut backend, 3);
        let mut reports = Vec::new();
        for step in 0..36 {
            take_steps(&mut backend, &views, &config, step..step + 1);
            if asks && step >= 17 {
                reports.extend(backend.reports(step - 17).unwrap());
            }
        }
        reports.extend(backend.reports(35).unwrap());
        (backend.state().unwrap(), reports, backend.halts())
    };
    let (state, reports, halts) = run(None, true);
    assert_eq!(halts, 0);
    assert!(reports.iter().map(|report| report.step).eq(0..36));
    // Noticed after a few steps, or after all of them; changes of the set included.
    for asks in [true, false] {
        let (other, other_reports, halts) = run(Some(1), asks);
        assert!(halts > 0);
        assert!(other == state && other_reports == reports, "{asks}");
    }
}

#[test]
fn a_state_comes_back_as_it_was_loaded() {
    let Some(gpu) = device() else { return };
    let mut backend = backend(&gpu);
    for (n, degree) in [(50, ShDegree::Zero), (20, ShDegree::Zero), (30, ShDegree::Three)] {
        let part = |first: usize| {
            let mut part = splats(n + first).with_sh_degree(degree);
            part.sh_rest.iter_mut().enumerate().for_each(|(i, c)| *c = (i + first) as f32);
            part.gather(&(first as u32..(n + first) as u32).collect::<Vec<_>>())
        };
        let state = TrainingState {
            step: 77,
            splats: part(0),
            first_moments: part(1),
            second_moments: part(2),
            network: None,
            resting: None,
        };
        backend.load(state.clone(), 60).unwrap();
        assert_eq!(backend.state().unwrap(), state);
        assert_eq!(backend.splat_count() as usize, n);
    }
}

#[test]
fn a_view_without_a_visible_splat_changes_nothing() {
    let Some(gpu) = device() else { return };
    let mut backend = backend(&gpu);
    let before = splats(100);
    backend.load(TrainingState::new(before.clone()), 100).unwrap();
    let mut views = admitted(&mut backend, 1);
    let (eye, at) = (DVec3::new(0.0, 0.0, -4.0), DVec3::NEG_Z * 9.0);
    views[0].camera = Camera::look_at(eye, at, DVec3::NEG_Y, 0.7, (40, 30));
    take_steps(&mut backend, &views, &TrainingConfig::fixed(5), 0..5);
    let reports = backend.reports(4).unwrap();
    assert!(reports.iter().all(|report| report.is_sound() && report.visible == 0));
    assert_eq!(backend.state().unwrap().splats, before);
}

#[test]
fn poisoned_splats_are_counted_and_the_others_stay_sound() {
    let Some(gpu) = device() else { return };
    let mut backend = backend(&gpu);
    let mut before = splats(100);
    before.positions[3] = [f32::NAN; 3];
    before.log_scales[5] = [f32::INFINITY, 0.0, 0.0];
    before.rotations[7] = [f32::NAN, 1.0, 0.0, 0.0];
    before.opacity_logits[11] = f32::NAN;
    before.sh_dc[13] = [f32::NEG_INFINITY; 3];
    backend.load(TrainingState::new(before), 100).unwrap();
    let views = admitted(&mut backend, 2);
    take_steps(&mut backend, &views, &TrainingConfig::growing(20, 100), 0..20);
    let reports = backend.reports(19).unwrap();
    assert!(reports.iter().all(|report| report.not_finite > 0), "{reports:?}");
    let after = backend.state().unwrap().splats;
    let sound: Vec<u32> = (0..100).filter(|i| ![3, 5, 7, 11, 13].contains(i)).collect();
    assert!(is_finite(&after.gather(&sound)));
}

#[test]
fn a_lost_device_is_told_and_opened_again_with_the_next_state() {
    let Some(gpu) = own_device() else { return };
    let mut backend = backend(&gpu);
    let state = TrainingState::new(splats(50));
    backend.load(state.clone(), 50).unwrap();
    let views = admitted(&mut backend, 1);
    let config = TrainingConfig::fixed(10);
    take_steps(&mut backend, &views, &config, 0..3);
    backend.gpu().device().destroy();
    let mut errors = Vec::new();
    for step in 3..6 {
        errors.extend(backend.step(&config.step_plan(step, 1.0, 1.0), &views[0]).err());
    }
    errors.extend(backend.reports(5).err());
    assert!(!errors.is_empty());
    assert!(errors.iter().all(|error| matches!(error, BackendError::DeviceLost(_))), "{errors:?}");
    backend.load(state, 50).unwrap();
    assert!(!backend.has_target(0));
    let views = admitted(&mut backend, 1);
    take_steps(&mut backend, &views, &config, 0..3);
    assert_eq!(backend.reports(2).unwrap().len(), 3);
}

#[test]
fn what_does_not_fit_is_refused_with_need_and_have() {
    let Some(gpu) = device() else { return };
    let plan = GpuMemoryPlan::new(1_000, ShDegree::Zero, 1 << 10);
    assert_eq!(plan.splats, 4 * 1_000 * 14 * 4);
    let options = GpuBackendOptions {
        target_budget: 1 << 10,
        memory_budget: plan.total() - 1,
        ..Default::default()
    };
    let mut backend = GpuBackend::new(&gpu, options).unwrap();
    let error = backend.load(TrainingState::new(splats(10)), 1_000).unwrap_err();
    let BackendError::OutOfMemory { needed, available, .. } = error else { panic!("{error}") };
    assert_eq!((needed, available), (plan.total(), plan.total() - 1));
    backend.load(TrainingState::new(splats(10)), 999).unwrap();
    let error = backend.admit_target(0, Arc::new(photograph(0, (20, 20)))).unwrap_err();
    assert!(matches!(error, BackendError::OutOfMemory { needed: 1600, .. }), "{error}");
    for id in 0..3 {
        backend.admit_target(id, Arc::new(photograph(id, (10, 10)))).unwrap();
    }
    assert_eq!([0, 1, 2].map(|id| backend.has_target(id)), [false, true, true]);
    let view = TrainingView { id: 2, camera: camera(2, (11, 10)), time: 0.0 };
    let plan = TrainingConfig::fixed(5).step_plan(0, 1.0, 1.0);
    assert!(matches!(backend.step(&plan, &view), Err(BackendError::View { id: 2, .. })));
    let missing = TrainingView { id: 0, ..view };
    assert!(matches!(backend.step(&plan, &missing), Err(BackendError::MissingTarget { id: 0 })));
}
