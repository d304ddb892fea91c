//! From named tensors to a network: the architecture is read off the shapes, and what fits no
//! published variant is refused by the name of the tensor that does not fit.

use std::collections::BTreeMap;

use super::{DeformationNetwork, Encoding, Linear, PositionHead, RotationRule, TimeNetwork};
use crate::ArchitectureError;

/// A dense f32 tensor, row-major.
#[derive(Clone, Debug, PartialEq)]
pub struct Tensor {
    /// Extent of each dimension.
    pub shape: Vec<usize>,
    /// Values, last dimension fastest.
    pub data: Vec<f32>,
}

/// A state dict: tensors by name.
pub type NamedTensors = BTreeMap<String, Tensor>;

/// Octaves of the encoded time that upstream fixes: with `is_blender`, and without.
const TIME_OCTAVES_BLENDER: usize = 6;
const TIME_OCTAVES: usize = 10;

/// Bounds that keep a hostile file from asking for absurd work per splat.
const MAX_LAYERS: usize = 64;
const MAX_WIDTH: usize = 4096;

impl DeformationNetwork {
    /// Builds the network from a state dict with upstream's names (`linear.i.weight`,
    /// `gaussian_warp.bias`, `branch_w.weight`, `timenet.0.weight`, …).
    ///
    /// Without a time network the time has upstream's 10 octaves and the rest of the input width
    /// is the encoded position; with one, the time has the octaves that the time network's own
    /// shape names. So a 42-wide input is 3 octaves of xyz (21) and 10 of t (21).
    ///
    /// # Errors
    /// [`ArchitectureError`] names the tensor that is missing, unknown or of the wrong shape.
    pub fn from_tensors(mut tensors: NamedTensors) -> Result<Self, ArchitectureError> {
        let time_network = take_time_network(&mut tensors)?;
        let hidden = take_hidden(&mut tensors)?;
        let width = hidden[0].outputs;
        let position_head = if tensors.contains_key("branch_w.weight") {
            PositionHead::Screw {
                w: take_linear(&mut tensors, "branch_w", Some(3), Some(width))?,
                v: take_linear(&mut tensors, "branch_v", Some(3), Some(width))?,
            }
        } else {
            PositionHead::Translation(take_linear(
                &mut tensors,
                "gaussian_warp",
                Some(3),
                Some(width),
            )?)
        };
        let rotation_head = take_linear(&mut tensors, "gaussian_rotation", Some(4), Some(width))?;
        let scale_head = take_linear(&mut tensors, "gaussian_scaling", Some(3), Some(width))?;
        if let Some(name) = tensors.into_keys().next() {
            return Err(ArchitectureError::Unknown { name });
        }

        let inputs = hidden[0].inputs;
        let (time_encoding, time_width) = match &time_network {
            Some(net) => (time_encoding_of(net)?, net.output.outputs),
            None => {
                let encoding = Encoding { dimensions: 1, octaves: TIME_OCTAVES };
                (encoding, encoding.width())
            }
        };
        let position_encoding = inputs
            .checked_sub(time_width)
            .and_then(|width| Encoding::from_width(3, width))
            .ok_or_else(|| ArchitectureError::Shape {
                name: "linear.0.weight".into(),
                expected: format!("[{width}, {time_width} + 3·(1 + 2·octaves)]"),
                found: vec![width, inputs],
            })?;
        let skip_after = check_hidden(&hidden)?;
        Ok(Self {
            position_encoding,
            time_encoding,
            time_network,
            hidden,
            skip_after,
            position_head,
            rotation_head,
            scale_head,
            rotation_rule: RotationRule::default(),
        })
    }

    /// The state dict of this network, with upstream's names.
    #[must_use]
    pub fn to_tensors(&self) -> NamedTensors {
        let mut named: Vec<(String, &Linear)> = Vec::new();
        if let Some(net) = &self.time_network {
            named.push(("timenet.0".into(), &net.hidden));
            named.push(("timenet.2".into(), &net.output));
        }
        named.extend(self.hidden.iter().enumerate().map(|(i, l)| (format!("linear.{i}"), l)));
        match &self.position_head {
            PositionHead::Translation(warp) => named.push(("gaussian_warp".into(), warp)),
            PositionHead::Screw { w, v } => {
                named.extend([("branch_w".into(), w), ("branch_v".into(), v)]);
            }
        }
        named.push(("gaussian_rotation".into(), &self.rotation_head));
        named.push(("gaussian_scaling".into(), &self.scale_head));
        named
            .into_iter()
            .flat_map(|(name, l)| {
                let weight = Tensor { shape: vec![l.outputs, l.inputs], data: l.weight.clone() };
                let bias = Tensor { shape: vec![l.outputs], data: l.bias.clone() };
                [(format!("{name}.weight"), weight), (format!("{name}.bias"), bias)]
            })
            .collect()
    }
}

