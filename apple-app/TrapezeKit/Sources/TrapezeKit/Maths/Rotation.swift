import Foundation

extension SIMD3 where Scalar == Double {
  /// The vector turned by `angle` (radians, right-handed) about a unit axis: Rodrigues' formula.
  public func rotated(by angle: Double, about axis: Self) -> Self {
    let (s, c) = (sin(angle), cos(angle))
    return self * c + axis.cross(self) * s + axis * (axis.dot(self) * (1 - c))
  }
}

/// The angle plus a whole number of turns, in −π…π.
func wrappedAngle(_ angle: Double) -> Double {
  angle.remainder(dividingBy: 2 * .pi)
}

/// A value limited to a range; what is not a number becomes its lower end.
func clamped(_ value: Double, _ range: ClosedRange<Double>) -> Double {
  value.isNaN ? range.lowerBound : min(max(value, range.lowerBound), range.upperBound)
}

/// 3x² − 2x³: starts and ends at rest.
func smoothstep(_ x: Double) -> Double {
  let x = clamped(x, 0...1)
  return x * x * (3 - 2 * x)
}
