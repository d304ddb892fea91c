// Quaternions of any length, and the rotations that they stand for.
//
// Needs: common/numbers.

/// Quaternions shorter than this get no gradient.
const MIN_TRAINED_ROTATION_LENGTH: f32 = 1e-12;

/// q / ‖q‖ and ‖q‖; the identity and 0 where q has no direction.
struct UnitRotation {
    rotation: vec4<f32>,
    length: f32,
}

fn unit_rotation(q: vec4<f32>) -> UnitRotation {
    let largest = max(max(abs(q.x), abs(q.y)), max(abs(q.z), abs(q.w)));
    let finite = is_finite(q.x) && is_finite(q.y) && is_finite(q.z) && is_finite(q.w);
    if (!finite || !(largest > 0.0)) {
        return UnitRotation(vec4<f32>(1.0, 0.0, 0.0, 0.0), 0.0);
    }
    // Divided by the largest component first: squares of what a file can hold leave f32.
    let scaled = q / largest;
    let norm = sqrt(dot(scaled, scaled));
    return UnitRotation(scaled / norm, norm * largest);
}

/// ∂L/∂q from ∂L/∂(q / ‖q‖): what is along q has no effect.
fn unit_backward(unit: UnitRotation, by_unit: vec4<f32>) -> vec4<f32> {
    if (unit.length < MIN_TRAINED_ROTATION_LENGTH) {
        return vec4<f32>(0.0);
    }
    return (by_unit - dot(unit.rotation, by_unit) * unit.rotation) / unit.length;
}
