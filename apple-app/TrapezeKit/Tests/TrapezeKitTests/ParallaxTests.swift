import Foundation
import Testing

@testable import TrapezeKit

@Suite struct ParallaxTests {
  /// A device turned by an angle about one of its axes.
  private func attitude(_ axis: Vector3, _ angle: Double) -> Attitude {
    let s = sin(angle / 2)
    return Attitude(w: cos(angle / 2), x: axis.x * s, y: axis.y * s, z: axis.z * s)
  }

  @Test func theLogarithmGivesAxisTimesAngle() {
    var random = RandomNumbers(seed: 30)
    for _ in 0..<500 {
      let axis =
        Vector3(
          .random(in: -1...1, using: &random), .random(in: -1...1, using: &random),
          .random(in: -1...1, using: &random)
        ).normalized ?? Vector3(1, 0, 0)
      let angle = Double.random(in: 0...3, using: &random)
      let still = Attitude(w: 1, x: 0, y: 0, z: 0)
      let turned = attitude(axis, angle)
      #expect(turned.rotation(from: still).distance(to: axis * angle) < 1e-9)
      #expect(turned.rotation(from: turned).length < 1e-12)
      // −q is the same attitude.
      let negative = Attitude(w: -turned.w, x: -turned.x, y: -turned.y, z: -turned.z)
      #expect(negative.rotation(from: still).distance(to: axis * angle) < 1e-9)
    }
  }

  @Test func everyOrientationHasAxesOfTheScreen() {
    for orientation in ScreenOrientation.allCases {
      let (right, up) = orientation.axes
      #expect(right.cross(up) == Vector3(0, 0, 1))
      var parallax = DeviceParallax()
      parallax.update(attitude(up, 0), orientation: orientation)
      parallax.update(attitude(up, 0.1), orientation: orientation)
      #expect(abs(parallax.value.horizontal + 0.08) < 1e-12)
      #expect(abs(parallax.value.vertical) < 1e-12)
      parallax.update(attitude(right, 0.1), orientation: orientation)
      #expect(abs(parallax.value.vertical - 0.08) < 1e-12)
      #expect(abs(parallax.value.horizontal) < 1e-12)
    }
  }

  @Test func parallaxIsLimitedAndNeverANumberThatIsNone() {
    let wild = Parallax(horizontal: 9, vertical: .nan)
    #expect(wild.horizontal == Parallax.limit && wild.vertical == -Parallax.limit)
    let pose = wild.applied(to: OrbitPose(elevation: -1.5))
    #expect(pose.elevation >= -.pi / 2)
  }

  @Test func theHeadIsSmoothedAndRecentered() {
    var head = HeadParallax()
    head.update(Vector3(0, 0, 0.5))
    #expect(head.value == .zero)
    head.update(Vector3(0.1, 0, 0.5))
    // 0.6 of the old place, 0.4 of the new one.
    #expect(abs(head.value.horizontal - atan2(0.04, 0.5)) < 1e-12)
    for _ in 0..<60 { head.update(Vector3(0.1, 0.05, 0.5)) }
    #expect(abs(head.value.horizontal - atan2(0.1, 0.5)) < 1e-9)
    #expect(head.value.vertical > 0)
    let before = head.value
    head.update(Vector3(.nan, 0, 1))
    head.update(Vector3(5, 5, -1))
    #expect(head.value == before)
    head.recenter()
    #expect(head.value == .zero)
  }

  @MainActor @Test func theModelListensToOneSource() {
    let model = ParallaxModel()
    model.deviceMoved(to: attitude(Vector3(0, 1, 0), 0.2), orientation: .portrait)
    #expect(model.value == .zero)
    model.source = .device
    model.deviceMoved(to: attitude(Vector3(0, 1, 0), 0), orientation: .portrait)
    model.deviceMoved(to: attitude(Vector3(0, 1, 0), 0.2), orientation: .portrait)
    #expect(abs(model.value.horizontal + 0.16) < 1e-12)
    model.recenter()
    #expect(model.value == .zero)
    model.source = .head
    model.headMoved(to: nil)
    #expect(model.seesFace == false && model.value == .zero)
    model.source = .off
    #expect(model.seesFace == nil)
    model.nudge(horizontal: 0.1, vertical: -0.1)
    #expect(model.value == Parallax(horizontal: 0.1, vertical: -0.1))
  }
}
