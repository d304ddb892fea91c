import Foundation

/// Gestures to poses: orbit with inertia, pan, zoom, flights to what is focused.
///
/// Time comes from outside (seconds of any steady clock), so the same gestures give the same poses on
/// a 60 Hz and a 120 Hz display.
public struct CameraController: Sendable, Equatable {
  /// Where the viewer stands now.
  public private(set) var pose: OrbitPose
  /// Distances that zooming stays between.
  public private(set) var distanceRange: ClosedRange<Double>
  private var velocity = SIMD2<Double>.zero
  private var flight: Flight?

  private struct Flight: Sendable, Equatable {
    var from: OrbitPose
    var to: OrbitPose
    var elapsed = 0.0
  }

  /// Radians per point of a drag.
  public static let radiansPerPoint = 0.007
  /// The speed of a flick falls to 1/e in a third of a second.
  static let damping = 3.0
  /// Below this many radians a second the picture does not visibly move.
  static let restSpeed = 0.01
  static let maxSpeed = 20.0
  static let flightSeconds = 0.4

  public init(pose: OrbitPose = OrbitPose(), sceneRadius: Double = 1) {
    self.pose = pose
    distanceRange = Self.distances(sceneRadius: sceneRadius)
    self.pose.distance = clamped(pose.distance, distanceRange)
  }

  /// Whether the pose changes without a gesture.
  public var isMoving: Bool { flight != nil || velocity != .zero }

  /// A new scene, or a new box of it: what zooming is limited by.
  public mutating func setSceneRadius(_ radius: Double) {
    distanceRange = Self.distances(sceneRadius: radius)
    pose.distance = clamped(pose.distance, distanceRange)
  }

  private static func distances(sceneRadius: Double) -> ClosedRange<Double> {
    let radius = sceneRadius.isFinite && sceneRadius > 0 ? sceneRadius : 1
    return radius * 1e-3...radius * 1e2
  }

  /// Stops whatever moves by itself; the start of every gesture.
  public mutating func stop() {
    velocity = .zero
    flight = nil
  }

  /// Turns the scene with a finger that moved by (x, y) points.
  public mutating func orbit(by points: SIMD2<Double>) {
    stop()
    turn(by: points * Self.radiansPerPoint)
  }

  /// Lets go at a speed in points per second.
  public mutating func endOrbit(velocity points: SIMD2<Double>) {
    flight = nil
    let speed = points * Self.radiansPerPoint
    let length = (speed * speed).sum().squareRoot()
    guard length.isFinite, length > Self.restSpeed else {
      velocity = .zero
      return
    }
    velocity = speed * min(1, Self.maxSpeed / length)
  }

  private mutating func turn(by radians: SIMD2<Double>) {
    guard radians.x.isFinite, radians.y.isFinite else { return }
    // The finger drags the scene: to the right turns the eye to the left.
    pose.azimuth = wrappedAngle(pose.azimuth - radians.x)
    pose.elevation += radians.y
  }

  /// Moves the scene with the finger, in the plane of the target.
  public mutating func pan(by points: SIMD2<Double>, in viewport: Viewport) {
    stop()
    shift(by: points, in: viewport)
  }

  private mutating func shift(by points: SIMD2<Double>, in viewport: Viewport) {
    guard points.x.isFinite, points.y.isFinite else { return }
    let (right, down, _) = pose.axes
    let units = pose.unitsPerPoint(in: viewport)
    pose.target -= right * (points.x * units) + down * (points.y * units)
  }

  /// Brings the scene closer by a factor; what is under `anchor` (points from the viewport's
  /// middle) stays there.
  public mutating func zoom(
    by factor: Double, anchor: SIMD2<Double> = .zero, in viewport: Viewport
  ) {
    stop()
    guard factor.isFinite, factor > 0 else { return }
    let before = pose.distance
    pose.distance = clamped(before / factor, distanceRange)
    shift(by: anchor * (1 - before / pose.distance), in: viewport)
  }

  /// Turns the horizon by an angle (clockwise in the image): corrects what is up.
  public mutating func roll(by radians: Double) {
    stop()
    guard radians.isFinite else { return }
    let (_, down, forward) = pose.axes
    pose = pose.reorienting(up: (-down).rotated(by: -radians, about: forward))
  }

  /// Makes an axis of the world point upwards.
  public mutating func setUp(_ axis: UpAxis) {
    stop()
    var turned = pose
    turned.up = axis.direction
    pose = turned
  }

  /// Makes the image's own upwards direction the scene's.
  public mutating func useImageUp() {
    stop()
    pose = pose.reorienting(up: -pose.axes.down)
  }

  /// Flies to a side.
  public mutating func look(from preset: ViewPreset) {
    var end = pose
    (end.azimuth, end.elevation) = preset.angles
    fly(to: end)
  }

  /// Flies to where the box fills the view, from the side where the viewer is.
  public mutating func focus(on bounds: Bounds, in viewport: Viewport) {
    fly(to: pose.framing(bounds, in: viewport))
  }

  /// Is where the box fills the view, at once.
  public mutating func frame(_ bounds: Bounds, in viewport: Viewport) {
    stop()
    setSceneRadius(bounds.radius)
    pose = pose.framing(bounds, in: viewport)
    pose.distance = clamped(pose.distance, distanceRange)
  }

  public mutating func fly(to end: OrbitPose) {
    velocity = .zero
    var end = end
    end.distance = clamped(end.distance, distanceRange)
    flight = Flight(from: pose, to: end)
  }

  /// Is there at once: a restored view.
  public mutating func jump(to pose: OrbitPose) {
    stop()
    self.pose = pose
    self.pose.distance = clamped(pose.distance, distanceRange)
  }

  /// Lets time pass.
  public mutating func advance(by seconds: Double) {
    guard seconds > 0, seconds.isFinite else { return }
    if var flight {
      flight.elapsed += seconds
      let x = flight.elapsed / Self.flightSeconds
      pose = flight.from.interpolated(to: flight.to, at: smoothstep(x))
      self.flight = x < 1 ? flight : nil
    } else if velocity != .zero {
      coast(for: seconds)
    }
  }

  /// Exact for any length of the interval: v(t) = v₀ e^(−kt), so the way is v₀ (1 − e^(−kt)) / k.
  private mutating func coast(for seconds: Double) {
    let decay = exp(-Self.damping * seconds)
    turn(by: velocity * ((1 - decay) / Self.damping))
    velocity *= decay
    if abs(pose.elevation) >= .pi / 2 { velocity.y = 0 }
    if (velocity * velocity).sum().squareRoot() < Self.restSpeed { velocity = .zero }
  }
}
