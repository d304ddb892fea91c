//! Every way in which a PLY file may say the same: types, byte orders, property orders, company.
//!
//! The files are written by `ply-rs-bw`, so that reader and writer do not share a misreading.

mod scenes;

use fastrand::Rng;
use ply_rs_bw::ply::{
    Addable, DefaultElement, ElementDef, Encoding, Ply, Property, PropertyDef, PropertyType,
    ScalarType,
};
use ply_rs_bw::writer::Writer;
use proptest::prelude::*;
use scenes::{numbered_features, random_scene};
use trapeze_formats::ply::parse_ply;
use trapeze_scene::{Scene, ShDegree};

/// The properties of one splat by their names in the file.
fn named_values(scene: &Scene, i: usize) -> Vec<(String, f32)> {
    let splats = &scene.splats;
    let mut values = Vec::new();
    let mut put = |prefix: &str, numbers: &[f32]| {
        for (n, &value) in numbers.iter().enumerate() {
            values.push((format!("{prefix}{n}"), value));
        }
    };
    put("rot_", &splats.rotations[i]);
    put("scale_", &splats.log_scales[i]);
    put("f_dc_", &splats.sh_dc[i]);
    let rest = splats.sh_rest_of(i);
    let coefficients = splats.sh_degree.rest_coefficients();
    let channel_major: Vec<f32> =
        (0..rest.len()).map(|n| rest[n % coefficients * 3 + n / coefficients]).collect();
    put("f_rest_", &channel_major);
    if let Some(features) = &scene.features {
        put("gaussian_feats_", &features.values[i * features.dimensions..][..features.dimensions]);
    }
    values.push(("opacity".into(), splats.opacity_logits[i]));
    for (axis, value) in ["x", "y", "z"].into_iter().zip(splats.positions[i]) {
        values.push((axis.into(), value));
    }
    values
}

/// A number in a type that holds it exactly.
fn property_of(scalar: &ScalarType, value: f32) -> Property {
    match scalar {
        ScalarType::Char => Property::Char(value as i8),
        ScalarType::UChar => Property::UChar(value as u8),
        ScalarType::Short => Property::Short(value as i16),
        ScalarType::UShort => Property::UShort(value as u16),
        ScalarType::Int => Property::Int(value as i32),
        ScalarType::UInt => Property::UInt(value as u32),
        ScalarType::Float => Property::Float(value),
        ScalarType::Double => Property::Double(f64::from(value)),
    }
}

fn random_type(rng: &mut Rng) -> ScalarType {
    let types = [
        ScalarType::Char,
        ScalarType::UChar,
        ScalarType::Short,
        ScalarType::UShort,
        ScalarType::Int,
        ScalarType::UInt,
        ScalarType::Float,
        ScalarType::Double,
    ];
    rng.choice(types).unwrap()
}

/// An element that has nothing to do with splats.
fn stranger(name: &str, rows: usize, rng: &mut Rng) -> (ElementDef, Vec<DefaultElement>) {
    let mut element = ElementDef::new(name.into());
    let list = PropertyType::List(ScalarType::UChar, ScalarType::Double);
    element.properties.add(PropertyDef::new("weights".into(), list));
    element.properties.add(PropertyDef::new("x".into(), PropertyType::Scalar(ScalarType::Short)));
    let row = |rng: &mut Rng| {
        let mut row = DefaultElement::new();
        let weights = (0..rng.usize(..4)).map(|_| rng.f64()).collect();
        row.insert("weights".into(), Property::ListDouble(weights));
        row.insert("x".into(), Property::Short(rng.i16(..)));
        row
    };
    (element, (0..rows).map(|_| row(rng)).collect())
}