fn take_time_network(tensors: &mut NamedTensors) -> Result<Option<TimeNetwork>, ArchitectureError> {
    if !tensors.contains_key("timenet.0.weight") {
        return Ok(None);
    }
    let hidden = take_linear(tensors, "timenet.0", None, None)?;
    let output = take_linear(tensors, "timenet.2", None, Some(hidden.outputs))?;
    Ok(Some(TimeNetwork { hidden, output }))
}

fn time_encoding_of(net: &TimeNetwork) -> Result<Encoding, ArchitectureError> {
    Encoding::from_width(1, net.hidden.inputs).ok_or_else(|| ArchitectureError::Shape {
        name: "timenet.0.weight".into(),
        expected: format!(
            "[{}, 1 + 2·octaves] ({TIME_OCTAVES_BLENDER} octaves upstream)",
            net.hidden.outputs
        ),
        found: vec![net.hidden.outputs, net.hidden.inputs],
    })
}

fn take_hidden(tensors: &mut NamedTensors) -> Result<Vec<Linear>, ArchitectureError> {
    let mut hidden = Vec::new();
    while hidden.is_empty() || tensors.contains_key(&format!("linear.{}.weight", hidden.len())) {
        if hidden.len() == MAX_LAYERS {
            return Err(ArchitectureError::Unknown { name: format!("linear.{MAX_LAYERS}.weight") });
        }
        hidden.push(take_linear(tensors, &format!("linear.{}", hidden.len()), None, None)?);
    }
    Ok(hidden)
}

/// Checks the widths of the hidden stack and returns the index before the skip: upstream always
/// uses `depth / 2`, and the shapes have to agree.
fn check_hidden(hidden: &[Linear]) -> Result<usize, ArchitectureError> {
    let (inputs, width) = (hidden[0].inputs, hidden[0].outputs);
    let skip_after = hidden.len() / 2;
    for (i, layer) in hidden.iter().enumerate() {
        let expected_inputs = match i {
            0 => inputs,
            i if i == skip_after + 1 => inputs + width,
            _ => width,
        };
        if layer.inputs != expected_inputs || layer.outputs != width {
            return Err(ArchitectureError::Shape {
                name: format!("linear.{i}.weight"),
                expected: format!("[{width}, {expected_inputs}]"),
                found: vec![layer.outputs, layer.inputs],
            });
        }
    }
    // With fewer than three layers the skip would feed the heads, which upstream cannot build.
    if hidden.len() < 3 {
        return Err(ArchitectureError::Missing { name: format!("linear.{}.weight", hidden.len()) });
    }
    Ok(skip_after)
}

fn take_linear(
    tensors: &mut NamedTensors,
    name: &str,
    outputs: Option<usize>,
    inputs: Option<usize>,
) -> Result<Linear, ArchitectureError> {
    let weight = take(tensors, format!("{name}.weight"))?;
    let bias = take(tensors, format!("{name}.bias"))?;
    let axis =
        |expected: Option<usize>, what: &str| expected.map_or(what.into(), |n| n.to_string());
    let fits = matches!(weight.shape[..], [o, i]
        if outputs.is_none_or(|e| e == o) && inputs.is_none_or(|e| e == i)
            && (1..=MAX_WIDTH).contains(&o) && (1..=MAX_WIDTH).contains(&i)
            && weight.data.len() == o * i);
    if !fits {
        return Err(ArchitectureError::Shape {
            name: format!("{name}.weight"),
            expected: format!("[{}, {}]", axis(outputs, "out"), axis(inputs, "in")),
            found: weight.shape,
        });
    }
    let (outputs, inputs) = (weight.shape[0], weight.shape[1]);
    if bias.shape != [outputs] || bias.data.len() != outputs {
        return Err(ArchitectureError::Shape {
            name: format!("{name}.bias"),
            expected: format!("[{outputs}]"),
            found: bias.shape,
        });
    }
    Ok(Linear { inputs, outputs, weight: weight.data, bias: bias.data })
}

