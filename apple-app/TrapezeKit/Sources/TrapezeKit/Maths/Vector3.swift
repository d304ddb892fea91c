import Foundation

/// A point or direction in world units.
public typealias Vector3 = SIMD3<Double>

extension SIMD3 where Scalar == Double {
  public func dot(_ other: Self) -> Double { (self * other).sum() }

  public func cross(_ other: Self) -> Self {
    Self(
      y * other.z - z * other.y,
      z * other.x - x * other.z,
      x * other.y - y * other.x
    )
  }

  public var length: Double { dot(self).squareRoot() }

  public func distance(to other: Self) -> Double { (self - other).length }

  /// The direction; `nil` for zero and what is not finite.
  public var normalized: Self? {
    let length = length
    return length > 0 && length.isFinite ? self / length : nil
  }

  /// A unit vector at a right angle to this one, which has to be of unit length.
  public var anyPerpendicular: Self {
    let axis: Self = abs(x) < 0.6 ? Self(1, 0, 0) : Self(0, 1, 0)
    return cross(axis).normalized ?? Self(0, 0, 1)
  }

  public var isFinite: Bool { x.isFinite && y.isFinite && z.isFinite }
}
