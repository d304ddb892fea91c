import Foundation

/// Angles by which the eye stands beside its place, in radians: to the right and upwards of the
/// target. Depth on a flat screen by moving the view with the device or the head.
public struct Parallax: Sendable, Equatable {
  public var horizontal: Double
  public var vertical: Double

  public static let zero = Parallax(horizontal: 0, vertical: 0)
  /// More than this shows the back of things that were captured from the front.
  public static let limit = 0.5

  public init(horizontal: Double, vertical: Double) {
    self.horizontal = clamped(horizontal, -Self.limit...Self.limit)
    self.vertical = clamped(vertical, -Self.limit...Self.limit)
  }

  /// The pose seen from beside. The elevation still ends at the poles.
  public func applied(to pose: OrbitPose) -> OrbitPose {
    var pose = pose
    pose.azimuth += horizontal
    pose.elevation += vertical
    return pose
  }
}

/// How the screen is held. The axes are those of the device's sensors: x to the right and y to the
/// top of a phone held upright, z out of the screen.
public enum ScreenOrientation: String, Sendable, CaseIterable {
  case portrait, upsideDown
  /// The top of the device points left.
  case landscapeTopLeft
  /// The top of the device points right.
  case landscapeTopRight

  /// The screen's right and up in the device's axes.
  public var axes: (right: Vector3, up: Vector3) {
    switch self {
    case .portrait: (Vector3(1, 0, 0), Vector3(0, 1, 0))
    case .upsideDown: (Vector3(-1, 0, 0), Vector3(0, -1, 0))
    case .landscapeTopLeft: (Vector3(0, -1, 0), Vector3(1, 0, 0))
    case .landscapeTopRight: (Vector3(0, 1, 0), Vector3(-1, 0, 0))
    }
  }
}

/// A rotation as a unit quaternion w + xi + yj + zk.
public struct Attitude: Sendable, Equatable {
  public var w: Double
  public var x: Double
  public var y: Double
  public var z: Double

  public init(w: Double, x: Double, y: Double, z: Double) {
    self.w = w
    self.x = x
    self.y = y
    self.z = z
  }

  /// Axis times angle (radians) of the rotation from `reference` to this, in `reference`'s axes:
  /// the logarithm of q₀⁻¹ q. Unlike Euler angles it has no poles near a phone held upright.
  public func rotation(from reference: Self) -> Vector3 {
    let (a, b) = (reference, self)
    var w = a.w * b.w + a.x * b.x + a.y * b.y + a.z * b.z
    var v = Vector3(
      a.w * b.x - a.x * b.w - a.y * b.z + a.z * b.y,
      a.w * b.y + a.x * b.z - a.y * b.w - a.z * b.x,
      a.w * b.z - a.x * b.y + a.y * b.x - a.z * b.w)
    // q and −q are one rotation; the shorter way is meant.
    if w < 0 { (w, v) = (-w, -v) }
    let sine = v.length
    return sine > 1e-12 ? v * (2 * atan2(sine, w) / sine) : v * 2
  }
}

/// Parallax from the motion of the device.
public struct DeviceParallax: Sendable, Equatable {
  /// The original app's.
  public static let gain = 0.8

  public private(set) var value = Parallax.zero
  private var reference: Attitude?
  private var newest: Attitude?

  public init() {}

  /// A new measurement, sixty a second.
  ///
  /// Turning the screen about its upward axis, right edge away from the viewer's right eye, is
  /// looking from the right; tilting its top towards the viewer is looking from above.
  public mutating func update(_ attitude: Attitude, orientation: ScreenOrientation) {
    newest = attitude
    guard let reference else {
      self.reference = attitude
      return
    }
    let rotation = attitude.rotation(from: reference)
    let (right, up) = orientation.axes
    value = Parallax(
      horizontal: -Self.gain * rotation.dot(up), vertical: Self.gain * rotation.dot(right))
  }

  /// The way the device is held now becomes the middle.
  public mutating func recenter() {
    reference = newest
    value = .zero
  }
}

/// Parallax from the place of the viewer's head.
public struct HeadParallax: Sendable, Equatable {
  /// Share of the former value that stays with a new measurement, as in the original app.
  public static let smoothing = 0.6

  public private(set) var value = Parallax.zero
  private var smoothed: Vector3?
  private var reference: Vector3?

  public init() {}

  /// A new measurement: the head in front of the screen, x to the viewer's right, y up, z away from
  /// the screen; in any unit. What is behind the screen or not a number is noise.
  public mutating func update(_ head: Vector3) {
    guard head.isFinite, head.z > 0 else { return }
    let position = smoothed.map { $0 * Self.smoothing + head * (1 - Self.smoothing) } ?? head
    smoothed = position
    guard let reference else {
      self.reference = position
      return
    }
    value = Parallax(
      horizontal: atan2(position.x, position.z) - atan2(reference.x, reference.z),
      vertical: atan2(position.y, position.z) - atan2(reference.y, reference.z))
  }

  /// Where the head is now becomes the middle.
  public mutating func recenter() {
    reference = smoothed
    value = .zero
  }
}
