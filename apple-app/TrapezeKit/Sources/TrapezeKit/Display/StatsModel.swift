import Observation

/// The figures of the overlay.
@MainActor @Observable
public final class StatsModel {
  public private(set) var frame = FrameStats()
  /// Frames per second; `nil` while the picture stands still.
  public private(set) var framesPerSecond: Double?
  private var rate = FrameRate()
  private var refreshed = -Double.infinity

  /// Numbers that change faster than this cannot be read, and every change lays out text.
  static let refreshInterval = 0.25

  public init() {}

  public func record(_ stats: FrameStats, at moment: Double) {
    rate.record(at: moment)
    guard moment - refreshed >= Self.refreshInterval else { return }
    refreshed = moment
    frame = stats
    framesPerSecond = rate.value(at: moment)
  }
}
