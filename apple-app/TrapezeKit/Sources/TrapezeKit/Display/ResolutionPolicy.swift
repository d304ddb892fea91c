import Foundation

/// How the device is.
public struct DeviceCondition: Sendable, Equatable {
  /// The system's four thermal states, in its order.
  public enum Heat: Int, Sendable, CaseIterable, Comparable {
    case nominal, fair, serious, critical

    public static func < (left: Self, right: Self) -> Bool { left.rawValue < right.rawValue }
  }

  public var heat = Heat.nominal
  public var isLowPower = false

  public init(heat: Heat = .nominal, isLowPower: Bool = false) {
    self.heat = heat
    self.isLowPower = isLowPower
  }
}

#if canImport(Darwin)
  extension DeviceCondition {
    /// The condition that the system tells now.
    public static var current: Self {
      let info = ProcessInfo.processInfo
      let heat: Heat =
        switch info.thermalState {
        case .nominal: .nominal
        case .fair: .fair
        case .serious: .serious
        case .critical: .critical
        @unknown default: .serious
        }
      return Self(heat: heat, isLowPower: info.isLowPowerModeEnabled)
    }
  }
#endif

/// What a device in a condition is asked for. The cost of a frame goes with its pixels, the heat
/// with pixels times frames.
public struct ResolutionPolicy: Sendable, Equatable {
  /// Multiple of the display's own resolution.
  public var scale: Double
  public var maxFramesPerSecond: Int

  public init(_ condition: DeviceCondition, displayMaximum: Int = 120) {
    let (scale, rate): (Double, Int) =
      switch condition.heat {
      case .nominal: (1, 120)
      case .fair: (1, 60)
      case .serious: (0.7, 60)
      case .critical: (0.5, 30)
      }
    self.scale = condition.isLowPower ? min(scale, 0.75) : scale
    let limit = condition.isLowPower ? min(rate, 60) : rate
    maxFramesPerSecond = min(limit, max(displayMaximum, 1))
  }
}
