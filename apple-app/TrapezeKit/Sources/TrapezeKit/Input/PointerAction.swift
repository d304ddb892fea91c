/// What fingers, a mouse or a trackpad ask for. Lengths are points, angles radians.
public enum PointerAction: Sendable, Equatable {
  case orbit(SIMD2<Double>)
  /// The hand lets go at a speed in points per second.
  case endOrbit(velocity: SIMD2<Double>)
  case pan(SIMD2<Double>)
  case zoom(factor: Double, at: SIMD2<Double>)
  case roll(Double)
  case tap(SIMD2<Double>, extending: Bool)
  case doubleTap(SIMD2<Double>)
}

extension ViewerModel {
  /// Does what is asked for; picking happens a moment later.
  public func perform(_ action: PointerAction) {
    switch action {
    case .orbit(let delta): orbit(by: delta)
    case .endOrbit(let velocity): endOrbit(velocity: velocity)
    case .pan(let delta): pan(by: delta)
    case .zoom(let factor, let location): zoom(by: factor, at: location)
    case .roll(let angle): roll(by: angle)
    case .tap(let location, let extending):
      Task { await tap(at: location, extending: extending) }
    case .doubleTap(let location): Task { await focus(at: location) }
    }
  }
}
