@_exported import QuartzCore

extension ProcessInfo {
  public struct ActivityOptions: OptionSet, Sendable {
    public static let userInitiated = ActivityOptions(rawValue: 1)
    public static let idleSystemSleepDisabled = ActivityOptions(rawValue: 2)
    public let rawValue: UInt64
    public init(rawValue: UInt64) { self.rawValue = rawValue }
  }
  public func beginActivity(options: ActivityOptions, reason: String) -> any NSObjectProtocol {
    NSObject()
  }
  public func endActivity(_ activity: any NSObjectProtocol) {}
}

@MainActor open class NSResponder: NSObject {
  open var acceptsFirstResponder: Bool { false }
  open func mouseDown(with event: NSEvent) {}
  open func mouseUp(with event: NSEvent) {}
  open func mouseDragged(with event: NSEvent) {}
  open func rightMouseDragged(with event: NSEvent) {}
  open func otherMouseDragged(with event: NSEvent) {}
  open func scrollWheel(with event: NSEvent) {}
  open func magnify(with event: NSEvent) {}
  open func rotate(with event: NSEvent) {}
  open func keyDown(with event: NSEvent) {}
}

@MainActor public final class NSEvent: NSObject {
  public struct ModifierFlags: OptionSet, Sendable {
    public static let shift = ModifierFlags(rawValue: 1)
    public static let control = ModifierFlags(rawValue: 2)
    public static let option = ModifierFlags(rawValue: 4)
    public static let command = ModifierFlags(rawValue: 8)
    public let rawValue: UInt
    public init(rawValue: UInt) { self.rawValue = rawValue }
  }
  public struct SpecialKey: RawRepresentable, Equatable, Sendable {
    public static let leftArrow = SpecialKey(rawValue: 1)
    public static let rightArrow = SpecialKey(rawValue: 2)
    public static let upArrow = SpecialKey(rawValue: 3)
    public static let downArrow = SpecialKey(rawValue: 4)
    public let rawValue: Int
    public init(rawValue: Int) { self.rawValue = rawValue }
  }
  public var locationInWindow: CGPoint { .zero }
  public var deltaX: CGFloat { 0 }
  public var deltaY: CGFloat { 0 }
  public var scrollingDeltaX: CGFloat { 0 }
  public var scrollingDeltaY: CGFloat { 0 }
  public var hasPreciseScrollingDeltas: Bool { false }
  public var magnification: CGFloat { 0 }
  public var rotation: Float { 0 }
  public var clickCount: Int { 0 }
  public var modifierFlags: ModifierFlags { [] }
  public var specialKey: SpecialKey? { nil }
  public var keyCode: UInt16 { 0 }
  public var charactersIgnoringModifiers: String? { nil }
}

@MainActor public final class NSScreen: NSObject {
  public var maximumFramesPerSecond: Int { 60 }
}

@MainActor public final class NSWindow: NSResponder {
  public var backingScaleFactor: CGFloat { 1 }
  public var screen: NSScreen? { nil }
  @discardableResult public func makeFirstResponder(_ responder: NSResponder?) -> Bool { false }
}

open class NSView: NSResponder {
  public init(frame: CGRect) {}
  public required init?(coder: NSCoder) { nil }
  public var wantsLayer = false
  public var needsLayout = false
  public var bounds: CGRect { .zero }
  public var window: NSWindow? { nil }
  open var isFlipped: Bool { false }
  open func makeBackingLayer() -> CALayer { CALayer() }
  open func viewDidMoveToWindow() {}
  open func viewDidChangeBackingProperties() {}
  open func layout() {}
  public func convert(_ point: CGPoint, from view: NSView?) -> CGPoint { point }
  public func displayLink(target: Any, selector: Selector) -> CADisplayLink {
    CADisplayLink(target: target, selector: selector)
  }
  public func setAccessibilityElement(_ isElement: Bool) {}
  public func setAccessibilityLabel(_ label: String?) {}
}
