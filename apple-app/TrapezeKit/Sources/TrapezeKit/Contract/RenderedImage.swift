import Foundation

/// An image in memory: 8 bits a channel, red first, alpha not premultiplied, rows top to bottom.
public struct RenderedImage: Sendable, Equatable {
  public let width: Int
  public let height: Int
  /// `4 · width · height` bytes.
  public let rgba: Data

  /// - Returns: `nil` when the number of bytes is not that of the size.
  public init?(width: Int, height: Int, rgba: Data) {
    guard width > 0, height > 0, rgba.count == 4 * width * height else { return nil }
    self.width = width
    self.height = height
    self.rgba = rgba
  }
}
