//! The checks on this device, their goldens against the reference, and what follows from a failure.

use std::path::Path;

use trapeze_cpu::reference;

use super::*;
use crate::kernel_tests::device;

#[test]
fn the_kept_goldens_are_the_references_images() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/goldens/self-check");
    let export = std::env::var_os("TRAPEZE_EXPORT_GOLDENS").is_some();
    let at_time = FrameSettings { time: TIME, ..FrameSettings::default() };
    let masked = FrameSettings { static_threshold: Some(THRESHOLD), ..at_time.clone() };
    for (name, checked, scene, settings) in [
        ("still", Checked::Still, scene::still(), FrameSettings::default()),
        ("moving", Checked::Moving, scene::moving(), at_time),
        ("masked", Checked::Masked, scene::moving(), masked),
    ] {
        let exact = reference::render(&scene, &scene::camera(), &settings).to_frame().color;
        if export {
            let bytes: Vec<u8> = exact.iter().flatten().flat_map(|c| c.to_le_bytes()).collect();
            std::fs::write(folder.join(format!("{name}.f32")), bytes).unwrap();
            continue;
        }
        let kept = golden(checked).unwrap();
        assert_eq!(kept.len(), exact.len(), "{name}: run scripts/export-goldens");
        // The reference is f64; only libraries' exp and sin may differ from machine to machine.
        let same = psnr(&kept, &exact) > 120.0;
        assert!(same, "{name}: run scripts/export-goldens");
        let covered = exact.iter().filter(|p| p[3] > 0.1).count();
        assert!(covered * 2 > exact.len(), "{name}: {covered} pixels show anything");
    }
    let difference = |a, b| psnr(&golden(a).unwrap(), &golden(b).unwrap());
    if !export {
        // Each image shows something of its own.
        assert!(difference(Checked::Still, Checked::Moving) < 40.0);
        assert!(difference(Checked::Moving, Checked::Masked) < 40.0);
    }
}

#[test]
fn every_kernel_passes_on_this_device() {
    let Some(gpu) = device() else { return };
    let report = self_check(&gpu);
    assert!(report.usable && report.checks.iter().all(|check| check.passed), "{report:#?}");
    let network = |checked| {
        report.checks.iter().find(|check| check.checked == checked).and_then(|check| check.network)
    };
    assert_eq!(network(Checked::Moving), Some("f32"));
    if report.device.half_floats {
        assert!(network(Checked::HalfNetwork).unwrap().starts_with("f16"));
    }
    // A variant is really another one: bytes are not halves.
    let quality = |checked| {
        report.checks.iter().find(|check| check.checked == checked).and_then(|check| check.psnr)
    };
    assert!(quality(Checked::ByteHarmonics) < quality(Checked::HalfHarmonics));
}

/// A report in which some checks have failed.
fn report(failed: &[Checked]) -> SelfCheckReport {
    let device = DeviceReport {
        name: "a device".into(),
        backend: "metal".into(),
        driver: String::new(),
        kind: String::new(),
        subgroup_sizes: [32, 32],
        workgroup_memory: 32 << 10,
        storage_buffers: 29,
        binding_bytes: 1 << 30,
        timestamps: true,
        half_floats: true,
        matrices: false,
    };
    let good = vec![[0.5, 0.5, 0.5, 1.0]; 4];
    let bad = vec![[0.5, 0.4, 0.5, 1.0]; 4];
    let checks = [
        (Checked::Still, Against::Golden),
        (Checked::Moving, Against::Golden),
        (Checked::Masked, Against::Golden),
        (Checked::HalfHarmonics, Against::PlainKernels),
        (Checked::ByteHarmonics, Against::PlainKernels),
        (Checked::HalfNetwork, Against::PlainKernels),
    ]
    .map(|(checked, against)| {
        let image = if failed.contains(&checked) { bad.clone() } else { good.clone() };
        let drawn = Ok(Drawn { image, network: None, time: Duration::from_millis(2) });
        check(checked, against, &drawn, Some(&good))
    });
    SelfCheckReport::new(device, checks.to_vec())
}

#[test]
fn what_fails_is_replaced_by_the_next_more_precise_kernel() {
    let wanted = RendererOptions {
        harmonics: HarmonicsStorage::Byte,
        precision: NetworkPrecision::Half,
        ..RendererOptions::default()
    };
    let allowed = |failed: &[Checked]| {
        let report = report(failed);
        let options = report.allowed(wanted);
        (report.usable, options.harmonics, options.precision)
    };
    use Checked::{ByteHarmonics, HalfHarmonics, HalfNetwork, Moving};
    use HarmonicsStorage::{Byte, Half, Single};
    assert_eq!(allowed(&[]), (true, Byte, NetworkPrecision::Half));
    assert_eq!(allowed(&[HalfNetwork]), (true, Byte, NetworkPrecision::Single));
    assert_eq!(allowed(&[ByteHarmonics]), (true, Half, NetworkPrecision::Half));
    assert_eq!(allowed(&[ByteHarmonics, HalfHarmonics]), (true, Single, NetworkPrecision::Half));
    assert_eq!(allowed(&[Moving]), (false, Byte, NetworkPrecision::Half));
}

#[test]
fn a_frame_that_cannot_be_drawn_or_is_not_a_number_fails_and_says_why() {
    let lost = check(
        Checked::Still,
        Against::Golden,
        &Err(GpuError::DeviceLost("unplugged".into())),
        Some(&[[0.0; 4]]),
    );
    assert!(!lost.passed && lost.error.unwrap().contains("unplugged"));
    let drawn = Drawn { image: vec![[f32::NAN; 4]], network: None, time: Duration::ZERO };
    let nan = check(Checked::Still, Against::Golden, &Ok(drawn), Some(&[[0.0; 4]]));
    assert!(!nan.passed && nan.psnr.is_none());
}
