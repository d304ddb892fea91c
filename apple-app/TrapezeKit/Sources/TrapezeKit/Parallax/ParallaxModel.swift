import Observation

/// The controls of fake depth.
@MainActor @Observable
public final class ParallaxModel {
  public enum Source: String, Sendable, CaseIterable, Identifiable {
    case off, device, head
    public var id: Self { self }
  }

  /// What moves the view. Another source starts from the middle.
  public var source = Source.off {
    didSet { if source != oldValue { reset() } }
  }
  public private(set) var value = Parallax.zero
  /// Whether a face is seen; `nil` when none is looked for.
  public private(set) var seesFace: Bool?

  private var device = DeviceParallax()
  private var head = HeadParallax()

  public init() {}

  public func deviceMoved(to attitude: Attitude, orientation: ScreenOrientation) {
    guard source == .device else { return }
    device.update(attitude, orientation: orientation)
    value = device.value
  }

  /// `nil` when no face is seen: the view stays where it is.
  public func headMoved(to position: Vector3?) {
    guard source == .head else { return }
    seesFace = position != nil
    guard let position else { return }
    head.update(position)
    value = head.value
  }

  /// Moves the view without sensors, in radians: arrow keys on a Mac.
  public func nudge(horizontal: Double, vertical: Double) {
    value = Parallax(
      horizontal: value.horizontal + horizontal, vertical: value.vertical + vertical)
  }

  public func recenter() {
    device.recenter()
    head.recenter()
    value = .zero
  }

  private func reset() {
    device = DeviceParallax()
    head = HeadParallax()
    value = .zero
    seesFace = nil
  }
}
