//! One fully connected layer, for a group of splats at a time, over the features that are not zero.
//!
//! After a ReLU most features are zero, and for splats that are close to each other mostly the
//! same ones: in the sample scene 23 % of the hidden features of a splat are not zero, and 32 % of
//! those of eight neighbours taken together. Leaving the others out saves two thirds of the
//! multiply–adds and changes nothing: with finite weights their products are exactly 0. So a
//! splat's result does not depend on the splats that it shares a group with, either. A general
//! matrix product cannot leave them out; that is why this is our own kernel.

use fearless_simd::prelude::*;
use fearless_simd_macros::simd;

use super::group::{Activations, Active, BLOCK, GROUP, Group, Row, blocks};

/// Outputs of a strip: one cache line of weights for each input.
const STRIP: usize = 16;

/// Weights of [`STRIP`] outputs for one block of inputs, input-major.
type Strip = [[f32; STRIP]; BLOCK];

/// Weights of a layer, rearranged so that the kernel reads whole cache lines.
#[derive(Clone, Debug)]
pub(super) struct PackedLayer {
    outputs: usize,
    input_blocks: usize,
    /// `strips[output_strip * input_blocks + input_block]`; outputs and inputs padded with zeros.
    strips: Vec<Strip>,
}

impl PackedLayer {
    /// Packs the columns `columns` of a row-major `outputs` × `stride` matrix.
    pub(super) fn pack(weight: &[f32], stride: usize, columns: std::ops::Range<usize>) -> Self {
        let outputs = weight.len() / stride;
        let input_blocks = blocks(columns.len());
        let mut strips = vec![[[0.0; STRIP]; BLOCK]; outputs.div_ceil(STRIP) * input_blocks];
        for (output, row) in weight.chunks_exact(stride).enumerate() {
            for (input, &w) in row[columns.clone()].iter().enumerate() {
                let strip = output / STRIP * input_blocks + input / BLOCK;
                strips[strip][input % BLOCK][output % STRIP] = w;
            }
        }
        Self { outputs, input_blocks, strips }
    }

    /// A layer whose products are all in the start values already.
    pub(super) fn without_inputs(outputs: usize) -> Self {
        Self { outputs, input_blocks: 0, strips: Vec::new() }
    }
}

/// What a layer's sums start from: `own[block][splat] + shared[block]`.
#[derive(Clone, Copy)]
pub(super) struct Start<'a> {
    /// One row per splat.
    pub(super) own: &'a [Group],
    /// One row for all.
    pub(super) shared: &'a [Row],
}

/// What happens to the sums.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Activation {
    /// max(0, x), NaN → 0; the list of active features is written too.
    Relu,
    /// Nothing; the list of active features is left as it is.
    None,
}

/// `output` = activation(start + W · `input`), for the features of `input` that are active.
#[simd]
pub(super) fn apply_layer<S: Simd>(
    simd: S,
    layer: &PackedLayer,
    input: &Activations,
    start: Start<'_>,
    activation: Activation,
    output: &mut Activations,
) {
    if activation == Activation::Relu {
        output.active.iter_mut().for_each(Active::clear);
    }
    let lanes = S::f32s::LEN;
    let vectors = layer.outputs.next_multiple_of(STRIP) / lanes;
    let mut first = 0;
    // Two vectors of outputs at a time where there are 32 registers (AVX-512, NEON): 16 sums, 8
    // inputs and 2 weights stay in registers, and 16 sums hide the latency of two multiply–add
    // ports. Three vectors read less but spill (15 % slower); 16 registers hold one.
    if lanes != 8 {
        while first + 2 <= vectors {
            apply_columns::<S, 2>(simd, layer, input, start, activation, output, first);
            first += 2;
        }
    }
    while first < vectors {
        apply_columns::<S, 1>(simd, layer, input, start, activation, output, first);
        first += 1;
    }
}

