import Foundation
import Testing

@testable import TrapezeKit

@Suite struct PlaybackClockTests {
  private func playing(_ mode: PlaybackClock.LoopMode) -> PlaybackClock {
    var clock = PlaybackClock()
    clock.setLoopMode(mode, at: 0)
    clock.play(at: 0)
    return clock
  }

  @Test func loopModesFoldTimeAtTheEnds() {
    // Ten seconds a pass. A moment is exact in binary where it is a multiple of 1/8.
    for (mode, expected) in [
      (PlaybackClock.LoopMode.once, [0, 0.25, 0.75, 1, 1, 1]),
      (.loop, [0, 0.25, 0.75, 0.25, 0.75, 0.25]),
      (.pingPong, [0, 0.25, 0.75, 0.75, 0.25, 0.25]),
    ] {
      let clock = playing(mode)
      let times = [0.0, 2.5, 7.5, 12.5, 17.5, 22.5].map { clock.time(at: $0) }
      for (time, expected) in zip(times, expected) {
        #expect(abs(time - expected) < 1e-12, "\(mode)")
      }
    }
  }

  @Test func irregularFramesDoNotMakeItDrift() {
    var random = RandomNumbers(seed: 9)
    let clock = playing(.loop)
    var moment = 0.0
    var shown = 0.0
    // A day of frames of random length would take a while; what counts is that no state is changed
    // by looking, so a million looks leave the clock as it was.
    let before = clock
    for _ in 0..<100_000 {
      moment += .random(in: 0...0.1, using: &random)
      shown = clock.time(at: moment)
    }
    #expect(clock == before)
    let exact = (moment / 10) - floor(moment / 10)
    #expect(abs(shown - exact) < 1e-12)
    // Thirty days of uptime cost 2.6e6 s · 1.1e-16 / 10 s of a pass: nothing that is seen.
    let late = clock.time(at: 30 * 86_400 + 2.5)
    #expect(abs(late - 0.25) < 1e-9)
  }

  @Test func changesOfSpeedAndPausesDoNotJump() {
    var random = RandomNumbers(seed: 10)
    for mode in PlaybackClock.LoopMode.allCases {
      var clock = playing(mode)
      var moment = 0.0
      for _ in 0..<2_000 {
        moment += .random(in: 0...1, using: &random)
        let before = clock.time(at: moment)
        switch Int.random(in: 0..<5, using: &random) {
        case 0: clock.setSpeed(.random(in: 0.1...4, using: &random), at: moment)
        case 1: clock.pause(at: moment)
        case 2: if !clock.hasEnded(at: moment) && before < 1 { clock.play(at: moment) }
        case 3: clock.setDuration(.random(in: 1...20, using: &random), at: moment)
        default: clock.endScrub(at: moment)
        }
        // 2 000 s of phase round at 4e-13.
        #expect(abs(clock.time(at: moment) - before) < 1e-9, "\(mode)")
      }
    }
  }

  @Test func scrubbingHoldsAndThenGoesOn() {
    var clock = playing(.loop)
    clock.scrub(to: 0.5, at: 3)
    #expect(clock.time(at: 100) == 0.5)
    #expect(!clock.isRunning(at: 100))
    clock.endScrub(at: 100)
    #expect(abs(clock.time(at: 101) - 0.6) < 1e-12)
    #expect(clock.isPlaying)
    clock.pause(at: 101)
    clock.scrub(to: 1, at: 102)
    clock.endScrub(at: 103)
    #expect(clock.time(at: 999) == 1)
  }

  @Test func onceStopsAtTheEndAndPlaysFromTheStartAgain() {
    var clock = playing(.once)
    #expect(clock.isRunning(at: 9.9) && !clock.isRunning(at: 10.1))
    #expect(clock.hasEnded(at: 10.1))
    clock.pause(at: 11)
    #expect(clock.time(at: 20) == 1)
    clock.play(at: 20)
    #expect(clock.time(at: 20) == 0)
  }

  @Test func stepsStandStillAndWrapOnlyInALoop() {
    var clock = playing(.loop)
    clock.pause(at: 0)
    clock.step(frames: -1, at: 1)
    #expect(abs(clock.time(at: 5) - (1 - 1 / 300)) < 1e-12)
    clock.setLoopMode(.once, at: 5)
    clock.seek(to: 0, at: 5)
    clock.step(frames: -1, at: 6)
    #expect(clock.time(at: 6) == 0)
    #expect(!clock.isPlaying)
  }

  @Test func absurdSettingsAreLimited() {
    var clock = playing(.loop)
    clock.setSpeed(.nan, at: 1)
    clock.setDuration(0, at: 1)
    clock.seek(to: .infinity, at: 1)
    #expect(PlaybackClock.speeds.contains(clock.speed))
    #expect(PlaybackClock.durations.contains(clock.duration))
    #expect((0...1).contains(clock.time(at: 1)))
  }

  @Test func aClockOfThePastDoesNotRunBackwards() {
    var clock = playing(.loop)
    clock.seek(to: 0.5, at: 100)
    #expect(clock.time(at: 99) == 0.5)
  }
}

@MainActor @Suite struct PlaybackModelTests {
  @Test func theButtonShowsPauseUntilTheEndAndPlayAfterwards() {
    let clock = ManualClock()
    let model = PlaybackModel { clock.now }
    model.loopMode = .once
    model.toggle()
    #expect(model.isPlaying && model.isRunning)
    clock.now = 4
    model.advance(to: clock.now)
    #expect(abs(model.time - 0.4) < 1e-12)
    clock.now = 11
    model.advance(to: clock.now)
    #expect(model.time == 1 && !model.isPlaying)
    model.toggle()
    #expect(model.isPlaying && model.time == 0)
  }

  @Test func everyControlShowsItsEffectAtOnce() {
    let model = PlaybackModel { 0 }
    model.scrub(to: 0.3)
    #expect(model.time == 0.3)
    model.endScrub()
    model.step(frames: 3)
    #expect(abs(model.time - 0.31) < 1e-12)
    model.speed = 2
    model.duration = 5
    #expect(model.speed == 2 && model.duration == 5)
    let kept = model.settings
    let other = PlaybackModel { 0 }
    other.settings = kept
    #expect(other.settings == kept)
  }
}
