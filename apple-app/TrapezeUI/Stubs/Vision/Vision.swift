@_exported import AVFoundation

open class VNRequest: NSObject {}

public final class VNFaceObservation: NSObject {
  public var boundingBox: CGRect { .zero }
}

public final class VNDetectFaceRectanglesRequest: VNRequest {
  public var results: [VNFaceObservation]? { nil }
}

public struct VNImageOption: Hashable, Sendable {}

public final class VNImageRequestHandler: NSObject {
  public init(cmSampleBuffer: CMSampleBuffer, options: [VNImageOption: Any]) {}
  public func perform(_ requests: [VNRequest]) throws {}
}
