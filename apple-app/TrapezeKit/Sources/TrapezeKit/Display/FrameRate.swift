/// Frames per second over the last second, from the moments at which they were shown.
public struct FrameRate: Sendable, Equatable {
  private var moments: [Double] = []

  public init() {}

  public mutating func record(at moment: Double) {
    moments.append(moment)
    moments.removeAll { $0 < moment - 1 }
  }

  /// `nil` with fewer than two frames in the second before `moment`: a picture that stands still
  /// has no rate.
  public func value(at moment: Double) -> Double? {
    let recent = moments.filter { $0 >= moment - 1 }
    guard let first = recent.first, let last = recent.last, last > first else { return nil }
    return Double(recent.count - 1) / (last - first)
  }
}
