import Foundation

/// The frames of a video: what moves, how often, how long.
public struct CameraMove: Sendable, Equatable {
  public enum Kind: String, Sendable, CaseIterable, Identifiable {
    /// Once around the target.
    case turntable
    /// Once through the scene's time.
    case time
    /// Both.
    case turntableAndTime
    public var id: Self { self }
  }

  public var kind: Kind
  public var seconds: Double
  public var framesPerSecond: Int

  public init(kind: Kind = .turntable, seconds: Double = 6, framesPerSecond: Int = 30) {
    self.kind = kind
    self.seconds = clamped(seconds, 0.5...120)
    self.framesPerSecond = min(max(framesPerSecond, 1), 120)
  }

  public var frameCount: Int { max(1, Int((seconds * Double(framesPerSecond)).rounded())) }

  /// Pose and time of a frame. A turn ends one frame before it begins again, so that a loop shows no
  /// frame twice; a passage of time shows its end.
  public func frame(
    _ index: Int, from pose: OrbitPose, time: Double
  ) -> (pose: OrbitPose, time: Double) {
    var turned = pose
    if kind != .time {
      turned.azimuth += 2 * .pi * Double(index) / Double(frameCount)
    }
    let last = Double(max(frameCount - 1, 1))
    return (turned, kind == .turntable ? time : Double(index) / last)
  }
}
