import Foundation
import Observation

/// The controls of playback.
@MainActor @Observable
public final class PlaybackModel {
  /// Seconds of a steady clock; the clock of display links.
  public typealias Now = @MainActor () -> Double

  public private(set) var clock = PlaybackClock()
  /// The time that is shown, 0 to 1; follows the clock at the rate of the display.
  public private(set) var time = 0.0
  private let now: Now

  public init(now: @escaping Now = { ProcessInfo.processInfo.systemUptime }) {
    self.now = now
  }

  public var isPlaying: Bool { clock.isPlaying }
  /// Whether frames are wanted because time passes.
  public var isRunning: Bool { clock.isRunning(at: now()) }

  public func play() { change { $0.play(at: $1) } }
  public func pause() { change { $0.pause(at: $1) } }
  public func toggle() { isPlaying ? pause() : play() }
  public func scrub(to time: Double) { change { $0.scrub(to: time, at: $1) } }
  public func endScrub() { change { $0.endScrub(at: $1) } }
  public func seek(to time: Double) { change { $0.seek(to: time, at: $1) } }
  public func step(frames: Int) { change { $0.step(frames: frames, at: $1) } }

  public var speed: Double {
    get { clock.speed }
    set { change { $0.setSpeed(newValue, at: $1) } }
  }

  public var duration: Double {
    get { clock.duration }
    set { change { $0.setDuration(newValue, at: $1) } }
  }

  public var loopMode: PlaybackClock.LoopMode {
    get { clock.loopMode }
    set { change { $0.setLoopMode(newValue, at: $1) } }
  }

  /// Follows the clock to a moment: once a frame.
  public func advance(to moment: Double) {
    let time = clock.time(at: moment)
    if time != self.time { self.time = time }
    if clock.hasEnded(at: moment) { clock.pause(at: moment) }
  }

  public var settings: PlaybackSettings {
    get {
      var settings = PlaybackSettings()
      (settings.loopMode, settings.speed, settings.duration) = (loopMode, speed, duration)
      return settings
    }
    set { (loopMode, speed, duration) = (newValue.loopMode, newValue.speed, newValue.duration) }
  }

  private func change(_ action: (inout PlaybackClock, Double) -> Void) {
    let moment = now()
    action(&clock, moment)
    advance(to: moment)
  }
}
