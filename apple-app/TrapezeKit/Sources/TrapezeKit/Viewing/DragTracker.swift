/// Turns what a gesture recogniser tells, the way since the gesture's start, into the way since the
/// last call.
public struct DragTracker: Sendable, Equatable {
  private var last = SIMD2<Double>.zero

  public init() {}

  public mutating func delta(to translation: SIMD2<Double>) -> SIMD2<Double> {
    defer { last = translation }
    return translation - last
  }

  public mutating func end() { last = .zero }
}

/// The same for factors: the magnification since the last call.
public struct MagnificationTracker: Sendable, Equatable {
  private var last = 1.0

  public init() {}

  public mutating func factor(to magnification: Double) -> Double {
    guard magnification.isFinite, magnification > 0 else { return 1 }
    defer { last = magnification }
    return magnification / last
  }

  public mutating func end() { last = 1 }
}
