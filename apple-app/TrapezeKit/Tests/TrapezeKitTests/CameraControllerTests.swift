import Foundation
import Testing

@testable import TrapezeKit

@Suite struct CameraControllerTests {
  private let viewport = Viewport(width: 400, height: 300, scale: 2)
  private let box = Bounds(min: Vector3(-1, -1, -1), max: Vector3(1, 1, 1))

  /// Any gesture with any numbers, also absurd ones.
  private func gesture(_ controller: inout CameraController, _ random: inout RandomNumbers) {
    let scales: [Double] = [1, 50, 5_000]
    let scale = scales[Int.random(in: 0..<3, using: &random)]
    let points = SIMD2(
      Double.random(in: -scale...scale, using: &random),
      Double.random(in: -scale...scale, using: &random))
    switch Int.random(in: 0..<11, using: &random) {
    case 0: controller.orbit(by: points)
    case 1: controller.endOrbit(velocity: points * 100)
    case 2: controller.pan(by: points, in: viewport)
    case 3:
      controller.zoom(
        by: exp(Double.random(in: -9...9, using: &random)), anchor: points, in: viewport)
    case 4: controller.roll(by: .random(in: -4...4, using: &random))
    case 5: controller.look(from: ViewPreset.allCases.randomElement(using: &random) ?? .top)
    case 6: controller.setUp(UpAxis.allCases.randomElement(using: &random) ?? .plusX)
    case 7: controller.useImageUp()
    case 8: controller.focus(on: box, in: viewport)
    case 9: controller.orbit(by: SIMD2(.nan, .infinity))
    default: controller.advance(by: .random(in: 0...0.2, using: &random))
    }
  }

  @Test(arguments: 0..<20) func noSequenceOfGesturesTurnsThePictureOver(seed: UInt64) {
    var random = RandomNumbers(seed: seed)
    var controller = CameraController()
    controller.frame(box, in: viewport)
    for _ in 0..<1_000 {
      gesture(&controller, &random)
      let pose = controller.pose
      let (right, down, _) = pose.axes
      // The horizon is level, and up in the world is never down in the image. Flights between two
      // vectors upwards pass poses that are level for the vector in between.
      #expect(abs(right.dot(pose.up)) < 1e-12)
      #expect(-down.dot(pose.up) > -1e-12)
      #expect(abs(pose.elevation) <= .pi / 2)
      #expect(controller.distanceRange.contains(pose.distance))
      #expect(pose.eye.isFinite)
    }
  }

  @Test func theSceneFollowsTheFinger() throws {
    var controller = CameraController(pose: OrbitPose(distance: 4))
    let point = controller.pose.target
    controller.pan(by: SIMD2(30, -20), in: viewport)
    let seen = try #require(controller.pose.camera(in: viewport).project(point))
    // Two pixels a point.
    #expect(abs(seen.x - 460) < 1e-9 && abs(seen.y - 260) < 1e-9)
  }

  @Test func draggingToTheRightTurnsTheFrontToTheRight() throws {
    var controller = CameraController(pose: OrbitPose(distance: 4))
    let front = controller.pose.target + controller.pose.direction
    let above = controller.pose.target + controller.pose.up
    controller.orbit(by: SIMD2(40, 0))
    var camera = controller.pose.camera(in: viewport)
    #expect(try #require(camera.project(front)).x > 400)
    controller.orbit(by: SIMD2(-40, 40))
    camera = controller.pose.camera(in: viewport)
    #expect(try #require(camera.project(front)).y > 300)
    #expect(try #require(camera.project(above)).y < 300)
  }

  @Test func inertiaIsTheSameAtEveryFrameRate() {
    func angle(after seconds: Double, framesPerSecond: Double) -> Double {
      var controller = CameraController()
      controller.endOrbit(velocity: SIMD2(300, 0))
      for _ in 0..<Int(seconds * framesPerSecond) { controller.advance(by: 1 / framesPerSecond) }
      return controller.pose.azimuth
    }
    let slow = angle(after: 0.5, framesPerSecond: 30)
    // The solution is exact, so only rounding differs.
    #expect(abs(angle(after: 0.5, framesPerSecond: 120) - slow) < 1e-12)
    let closedForm =
      -300 * CameraController.radiansPerPoint
      * (1 - exp(-CameraController.damping * 0.5)) / CameraController.damping
    #expect(abs(slow - closedForm) < 1e-12)
  }