/// The columns of `V` vectors of outputs, from the `first` vector on.
#[inline(always)]
fn apply_columns<S: Simd, const V: usize>(
    simd: S,
    layer: &PackedLayer,
    input: &Activations,
    start: Start<'_>,
    activation: Activation,
    output: &mut Activations,
    first: usize,
) {
    let lanes = S::f32s::LEN;
    let column = |v: usize| (first + v) * lanes;
    let zero = S::f32s::splat(simd, 0.0);

    let mut sums = [[zero; V]; GROUP];
    for v in 0..V {
        let (block, at) = (column(v) / BLOCK, column(v) % BLOCK);
        let shared = S::f32s::from_slice(simd, &start.shared[block][at..at + lanes]);
        for s in 0..GROUP {
            let own = S::f32s::from_slice(simd, &start.own[block][s][at..at + lanes]);
            sums[s][v] = own + shared;
        }
    }

    for block in 0..layer.input_blocks {
        let strips: [&Strip; V] =
            std::array::from_fn(|v| &layer.strips[column(v) / STRIP * layer.input_blocks + block]);
        let offsets: [usize; V] = std::array::from_fn(|v| column(v) % STRIP);
        let rows = &input.rows[block];
        for &feature in input.active[block].features() {
            let k = usize::from(feature);
            let weights: [S::f32s; V] = std::array::from_fn(|v| {
                S::f32s::from_slice(simd, &strips[v][k][offsets[v]..offsets[v] + lanes])
            });
            for s in 0..GROUP {
                let x = S::f32s::splat(simd, rows[s][k]);
                for v in 0..V {
                    sums[s][v] = weights[v].mul_add(x, sums[s][v]);
                }
            }
        }
    }

    for v in 0..V {
        let (block, at) = (column(v) / BLOCK, column(v) % BLOCK);
        let mut highest = zero;
        for s in 0..GROUP {
            let sum = sums[s][v];
            let value = match activation {
                Activation::Relu => sum.simd_gt(zero).select(sum, zero),
                Activation::None => sum,
            };
            value.store_slice(&mut output.rows[block][s][at..at + lanes]);
            highest = highest.max(value);
        }
        if activation == Activation::Relu {
            output.active[block].push_bits(highest.simd_gt(zero).to_bitmask(), at);
        }
    }
}

#[cfg(test)]
mod tests {
    use fearless_simd::{Level, dispatch};

    use super::*;
    use crate::deform::group::to_rows;

    /// Whole numbers up to ±3: every sum is exact, so the order of additions cannot matter.
    fn whole_number(i: usize) -> f32 {
        (i * 2_654_435_761 % 4_294_967_291 % 7) as f32 - 3.0
    }

    #[test]
    fn a_layer_is_a_matrix_product_at_every_width_and_simd_level() {
        for (inputs, outputs) in [(5, 3), (63, 256), (256, 10), (300, 520), (512, 100)] {
            let stride = inputs + 4;
            let weight: Vec<f32> = (0..outputs * stride).map(whole_number).collect();
            let bias: Vec<f32> = (0..outputs).map(|i| whole_number(3 * i + 1)).collect();
            let layer = PackedLayer::pack(&weight, stride, 2..2 + inputs);

            let mut input = Activations::new(inputs);
            for s in 0..GROUP {
                for k in 0..inputs {
                    input.rows[k / BLOCK][s][k % BLOCK] = whole_number(k * 31 + s).max(0.0);
                }
            }
            let own = vec![[[0.5; BLOCK]; GROUP]; blocks(outputs)];
            let start = Start { own: &own, shared: &to_rows(&bias) };
            for level in [Level::new(), Level::baseline()] {
                let mut output = Activations::new(outputs);
                dispatch!(level, simd => apply_layer(
                    simd, &layer, &input, start, Activation::Relu, &mut output));
                for o in 0..outputs {
                    let expected: [f32; GROUP] = std::array::from_fn(|s| {
                        let products = (0..inputs).map(|k| {
                            weight[o * stride + 2 + k] * input.rows[k / BLOCK][s][k % BLOCK]
                        });
                        (products.sum::<f32>() + bias[o] + 0.5).max(0.0)
                    });
                    let (block, at) = (o / BLOCK, o % BLOCK);
                    let found: [f32; GROUP] = std::array::from_fn(|s| output.rows[block][s][at]);
                    assert_eq!(found, expected, "{inputs} × {outputs}, output {o}, {level:?}");
                    let active = output.active[block].features().contains(&(at as u8));
                    assert_eq!(active, expected.iter().any(|&x| x > 0.0));
                }
            }
        }
    }

    #[test]
    fn relu_of_a_sum_that_is_not_a_number_is_zero() {
        let layer = PackedLayer::without_inputs(16);
        let own = [[[f32::NAN; BLOCK]; GROUP]];
        let start = Start { own: &own, shared: &[[0.0; BLOCK]] };
        let mut output = Activations::new(16);
        let input = Activations::new(0);
        dispatch!(Level::new(), simd => apply_layer(
            simd, &layer, &input, start, Activation::Relu, &mut output));
        assert!(output.rows[0].iter().all(|row| row[..16].iter().all(|&x| x == 0.0)));
        assert!(output.active[0].features().is_empty());
    }
}
