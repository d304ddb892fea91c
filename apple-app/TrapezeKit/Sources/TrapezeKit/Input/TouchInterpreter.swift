import Foundation

/// Fingers to actions: one turns the scene, two move, zoom and roll it, a tap chooses, a double tap
/// focuses.
///
/// Its own recogniser instead of the system's five: they would have to be told to work together,
/// and this one is the same on every machine that runs the tests.
public struct TouchInterpreter: Sendable {
  /// Identifies a finger while it is down.
  public typealias Finger = Int

  /// Points within which a finger that goes down and up is a tap.
  static let tapRadius = 10.0
  static let tapSeconds = 0.35
  static let doubleTapSeconds = 0.35
  static let doubleTapRadius = 40.0
  /// Two fingers turn by so much before they roll the horizon: most pinches turn a little.
  static let rollThreshold = 0.2
  /// Seconds over which the speed of a flick is measured.
  static let velocityWindow = 0.08

  private var fingers: [Finger: SIMD2<Double>] = [:]
  private var start: (location: SIMD2<Double>, moment: Double)?
  /// Whether the touch may still become a tap.
  private var mayBeTap = false
  private var lastTap: (location: SIMD2<Double>, moment: Double)?
  private var trail: [(delta: SIMD2<Double>, moment: Double)] = []
  private var turned = 0.0

  public init() {}

  public mutating func began(_ touches: [Finger: SIMD2<Double>], at moment: Double) {
    if fingers.isEmpty, touches.count == 1, let location = touches.first?.value {
      start = (location, moment)
      mayBeTap = true
    } else {
      mayBeTap = false
    }
    fingers.merge(touches) { $1 }
    trail = []
    turned = 0
  }

  public mutating func moved(
    _ touches: [Finger: SIMD2<Double>], at moment: Double
  ) -> [PointerAction] {
    let before = fingers
    for (finger, location) in touches where fingers[finger] != nil { fingers[finger] = location }
    // Fingers beyond the first two are a resting hand.
    let order = before.keys.sorted()
    if order.count >= 2 { return pinch(order[0], order[1], before) }
    guard let finger = order.first, let old = before[finger], let new = fingers[finger] else {
      return []
    }
    return drag(from: old, to: new, at: moment)
  }

  private mutating func drag(
    from old: SIMD2<Double>, to new: SIMD2<Double>, at moment: Double
  ) -> [PointerAction] {
    if mayBeTap, let start {
      if Self.length(new - start.location) <= Self.tapRadius { return [] }
      mayBeTap = false
      // The picture starts where the finger is, without a jump over the tap's radius.
      trail = []
      return []
    }
    let delta = new - old
    trail.append((delta, moment))
    trail.removeAll { $0.moment < moment - Self.velocityWindow }
    return delta == .zero ? [] : [.orbit(delta)]
  }

  private mutating func pinch(
    _ a: Finger, _ b: Finger, _ before: [Finger: SIMD2<Double>]
  ) -> [PointerAction] {
    guard let a0 = before[a], let b0 = before[b], let a1 = fingers[a], let b1 = fingers[b] else {
      return []
    }
    var actions: [PointerAction] = []
    let middle = (a1 + b1) / 2
    let shift = middle - (a0 + b0) / 2
    if shift != .zero { actions.append(.pan(shift)) }
    let (old, new) = (b0 - a0, b1 - a1)
    // Fingers on one spot have no ratio.
    if Self.length(old) > 1, Self.length(new) > 1 {
      let factor = Self.length(new) / Self.length(old)
      if factor != 1 { actions.append(.zoom(factor: factor, at: middle)) }
      let angle = wrappedAngle(atan2(new.y, new.x) - atan2(old.y, old.x))
      turned += angle
      if abs(turned) > Self.rollThreshold, angle != 0 { actions.append(.roll(angle)) }
    }
    return actions
  }

  public mutating func ended(_ lifted: Set<Finger>, at moment: Double) -> [PointerAction] {
    let wasOne = fingers.count == 1
    for finger in lifted { fingers[finger] = nil }
    guard fingers.isEmpty else {
      // What is left of two fingers turns from where it is.
      trail = []
      return []
    }
    if mayBeTap, let start, moment - start.moment <= Self.tapSeconds {
      return tap(at: start.location, moment)
    }
    guard wasOne, !trail.isEmpty else { return [] }
    let recent = trail.filter { $0.moment >= moment - Self.velocityWindow }
    let way = recent.reduce(SIMD2<Double>.zero) { $0 + $1.delta }
    trail = []
    return [.endOrbit(velocity: way / Self.velocityWindow)]
  }

  /// The system took the touch away: a call, a gesture of its own.
  public mutating func cancelled() {
    fingers = [:]
    mayBeTap = false
    trail = []
  }

  /// A tap acts at once, without waiting whether it becomes a double tap; the second one takes back
  /// what the first one chose.
  private mutating func tap(at location: SIMD2<Double>, _ moment: Double) -> [PointerAction] {
    let choice = PointerAction.tap(location, extending: true)
    if let last = lastTap, moment - last.moment <= Self.doubleTapSeconds,
      Self.length(location - last.location) <= Self.doubleTapRadius
    {
      lastTap = nil
      return [.tap(last.location, extending: true), .doubleTap(location)]
    }
    lastTap = (location, moment)
    return [choice]
  }

  private static func length(_ v: SIMD2<Double>) -> Double { (v * v).sum().squareRoot() }
}