fn take(tensors: &mut NamedTensors, name: String) -> Result<Tensor, ArchitectureError> {
    match tensors.remove(&name) {
        Some(tensor) => Ok(tensor),
        // A dict of another model is best refused by a name that it does have.
        None => match tensors.keys().find(|key| !is_known(key)) {
            Some(unknown) => Err(ArchitectureError::Unknown { name: unknown.clone() }),
            None => Err(ArchitectureError::Missing { name }),
        },
    }
}

fn is_known(name: &str) -> bool {
    let modules = [
        "linear.",
        "timenet.",
        "gaussian_warp.",
        "gaussian_rotation.",
        "gaussian_scaling.",
        "branch_w.",
        "branch_v.",
    ];
    modules.iter().any(|module| name.starts_with(module))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn add(tensors: &mut NamedTensors, name: &str, outputs: usize, inputs: usize) {
        let weight = Tensor { shape: vec![outputs, inputs], data: vec![0.5; outputs * inputs] };
        let bias = Tensor { shape: vec![outputs], data: vec![0.25; outputs] };
        tensors.insert(format!("{name}.weight"), weight);
        tensors.insert(format!("{name}.bias"), bias);
    }

    fn state_dict(inputs: usize, heads: &[(&str, usize)]) -> NamedTensors {
        let mut tensors = NamedTensors::new();
        for i in 0..8 {
            let layer_inputs = match i {
                0 => inputs,
                5 => inputs + 256,
                _ => 256,
            };
            add(&mut tensors, &format!("linear.{i}"), 256, layer_inputs);
        }
        for &(name, outputs) in heads {
            add(&mut tensors, name, outputs, 256);
        }
        tensors
    }

    const STANDARD: [(&str, usize); 3] =
        [("gaussian_warp", 3), ("gaussian_rotation", 4), ("gaussian_scaling", 3)];

    #[test]
    fn the_standard_network_is_recognised() {
        let net = DeformationNetwork::from_tensors(state_dict(84, &STANDARD)).unwrap();
        assert!(net.is_standard());
        assert_eq!(net.parameter_count(), 506_378);
        assert_eq!((net.position_width(), net.time_width()), (63, 21));
    }

    #[test]
    fn the_blender_and_six_dof_variants_are_recognised() {
        let heads =
            [("branch_w", 3), ("branch_v", 3), ("gaussian_rotation", 4), ("gaussian_scaling", 3)];
        let mut tensors = state_dict(93, &heads);
        add(&mut tensors, "timenet.0", 256, 13);
        add(&mut tensors, "timenet.2", 30, 256);
        let net = DeformationNetwork::from_tensors(tensors.clone()).unwrap();
        assert!(!net.is_standard());
        assert_eq!(net.time_encoding.octaves, 6);
        assert!(matches!(net.position_head, PositionHead::Screw { .. }));
        assert_eq!(net.to_tensors(), tensors);
    }

    #[test]
    fn another_encoding_width_is_read_off_the_shapes() {
        let net = DeformationNetwork::from_tensors(state_dict(42, &STANDARD)).unwrap();
        assert_eq!((net.position_encoding.octaves, net.time_encoding.octaves), (3, 10));
    }

    #[test]
    fn what_fits_nothing_is_refused_by_the_tensor_name() {
        let refused = |tensors| DeformationNetwork::from_tensors(tensors).unwrap_err().to_string();

        assert!(refused(state_dict(83, &STANDARD)).contains("linear.0.weight"));

        let mut missing = state_dict(84, &STANDARD);
        missing.remove("linear.3.bias");
        assert!(refused(missing).contains("linear.3.bias"));

        let mut extra = state_dict(84, &STANDARD);
        add(&mut extra, "encoder.0", 64, 3);
        assert!(refused(extra).contains("encoder.0"));

        let mut wrong = state_dict(84, &STANDARD);
        add(&mut wrong, "linear.5", 256, 256);
        assert!(refused(wrong).contains("linear.5.weight"));

        let mut head = state_dict(84, &STANDARD);
        add(&mut head, "gaussian_rotation", 3, 256);
        assert!(refused(head).contains("gaussian_rotation.weight"));

        assert!(refused(NamedTensors::new()).contains("linear.0.weight"));
    }

    #[test]
    fn a_shape_that_its_data_does_not_fill_is_refused() {
        let mut tensors = state_dict(84, &STANDARD);
        tensors.get_mut("linear.2.weight").unwrap().data.pop();
        let error = DeformationNetwork::from_tensors(tensors).unwrap_err();
        assert!(error.to_string().contains("linear.2.weight"));
    }
}
