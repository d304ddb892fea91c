import Foundation
import QuartzCore
import TrapezeKit

/// The display's clock, running only while somebody wants the next tick.
@MainActor
final class DisplayLink {
  private var link: CADisplayLink?
  private let target: DisplayLinkTarget

  /// `tick` is told when the frame will be seen, and answers whether it wants the next one. `make`
  /// makes the link: an application's on iOS, a view's on macOS.
  init(
    tick: @escaping @MainActor (Double) -> Bool,
    make: @MainActor (DisplayLinkTarget, Selector) -> CADisplayLink?
  ) {
    target = DisplayLinkTarget(tick: tick)
    link = make(target, DisplayLinkTarget.selector)
    link?.isPaused = true
    link?.add(to: .main, forMode: .common)
  }

  func wake() { link?.isPaused = false }

  func setRate(maximum: Int) {
    let rate = Float(maximum)
    link?.preferredFrameRateRange = CAFrameRateRange(
      minimum: min(30, rate), maximum: rate, preferred: rate)
  }

  /// A link keeps its target alive until it is ended.
  func end() {
    link?.invalidate()
    link = nil
  }
}

/// What a link calls.
@MainActor
final class DisplayLinkTarget: NSObject {
  private let tick: @MainActor (Double) -> Bool

  init(tick: @escaping @MainActor (Double) -> Bool) {
    self.tick = tick
  }

  #if canImport(ObjectiveC)
    static let selector = #selector(fire(_:))
  #else
    static let selector = Selector("fire:")
  #endif

  #if canImport(ObjectiveC)
    @objc
  #endif
  func fire(_ link: CADisplayLink) {
    link.isPaused = !tick(link.targetTimestamp)
  }
}
