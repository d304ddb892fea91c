import Foundation

/// Where the viewer stands: on a sphere around a target, level with the horizon.
///
/// Azimuth and elevation, not a free rotation: the elevation ends at the poles, so whatever a
/// gesture does, the horizon stays level and the picture never turns over. The axes of the image are
/// computed from the angles and not from a cross product with `up`, so the poles are no special case.
public struct OrbitPose: Sendable, Equatable, Codable {
  /// What is looked at and turned around.
  public var target: Vector3
  /// From the target to the eye, world units.
  public var distance: Double
  /// Radians around `up`; 0 looks from the front.
  public var azimuth: Double
  /// Radians above the horizon, −π/2 to π/2.
  public var elevation: Double {
    didSet { elevation = clamped(elevation, -.pi / 2 ... .pi / 2) }
  }
  /// Unit vector that is up in the image.
  public var up: Vector3
  /// Vertical opening of the view in radians.
  public var fieldOfView: Double

  public static let defaultFieldOfView = 50 * Double.pi / 180

  public init(
    target: Vector3 = .zero, distance: Double = 1, azimuth: Double = 0, elevation: Double = 0,
    up: Vector3 = UpAxis.minusY.direction, fieldOfView: Double = Self.defaultFieldOfView
  ) {
    self.target = target
    self.distance = distance
    self.azimuth = azimuth
    self.elevation = clamped(elevation, -.pi / 2 ... .pi / 2)
    self.up = up.normalized ?? UpAxis.minusY.direction
    self.fieldOfView = fieldOfView
  }

  /// Horizontal axes: the front, from which azimuth 0 looks, and the side. The front is the world's
  /// z where that is not up, y otherwise, as in the core's auto-framing.
  private var horizon: (front: Vector3, side: Vector3) {
    let helper: Vector3 = abs(up.z) < 0.9 ? Vector3(0, 0, 1) : Vector3(0, 1, 0)
    let front = (helper - up * helper.dot(up)).normalized ?? up.anyPerpendicular
    return (front, up.cross(front))
  }

  /// From the target towards the eye, of unit length.
  public var direction: Vector3 {
    let (front, side) = horizon
    return (front * cos(azimuth) + side * sin(azimuth)) * cos(elevation) + up * sin(elevation)
  }

  public var eye: Vector3 { target + direction * distance }

  /// Right, down and forward in world coordinates: an orthonormal, right-handed frame.
  public var axes: (right: Vector3, down: Vector3, forward: Vector3) {
    let (front, side) = horizon
    let right = side * cos(azimuth) - front * sin(azimuth)
    let forward = -direction
    return (right, forward.cross(right), forward)
  }

  /// World units per point at the target's depth.
  public func unitsPerPoint(in viewport: Viewport) -> Double {
    2 * distance * tan(fieldOfView / 2) / max(viewport.height, 1)
  }

  public func camera(in viewport: Viewport) -> Camera {
    let (right, down, forward) = axes
    let eye = eye
    let (width, height) = (viewport.pixelWidth, viewport.pixelHeight)
    let focal = Double(height) / (2 * tan(fieldOfView / 2))
    return Camera(
      width: width, height: height, fx: focal, fy: focal,
      cx: Double(width) / 2, cy: Double(height) / 2,
      worldToCamera: Matrix4(
        rotationRows: (right, down, forward),
        translation: -Vector3(right.dot(eye), down.dot(eye), forward.dot(eye))))
  }

  /// The same direction, moved so that a sphere around the bounds fills the view.
  public func framing(_ bounds: Bounds, in viewport: Viewport) -> Self {
    var pose = self
    let aspect = viewport.isEmpty ? 1 : viewport.width / viewport.height
    let halfNarrow = atan(tan(fieldOfView / 2) * min(aspect, 1))
    pose.target = bounds.center
    pose.distance = max(bounds.radius, 1e-6) / sin(halfNarrow)
    return pose
  }

  /// The same eye and direction with another vector upwards: angles are those that come closest.
  public func reorienting(up newUp: Vector3) -> Self {
    let eyeDirection = direction
    var pose = self
    pose.up = newUp.normalized ?? up
    pose.elevation = asin(clamped(eyeDirection.dot(pose.up), -1...1))
    let (front, side) = pose.horizon
    // At a pole the azimuth is free: keep the image's right where it was.
    let right = axes.right
    let horizontal = Vector3(eyeDirection.dot(front), eyeDirection.dot(side), 0)
    pose.azimuth =
      horizontal.length > 1e-6
      ? atan2(horizontal.y, horizontal.x) : atan2(-right.dot(front), right.dot(side))
    return pose
  }

  /// The way from this pose to another, at `x` in 0–1: angles the short way round, distances by
  /// ratio, so that a flight over decades looks even.
  public func interpolated(to end: Self, at x: Double) -> Self {
    if x >= 1 { return end }
    var pose = self
    pose.target = target + (end.target - target) * x
    pose.distance = distance * pow(end.distance / distance, x)
    pose.azimuth = azimuth + wrappedAngle(end.azimuth - azimuth) * x
    pose.elevation = elevation + (end.elevation - elevation) * x
    pose.fieldOfView = fieldOfView + (end.fieldOfView - fieldOfView) * x
    pose.up = (up + (end.up - up) * x).normalized ?? end.up
    return pose
  }
}

extension Bounds {
  public var center: Vector3 { (min + max) / 2 }

  /// Half the diagonal.
  public var radius: Double { max.distance(to: min) / 2 }

  public var corners: [Vector3] {
    (0..<8).map { index in
      Vector3(
        index & 1 == 0 ? min.x : max.x, index & 2 == 0 ? min.y : max.y,
        index & 4 == 0 ? min.z : max.z)
    }
  }
}
