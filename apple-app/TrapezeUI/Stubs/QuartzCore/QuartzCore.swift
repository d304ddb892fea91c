@_exported import CoreGraphics

public struct Selector: Sendable {
  public init(_ name: String) {}
}

open class CALayer: NSObject {
  public var contentsScale: CGFloat = 1
  public var isOpaque = false
}

public final class CAMetalLayer: CALayer {}

public struct CAFrameRateRange: Sendable {
  public init(minimum: Float, maximum: Float, preferred: Float?) {}
}

public final class CADisplayLink: NSObject {
  public init(target: Any, selector: Selector) {}
  public var isPaused = false
  public var preferredFrameRateRange = CAFrameRateRange(minimum: 0, maximum: 0, preferred: 0)
  public var targetTimestamp: Double { 0 }
  public func add(to loop: RunLoop, forMode mode: RunLoop.Mode) {}
  public func invalidate() {}
}
