@_exported import CoreGraphics
import CoreVideo

public final class CIImage {
  public init(cvPixelBuffer: CVPixelBuffer) {}
}

public struct CIImageRepresentationOption: Hashable, Sendable {}

public final class CIContext {
  public init() {}
  public func jpegRepresentation(
    of image: CIImage, colorSpace: CGColorSpace, options: [CIImageRepresentationOption: Any] = [:]
  ) -> Data? { nil }
}
