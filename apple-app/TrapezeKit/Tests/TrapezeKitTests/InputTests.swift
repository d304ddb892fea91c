import Foundation
import Testing

@testable import TrapezeKit

@Suite struct TouchInterpreterTests {
  @Test func aShortTouchIsATap() {
    var touch = TouchInterpreter()
    touch.began([1: SIMD2(50, 60)], at: 0)
    #expect(touch.moved([1: SIMD2(53, 60)], at: 0.05).isEmpty)
    #expect(touch.ended([1], at: 0.1) == [.tap(SIMD2(50, 60), extending: true)])
    touch.began([1: SIMD2(50, 60)], at: 5)
    #expect(touch.ended([1], at: 6).isEmpty)
  }

  @Test func theSecondTapTakesTheFirstOneBackAndFocuses() {
    var touch = TouchInterpreter()
    touch.began([1: SIMD2(50, 60)], at: 0)
    _ = touch.ended([1], at: 0.1)
    touch.began([2: SIMD2(55, 60)], at: 0.2)
    #expect(
      touch.ended([2], at: 0.3) == [
        .tap(SIMD2(50, 60), extending: true), .doubleTap(SIMD2(55, 60)),
      ])
    touch.began([3: SIMD2(55, 60)], at: 0.4)
    #expect(touch.ended([3], at: 0.5) == [.tap(SIMD2(55, 60), extending: true)])
  }

  @Test func aDragTurnsWithoutAJumpAndAFlickHasItsSpeed() {
    var touch = TouchInterpreter()
    touch.began([1: SIMD2(0, 0)], at: 0)
    #expect(touch.moved([1: SIMD2(20, 0)], at: 0.02).isEmpty)
    for step in 1...10 {
      let actions = touch.moved(
        [1: SIMD2(20 + 5 * Double(step), 0)], at: 0.02 + 0.01 * Double(step))
      #expect(actions == [.orbit(SIMD2(5, 0))])
    }
    guard case .endOrbit(let velocity)? = touch.ended([1], at: 0.12).first else {
      Issue.record("no flick")
      return
    }
    // 500 points a second, within one of the eight samples of the window.
    #expect(abs(velocity.x - 500) <= 63 && velocity.y == 0)
  }

  @Test func aFingerThatRestsBeforeItLiftsDoesNotFlick() {
    var touch = TouchInterpreter()
    touch.began([1: .zero], at: 0)
    _ = touch.moved([1: SIMD2(50, 0)], at: 0.1)
    _ = touch.moved([1: SIMD2(90, 0)], at: 0.2)
    #expect(touch.ended([1], at: 1) == [.endOrbit(velocity: .zero)])
  }

  @Test func twoFingersMoveAndZoom() {
    var touch = TouchInterpreter()
    touch.began([1: SIMD2(0, 0), 2: SIMD2(100, 0)], at: 0)
    #expect(touch.moved([1: SIMD2(10, 5), 2: SIMD2(110, 5)], at: 0.1) == [.pan(SIMD2(10, 5))])
    #expect(
      touch.moved([1: SIMD2(-40, 5), 2: SIMD2(160, 5)], at: 0.2)
        == [.zoom(factor: 2, at: SIMD2(60, 5))])
    #expect(touch.ended([1], at: 0.3).isEmpty)
    // The finger that stays turns; it is no tap.
    #expect(touch.moved([2: SIMD2(165, 5)], at: 0.4) == [.orbit(SIMD2(5, 0))])
  }

  @Test func twoFingersRollOnlyWhenTheyMeanIt() {
    var touch = TouchInterpreter()
    touch.began([1: SIMD2(-50, 0), 2: SIMD2(50, 0)], at: 0)
    var rolled = 0.0
    for step in 1...40 {
      let angle = Double(step) * 0.01
      let arm = SIMD2(cos(angle), sin(angle)) * 50
      for case .roll(let part) in touch.moved([1: -arm, 2: arm], at: Double(step)) {
        rolled += part
      }
    }
    #expect(abs(rolled - (0.4 - TouchInterpreter.rollThreshold)) < 0.011)
  }

  @Test func cancelledTouchesDoNothing() {
    var touch = TouchInterpreter()
    touch.began([1: .zero], at: 0)
    touch.cancelled()
    #expect(touch.ended([1], at: 0.1).isEmpty)
    #expect(touch.moved([7: SIMD2(3, 3)], at: 0.2).isEmpty)
  }

  @Test func anyFingersGiveFiniteActions() {
    var random = RandomNumbers(seed: 77)
    var touch = TouchInterpreter()
    for moment in 0..<5_000 {
      let finger = Int.random(in: 0..<4, using: &random)
      let place = SIMD2(
        Double(Int.random(in: 0..<3, using: &random)), Double(Int.random(in: 0..<3, using: &random))
      )
      let actions: [PointerAction]
      switch Int.random(in: 0..<3, using: &random) {
      case 0:
        touch.began([finger: place], at: Double(moment))
        actions = []
      case 1: actions = touch.moved([finger: place], at: Double(moment))
      default: actions = touch.ended([finger], at: Double(moment))
      }
      for case .zoom(let factor, _) in actions { #expect(factor.isFinite && factor > 0) }
    }
  }
}

@MainActor @Suite struct KeyCommandTests {
  @Test func everyCommandHasAKeyAndDoesSomething() async throws {
    let window = try Window()
    await window.open()
    let scene = window.scene
    let viewer = window.viewer
    scene.playback.pause()
    func snapshot() async -> String {
      for _ in 0..<40 { await window.tick() }
      return "\(scene.playback.isPlaying) \(scene.playback.time) \(viewer.camera.pose) "
        + "\(scene.selection.state) \(viewer.parallax.value)"
    }
    for command in KeyCommand.allCases {
      // Something to do for each: a choice, a hidden cluster, a view from nowhere in particular.
      scene.selection.showAll()
      if command == .showAll { scene.selection.setVisible(false, 70) }
      scene.selection.choose([3])
      viewer.parallax.source = command == .recenter ? .head : .off
      viewer.parallax.nudge(horizontal: command == .recenter ? 0.2 : 0, vertical: 0)
      viewer.jump(to: OrbitPose(target: Vector3(9, 9, 9), distance: 7, azimuth: 1, elevation: 0.5))
      scene.playback.pause()
      scene.playback.seek(to: 0.5)
      let before = await snapshot()
      scene.perform(command)
      // What is looked up on another thread first takes a moment.
      var after = before
      for _ in 0..<500 where after == before {
        try await Task.sleep(for: .milliseconds(1))
        after = await snapshot()
      }
      #expect(after != before, "\(command)")
    }
    #expect(KeyCommand(.leftArrow) == .left && KeyCommand(.character(" ")) == .playPause)
    #expect(KeyCommand(.escape) == .clear && KeyCommand(.character("z")) == nil)
  }

  @Test func arrowsMoveTheHeadWhereFakeDepthIsOn() async throws {
    let window = try Window()
    await window.open()
    window.viewer.parallax.source = .head
    let pose = window.viewer.camera.pose
    window.scene.perform(.right)
    #expect(window.viewer.camera.pose == pose && window.viewer.parallax.value.horizontal > 0)
  }

  @Test func keysDoNothingWithoutAScene() throws {
    let window = try Window()
    window.scene.perform(.playPause)
    #expect(!window.scene.playback.isPlaying)
  }
}
