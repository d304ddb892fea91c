import Foundation
import Testing

@testable import TrapezeKit

@MainActor @Suite struct RenderLoopTests {
  @Test func aSceneThatStandsStillIsDrawnOnce() async throws {
    let window = try Window(engine: TestEngine(scene: .twoObjects(motion: 0)))
    await window.open()
    #expect(await window.rest() <= 2)
    #expect(await window.drawn().count == 1)
    for _ in 0..<10 { #expect(await window.tick() == false) }
    #expect(await window.drawn().count == 1)
  }

  @Test func everythingThatChangesThePictureWakesTheLinkAndIsDrawn() async throws {
    let window = try Window(engine: TestEngine(scene: .twoObjects(motion: 0)))
    await window.open()
    let viewer = window.viewer
    let changes: [(String, @MainActor () -> Void)] = [
      ("orbit", { viewer.orbit(by: SIMD2(5, 0)) }),
      ("pan", { viewer.pan(by: SIMD2(5, 0)) }),
      ("zoom", { viewer.zoom(by: 1.1) }),
      ("mode", { viewer.display.mode = .depth }),
      ("mask", { viewer.display.masksStatic = true }),
      ("percentile", { viewer.display.staticPercentile = 20 }),
      ("background", { viewer.display.background = TestScene.white }),
      ("hide", { window.scene.selection.setVisible(false, 3) }),
      ("heat", { viewer.condition = DeviceCondition(heat: .critical) }),
      ("size", { viewer.resize(to: Viewport(width: 200, height: 300, scale: 2)) }),
      ("parallax", { viewer.parallax.nudge(horizontal: 0.1, vertical: 0) }),
    ]
    for (name, change) in changes {
      _ = await window.rest()
      let (before, wakes) = (await window.drawn().count, window.wakes)
      change()
      await window.yield()
      #expect(window.wakes > wakes, "\(name) wakes the link")
      _ = await window.rest()
      #expect(await window.drawn().count == before + 1, "\(name) is drawn once")
    }
  }

  @Test func playbackKeepsTheLinkRunningAndShowsTheTimeOfTheTick() async throws {
    let window = try Window()
    await window.open()
    #expect(window.scene.playback.isPlaying)
    let start = window.clock.now
    for _ in 0..<30 { #expect(await window.tick(0.125)) }
    let last = try #require(await window.drawn().last)
    #expect(abs(last.time - (window.clock.now - start) / 10) < 1e-12)
    window.scene.playback.pause()
    #expect(await window.rest() <= 2)
  }

  @Test func inertiaRunsUntilItRests() async throws {
    let window = try Window(engine: TestEngine(scene: .twoObjects(motion: 0)))
    await window.open()
    _ = await window.rest()
    window.viewer.endOrbit(velocity: SIMD2(800, 0))
    #expect((60...200).contains(await window.rest()))
  }

  @Test func oneFrameIsInFlightAtATime() async throws {
    let window = try Window()
    await window.open()
    await window.engine.gate.close()
    for _ in 0..<20 {
      window.clock.now += 0.01
      #expect(window.viewer.loop.tick(at: window.clock.now))
      await Task.yield()
    }
    #expect(await window.engine.gate.waitingCount <= 1)
    await window.engine.gate.open()
    await window.viewer.loop.settle()
    #expect(await window.drawn().count == 1)
  }

  @Test func aFrameThatNeedsLargerBuffersIsDrawnAgain() async throws {
    let window = try Window(engine: TestEngine(scene: .twoObjects(motion: 0)))
    await window.open()
    await window.renderer?.repeatFrames(2)
    _ = await window.rest()
    #expect(await window.drawn().count == 3)
  }

  @Test func aFailureIsTriedOnceAndExplained() async throws {
    let window = try Window(engine: TestEngine(scene: .twoObjects(motion: 0)))
    await window.open()
    window.engine.fail(.drawing, EngineError(.deviceFailed, "device: lost"))
    #expect(await window.rest() <= 2)
    #expect(window.scene.failure?.advice == .tryAgain)
    #expect(window.scene.failure?.reason == "device: lost")
  }

  @Test func nothingIsDrawnWhileSuspended() async throws {
    let window = try Window()
    await window.open()
    await window.tick()
    await window.viewer.loop.suspend()
    let before = await window.drawn().count
    for _ in 0..<5 { #expect(await window.tick() == false) }
    #expect(await window.drawn().count == before)
    let wakes = window.wakes
    await window.viewer.loop.resume()
    #expect(window.wakes > wakes)
    await window.tick()
    #expect(await window.drawn().count == before + 1)
  }

  @Test func theLayerHasTheSizeOfTheFrames() async throws {
    let window = try Window(engine: TestEngine(scene: .twoObjects(motion: 0)))
    await window.open()
    let layer = LayerPointer(UnsafeMutableRawPointer.allocate(byteCount: 1, alignment: 1))
    defer { layer.address.deallocate() }
    window.viewer.loop.setLayer(layer)
    _ = await window.rest()
    window.viewer.orbit(by: SIMD2(9, 0))
    _ = await window.rest()
    #expect(await window.renderer?.attachments == [SIMD2(800, 600)])
    window.viewer.condition = DeviceCondition(heat: .critical)
    _ = await window.rest()
    #expect(await window.renderer?.attachments.last == SIMD2(400, 300))
    await window.viewer.loop.removeLayer(layer)
    #expect(await window.renderer?.attachments.last == .some(nil))
  }

  @Test func resolutionAndRateFollowHeatAndPower() {
    #expect(ResolutionPolicy(DeviceCondition()).maxFramesPerSecond == 120)
    #expect(ResolutionPolicy(DeviceCondition(), displayMaximum: 60).maxFramesPerSecond == 60)
    var last = ResolutionPolicy(DeviceCondition())
    for heat in DeviceCondition.Heat.allCases {
      for isLowPower in [false, true] {
        let policy = ResolutionPolicy(DeviceCondition(heat: heat, isLowPower: isLowPower))
        #expect((0.5...1).contains(policy.scale))
        if isLowPower { #expect(policy.scale <= 0.75 && policy.maxFramesPerSecond <= 60) }
      }
      let policy = ResolutionPolicy(DeviceCondition(heat: heat))
      #expect(policy.scale <= last.scale && policy.maxFramesPerSecond <= last.maxFramesPerSecond)
      last = policy
    }
    #expect(last.scale == 0.5 && last.maxFramesPerSecond == 30)
  }

  @Test func theRateIsThatOfTheLastSecond() throws {
    var rate = FrameRate()
    #expect(rate.value(at: 0) == nil)
    for frame in 0..<300 { rate.record(at: Double(frame) / 120) }
    #expect(abs(try #require(rate.value(at: 2.5)) - 120) < 1e-6)
    #expect(rate.value(at: 10) == nil)
  }
}
