import Foundation

/// The scene's time as a function of the wall clock.
///
/// Nothing is added up frame by frame: a position is computed from the moment at which playback
/// last changed, so late, dropped or doubled frames cannot make it drift.
public struct PlaybackClock: Sendable, Equatable {
  /// What happens at the ends.
  public enum LoopMode: String, Sendable, Codable, CaseIterable, Identifiable {
    /// Stops at the end.
    case once
    /// Starts over.
    case loop
    /// Turns round.
    case pingPong

    public var id: Self { self }
  }

  public static let speeds = 0.05...8.0
  public static let durations = 0.1...3600.0

  public private(set) var isPlaying = false
  public private(set) var isScrubbing = false
  public private(set) var loopMode = LoopMode.loop
  /// Multiple of the normal speed.
  public private(set) var speed = 1.0
  /// Seconds from time 0 to time 1 at normal speed.
  public private(set) var duration = 10.0

  /// Unfolded position at `anchorMoment`: 1 per pass. `pingPong` plays odd passes backwards.
  private var anchorPhase = 0.0
  private var anchorMoment = 0.0

  public init() {}

  private func phase(at moment: Double) -> Double {
    guard isPlaying, !isScrubbing else { return anchorPhase }
    return anchorPhase + max(0, moment - anchorMoment) * speed / duration
  }

  /// The scene's time, 0 to 1, at a moment in seconds of a steady clock.
  public func time(at moment: Double) -> Double {
    let phase = phase(at: moment)
    switch loopMode {
    case .once: return min(max(phase, 0), 1)
    // A whole number of passes is the end of one and the start of the next; only a phase that was
    // set by hand to exactly 1 shows the end.
    case .loop: return phase == 1 ? 1 : phase - floor(phase)
    case .pingPong:
      let folded = phase - 2 * floor(phase / 2)
      return folded <= 1 ? folded : 2 - folded
    }
  }

  /// Whether time passes now: a clock that reached its end does not ask for frames.
  public func isRunning(at moment: Double) -> Bool {
    isPlaying && !isScrubbing && !hasEnded(at: moment)
  }

  /// Whether playback stopped at the end by itself.
  public func hasEnded(at moment: Double) -> Bool {
    loopMode == .once && isPlaying && phase(at: moment) >= 1
  }

  private mutating func anchor(at moment: Double, phase: Double? = nil) {
    anchorPhase = phase ?? self.phase(at: moment)
    anchorMoment = moment
  }

  /// Plays; from the start when it stands at the end.
  public mutating func play(at moment: Double) {
    let atEnd = loopMode == .once && phase(at: moment) >= 1
    anchor(at: moment, phase: atEnd ? 0 : nil)
    isPlaying = true
  }

  public mutating func pause(at moment: Double) {
    anchor(at: moment, phase: loopMode == .pingPong ? nil : time(at: moment))
    isPlaying = false
  }

  /// Stands still at a time while a finger is on the slider; `endScrub` goes on as before.
  public mutating func scrub(to time: Double, at moment: Double) {
    isScrubbing = true
    anchor(at: moment, phase: clamped(time, 0...1))
  }

  public mutating func endScrub(at moment: Double) {
    guard isScrubbing else { return }
    anchorMoment = moment
    isScrubbing = false
  }

  /// Goes to a time without stopping.
  public mutating func seek(to time: Double, at moment: Double) {
    anchor(at: moment, phase: clamped(time, 0...1))
  }

  /// One step of `frames` pictures at 30 a second, and stands still there.
  public mutating func step(frames: Int, at moment: Double) {
    let now = time(at: moment)
    isPlaying = false
    let target = now + Double(frames) / (30 * duration)
    seek(to: loopMode == .loop ? Self.wrapped(target) : target, at: moment)
  }

  private static func wrapped(_ time: Double) -> Double {
    (0...1).contains(time) ? time : time - floor(time)
  }

  public mutating func setSpeed(_ speed: Double, at moment: Double) {
    anchor(at: moment)
    self.speed = clamped(speed, Self.speeds)
  }

  public mutating func setDuration(_ duration: Double, at moment: Double) {
    anchor(at: moment)
    self.duration = clamped(duration, Self.durations)
  }

  /// The picture does not jump: the new mode starts from the time that is shown.
  public mutating func setLoopMode(_ mode: LoopMode, at moment: Double) {
    anchor(at: moment, phase: time(at: moment))
    loopMode = mode
  }
}
