import Foundation

/// The rectangle that a scene is seen through, in points, and how it is opened.
public struct Viewport: Sendable, Equatable {
  public var width: Double
  public var height: Double
  /// Pixels per point.
  public var scale: Double

  public init(width: Double, height: Double, scale: Double = 1) {
    self.width = width
    self.height = height
    self.scale = scale
  }

  /// The largest side of a frame that the core draws.
  public static let maxPixelSide = 16_384

  public var pixelWidth: Int { Self.pixels(width * scale) }
  public var pixelHeight: Int { Self.pixels(height * scale) }

  public var isEmpty: Bool { !(width > 0 && height > 0 && scale > 0) }

  private static func pixels(_ side: Double) -> Int {
    Int(clamped(side.rounded(), 1...Double(maxPixelSide)))
  }
}
