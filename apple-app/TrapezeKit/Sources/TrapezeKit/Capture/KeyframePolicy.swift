import Foundation

/// Chooses the pictures of a video that are worth keeping: each from a new place, and sharp.
public struct KeyframePolicy: Sendable, Equatable {
  /// Why a picture was not kept.
  public enum Rejection: String, Sendable, CaseIterable {
    case poorTracking, tooClose, tooFast, full
  }

  /// Metres.
  public var minDistance = 0.06
  /// Radians.
  public var minAngle = 8 * Double.pi / 180
  /// Metres and radians a second, beyond which pictures are blurred.
  public var maxSpeed = 0.8
  public var maxAngularSpeed = 1.2
  public var capacity = 400

  private var lastKept: CapturedFrame?
  private var lastSeen: CapturedFrame?
  public private(set) var keptCount = 0

  public init() {}

  /// `nil` when the picture is to be kept.
  public mutating func consider(_ frame: CapturedFrame) -> Rejection? {
    defer { lastSeen = frame }
    guard frame.isTrackingNormal, frame.isFinite else { return .poorTracking }
    if keptCount >= capacity { return .full }
    if isTooFast(frame) { return .tooFast }
    if let lastKept, frame.position.distance(to: lastKept.position) < minDistance,
      Self.angle(frame, lastKept) < minAngle
    {
      return .tooClose
    }
    lastKept = frame
    keptCount += 1
    return nil
  }

  private func isTooFast(_ frame: CapturedFrame) -> Bool {
    guard let lastSeen, lastSeen.isTrackingNormal, lastSeen.isFinite else { return false }
    let seconds = frame.timestamp - lastSeen.timestamp
    guard seconds > 0 else { return false }
    return frame.position.distance(to: lastSeen.position) > maxSpeed * seconds
      || Self.angle(frame, lastSeen) > maxAngularSpeed * seconds
  }

  private static func angle(_ a: CapturedFrame, _ b: CapturedFrame) -> Double {
    acos(clamped(a.forward.dot(b.forward), -1...1))
  }
}
