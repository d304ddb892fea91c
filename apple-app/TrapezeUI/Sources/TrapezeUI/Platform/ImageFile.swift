import CoreGraphics
import Foundation
import ImageIO
import TrapezeKit
import UniformTypeIdentifiers

extension RenderedImage {
  /// The same pixels for the system.
  var cgImage: CGImage? {
    guard let provider = CGDataProvider(data: rgba as CFData),
      let space = CGColorSpace(name: CGColorSpace.sRGB)
    else { return nil }
    return CGImage(
      width: width, height: height, bitsPerComponent: 8, bitsPerPixel: 32,
      bytesPerRow: 4 * width, space: space,
      bitmapInfo: CGBitmapInfo(rawValue: CGImageAlphaInfo.last.rawValue), provider: provider,
      decode: nil, shouldInterpolate: true, intent: .defaultIntent)
  }
}

/// Pictures on disk.
enum ImageFile {
  static func writePNG(_ image: RenderedImage, to url: URL) throws {
    guard let picture = image.cgImage,
      let destination = CGImageDestinationCreateWithURL(
        url as CFURL, UTType.png.identifier as CFString, 1, nil)
    else { throw EngineError(.unwritableFile, "\(url.lastPathComponent): cannot be created") }
    CGImageDestinationAddImage(destination, picture, nil)
    guard CGImageDestinationFinalize(destination) else {
      throw EngineError(.unwritableFile, "\(url.lastPathComponent): cannot be written")
    }
  }
}