/// Writes `scene` in a way that the seed chooses. `scene` is changed to hold what the types hold.
fn written_somehow(scene: &mut Scene, encoding: Encoding, lists: bool, seed: u64) -> Vec<u8> {
    let mut rng = Rng::with_seed(seed);
    let mut ply = Ply::<DefaultElement>::new();
    ply.header.encoding = encoding;
    let (element, rows) = stranger("camera", 3, &mut rng);
    ply.header.elements.add(element);
    ply.payload.insert("camera".into(), rows);

    let names: Vec<String> = if scene.is_empty() {
        named_values(&random_scene(1, scene.splats.sh_degree, 0), 0)
    } else {
        named_values(scene, 0)
    }
    .into_iter()
    .map(|(name, _)| name)
    .collect();
    // Opacities, say, in bytes: only whole numbers then. Everything else keeps its fraction.
    let opacity_type = random_type(&mut rng);
    for logit in &mut scene.splats.opacity_logits {
        *logit = if matches!(opacity_type, ScalarType::Float | ScalarType::Double) {
            *logit
        } else {
            logit.abs().floor()
        };
    }
    let mut vertex = ElementDef::new("vertex".into());
    let mut columns: Vec<PropertyDef> = names
        .iter()
        .map(|name| {
            let float = if rng.bool() { ScalarType::Float } else { ScalarType::Double };
            let scalar = if name == "opacity" { opacity_type.clone() } else { float };
            PropertyDef::new(name.clone(), PropertyType::Scalar(scalar))
        })
        .collect();
    for name in ["nx", "label"] {
        columns.push(PropertyDef::new(name.into(), PropertyType::Scalar(random_type(&mut rng))));
    }
    if lists {
        let list = PropertyType::List(ScalarType::Int, ScalarType::UChar);
        columns.push(PropertyDef::new("neighbours".into(), list));
    }
    rng.shuffle(&mut columns);
    columns.into_iter().for_each(|column| vertex.properties.add(column));

    let rows = (0..scene.len()).map(|i| {
        let mut row = DefaultElement::new();
        for (name, value) in named_values(scene, i) {
            let PropertyType::Scalar(scalar) = &vertex.properties[&name].data_type else {
                unreachable!("only neighbours is a list")
            };
            row.insert(name, property_of(scalar, value));
        }
        for name in ["nx", "label"] {
            let PropertyType::Scalar(scalar) = &vertex.properties[name].data_type else {
                unreachable!("only neighbours is a list")
            };
            row.insert(name.into(), property_of(scalar, 7.0));
        }
        row.insert("neighbours".into(), Property::ListUChar(vec![9; i % 3]));
        row
    });
    ply.payload.insert("vertex".into(), rows.collect());
    ply.header.elements.add(vertex);
    let (element, rows) = stranger("face", 2, &mut rng);
    ply.header.elements.add(element);
    ply.payload.insert("face".into(), rows);

    let mut bytes = Vec::new();
    Writer::new().write_ply(&mut bytes, &mut ply).unwrap();
    bytes
}

proptest! {
    #[test]
    fn any_order_type_and_byte_order_gives_the_same_scene(
        degree in prop::sample::select(ShDegree::ALL.to_vec()),
        encoding in prop::sample::select(vec![
            Encoding::Ascii, Encoding::BinaryLittleEndian, Encoding::BinaryBigEndian,
        ]),
        count in 0usize..12,
        dimensions in 0usize..14,
        lists: bool,
        seed: u64,
    ) {
        let mut scene = random_scene(count, degree, seed);
        if dimensions > 0 && count > 0 {
            scene.features = Some(numbered_features(count, dimensions));
        }
        let bytes = written_somehow(&mut scene, encoding, lists, seed);
        let read = parse_ply(&bytes);
        prop_assert!(read.is_ok(), "{}", read.unwrap_err());
        prop_assert_eq!(read.unwrap(), scene);
    }
}

#[test]
fn values_that_are_not_finite_are_kept_in_every_encoding() {
    let mut scene = random_scene(3, ShDegree::One, 1);
    scene.splats.positions[1] = [f32::INFINITY, f32::NEG_INFINITY, 1.0];
    scene.splats.opacity_logits[0] = f32::INFINITY;
    scene.splats.sh_rest[4] = f32::NEG_INFINITY;
    scene.splats.rotations[2][1] = f32::INFINITY;
    for encoding in [Encoding::Ascii, Encoding::BinaryLittleEndian, Encoding::BinaryBigEndian] {
        // A seed whose opacity column is a float.
        let seed = (0..).find(|&seed| {
            let mut copy = scene.clone();
            written_somehow(&mut copy, encoding, false, seed);
            copy == scene
        });
        let bytes = written_somehow(&mut scene, encoding, false, seed.unwrap());
        assert_eq!(parse_ply(&bytes).unwrap(), scene);
    }
    scene.splats.rotations[2][1] = f32::NAN;
    let text = b"ply\nformat ascii 1.0\nelement vertex 1\n".to_vec();
    let mut text = String::from_utf8(text).unwrap();
    named_values(&random_scene(1, ShDegree::Zero, 0), 0)
        .iter()
        .for_each(|(name, _)| text += &format!("property float {name}\n"));
    text += "end_header\n1 nan -nan NaN 0 0 0 0 0 0 Infinity -inf .5 5.\n";
    let splats = parse_ply(text.as_bytes()).unwrap().splats;
    assert!(splats.rotations[0][1..].iter().all(|c| c.is_nan()));
    assert_eq!(splats.opacity_logits[0], f32::INFINITY);
    assert_eq!(splats.positions[0], [f32::NEG_INFINITY, 0.5, 5.0]);
}
