@_exported import Foundation

public typealias CFData = Data
public typealias CFURL = URL
public typealias CFString = String

public final class CGColorSpace {
  public static let sRGB = "sRGB"
  public init?(name: String) {}
}

public final class CGDataProvider {
  public init?(data: CFData) {}
}

public struct CGBitmapInfo: OptionSet, Sendable {
  public let rawValue: UInt32
  public init(rawValue: UInt32) { self.rawValue = rawValue }
}

public enum CGImageAlphaInfo: UInt32 { case none, premultipliedLast, premultipliedFirst, last }

public enum CGColorRenderingIntent { case defaultIntent }

public final class CGImage {
  public init?(
    width: Int, height: Int, bitsPerComponent: Int, bitsPerPixel: Int, bytesPerRow: Int,
    space: CGColorSpace, bitmapInfo: CGBitmapInfo, provider: CGDataProvider,
    decode: UnsafePointer<CGFloat>?, shouldInterpolate: Bool, intent: CGColorRenderingIntent
  ) {}
}
