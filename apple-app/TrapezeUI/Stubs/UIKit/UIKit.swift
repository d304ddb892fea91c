@_exported import QuartzCore

@MainActor open class UIResponder: NSObject {
  open var canBecomeFirstResponder: Bool { false }
  @discardableResult open func becomeFirstResponder() -> Bool { false }
  open func touchesBegan(_ touches: Set<UITouch>, with event: UIEvent?) {}
  open func touchesMoved(_ touches: Set<UITouch>, with event: UIEvent?) {}
  open func touchesEnded(_ touches: Set<UITouch>, with event: UIEvent?) {}
  open func touchesCancelled(_ touches: Set<UITouch>, with event: UIEvent?) {}
  open func pressesBegan(_ presses: Set<UIPress>, with event: UIPressesEvent?) {}
}

public struct UIAccessibilityTraits: OptionSet, Sendable {
  public static let allowsDirectInteraction = UIAccessibilityTraits(rawValue: 1)
  public let rawValue: UInt64
  public init(rawValue: UInt64) { self.rawValue = rawValue }
}

@MainActor public final class UIScreen: NSObject {
  public var nativeScale: CGFloat { 1 }
  public var maximumFramesPerSecond: Int { 60 }
}

open class UIView: UIResponder {
  public init(frame: CGRect) {}
  public required init?(coder: NSCoder) { nil }
  open class var layerClass: AnyClass { CALayer.self }
  public var layer: CALayer { CALayer() }
  public var bounds: CGRect { .zero }
  public var isMultipleTouchEnabled = false
  public var isAccessibilityElement = false
  public var accessibilityLabel: String?
  public var accessibilityTraits = UIAccessibilityTraits()
  public var window: UIWindow? { nil }
  open func didMoveToWindow() {}
  open func layoutSubviews() {}
  open func setNeedsLayout() {}
}

public final class UIWindow: UIView {
  public var screen: UIScreen { UIScreen() }
}

@MainActor public final class UITouch: NSObject {
  public func location(in view: UIView?) -> CGPoint { .zero }
  public var timestamp: Double { 0 }
}

@MainActor open class UIEvent: NSObject {}
public final class UIPressesEvent: UIEvent {}

public struct UIKeyModifierFlags: OptionSet, Sendable {
  public static let command = UIKeyModifierFlags(rawValue: 1)
  public static let control = UIKeyModifierFlags(rawValue: 2)
  public let rawValue: Int
  public init(rawValue: Int) { self.rawValue = rawValue }
}

public enum UIKeyboardHIDUsage: Int, Sendable {
  case keyboardLeftArrow, keyboardRightArrow, keyboardUpArrow, keyboardDownArrow, keyboardEscape
  case keyboardA
}

@MainActor public final class UIKey: NSObject {
  public var keyCode: UIKeyboardHIDUsage { .keyboardA }
  public var modifierFlags: UIKeyModifierFlags { [] }
  public var charactersIgnoringModifiers: String { "" }
}

@MainActor public final class UIPress: NSObject {
  public var key: UIKey? { nil }
}

public enum UIInterfaceOrientation: Int, Sendable {
  case unknown, portrait, portraitUpsideDown, landscapeRight, landscapeLeft
}

@MainActor open class UIScene: NSObject {
  public enum ActivationState: Int, Sendable { case unattached, foregroundActive, background }
  public var activationState: ActivationState { .unattached }
}

public final class UIWindowScene: UIScene {
  public var interfaceOrientation: UIInterfaceOrientation { .unknown }
}

public struct UIBackgroundTaskIdentifier: RawRepresentable, Equatable, Sendable {
  public static let invalid = UIBackgroundTaskIdentifier(rawValue: 0)
  public let rawValue: Int
  public init(rawValue: Int) { self.rawValue = rawValue }
}

@MainActor public final class UIApplication: UIResponder {
  public static let shared = UIApplication()
  public nonisolated static let didReceiveMemoryWarningNotification =
    Notification.Name("memoryWarning")
  public var connectedScenes: Set<UIScene> { [] }
  public var isIdleTimerDisabled = false
  public func beginBackgroundTask(
    expirationHandler: (@MainActor @Sendable () -> Void)? = nil
  ) -> UIBackgroundTaskIdentifier { .invalid }
  public func endBackgroundTask(_ task: UIBackgroundTaskIdentifier) {}
}