  @Test func inertiaComesToRestAndAGestureStopsIt() {
    var controller = CameraController()
    controller.endOrbit(velocity: SIMD2(900, 400))
    #expect(controller.isMoving)
    controller.orbit(by: .zero)
    #expect(!controller.isMoving)
    controller.endOrbit(velocity: SIMD2(900, 400))
    // ln(6.3 / 0.01) / 3 s: the flick is at rest after 2.2 seconds.
    for _ in 0..<150 { controller.advance(by: 1 / 60) }
    #expect(!controller.isMoving)
    controller.endOrbit(velocity: SIMD2(.nan, 0))
    #expect(!controller.isMoving)
  }

  @Test func zoomKeepsWhatIsUnderTheFinger() throws {
    var controller = CameraController(pose: OrbitPose(distance: 4))
    let anchor = SIMD2(90.0, -60.0)
    let (right, down, _) = controller.pose.axes
    let units = controller.pose.unitsPerPoint(in: viewport)
    let point = controller.pose.target + right * (90 * units) - down * (60 * units)
    for factor in [2.0, 0.4, 7] {
      controller.zoom(by: factor, anchor: anchor, in: viewport)
      let seen = try #require(controller.pose.camera(in: viewport).project(point))
      #expect(abs(seen.x - 580) < 1e-9 && abs(seen.y - 180) < 1e-9)
    }
  }

  @Test func focusFramesTheBox() throws {
    var controller = CameraController()
    controller.frame(Bounds(min: Vector3(-9, -9, -9), max: Vector3(9, 9, 9)), in: viewport)
    let cluster = Bounds(min: Vector3(3, 1, 2), max: Vector3(4, 3, 3))
    controller.focus(on: cluster, in: viewport)
    #expect(controller.isMoving)
    for _ in 0..<60 { controller.advance(by: 1 / 60) }
    #expect(!controller.isMoving)
    #expect(controller.pose.target == cluster.center)
    let camera = controller.pose.camera(in: viewport)
    var widest = 0.0
    for corner in cluster.corners {
      let seen = try #require(camera.project(corner))
      #expect((0...800).contains(seen.x) && (0...600).contains(seen.y))
      widest = max(widest, abs(seen.y - 300), abs(seen.x - 400))
    }
    // It fills the view: more than half of it from the middle to an edge.
    #expect(widest > 150)
  }

  @Test func presetsLookFromTheirSide() {
    for (preset, expected) in [
      (ViewPreset.top, Vector3(0, 0, 1)), (.bottom, Vector3(0, 0, -1)), (.front, Vector3(0, 1, 0)),
      (.back, Vector3(0, -1, 0)), (.right, Vector3(-1, 0, 0)), (.left, Vector3(1, 0, 0)),
    ] {
      var controller = CameraController(pose: OrbitPose(up: UpAxis.plusZ.direction))
      controller.look(from: preset)
      controller.advance(by: 1)
      #expect(controller.pose.direction.distance(to: expected) < 1e-12, "\(preset)")
    }
  }

  @Test func rollTurnsTheImageByItsAngle() {
    var controller = CameraController(pose: OrbitPose(azimuth: 0.3, elevation: 0.2))
    let before = controller.pose.axes
    controller.roll(by: 0.25)
    let after = controller.pose.axes
    #expect(after.forward.distance(to: before.forward) < 1e-12)
    #expect(abs(after.right.dot(before.right) - cos(0.25)) < 1e-12)
    controller.roll(by: -0.25)
    #expect(controller.pose.axes.right.distance(to: before.right) < 1e-12)
  }

  @Test func trackersGiveTheWaySinceTheLastCall() {
    var drag = DragTracker()
    #expect(drag.delta(to: SIMD2(3, 4)) == SIMD2(3, 4))
    #expect(drag.delta(to: SIMD2(5, 4)) == SIMD2(2, 0))
    drag.end()
    #expect(drag.delta(to: SIMD2(1, 1)) == SIMD2(1, 1))
    var pinch = MagnificationTracker()
    #expect(pinch.factor(to: 2) == 2)
    #expect(pinch.factor(to: 3) == 1.5)
    #expect(pinch.factor(to: 0) == 1)
    pinch.end()
    #expect(pinch.factor(to: 2) == 2)
  }
}
