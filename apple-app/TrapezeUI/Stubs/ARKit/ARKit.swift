@_exported import AVFoundation
@_exported import UIKit

public struct simd_float3x3: Sendable {
  public var columns: (SIMD3<Float>, SIMD3<Float>, SIMD3<Float>)
}

public struct simd_float4x4: Sendable {
  public var columns: (SIMD4<Float>, SIMD4<Float>, SIMD4<Float>, SIMD4<Float>)
  public static func * (left: Self, right: SIMD4<Float>) -> SIMD4<Float> { right }
}

open class ARConfiguration: NSObject {
  open class var isSupported: Bool { false }
}
public final class ARFaceTrackingConfiguration: ARConfiguration {}
public final class ARWorldTrackingConfiguration: ARConfiguration {}

open class ARAnchor: NSObject {
  public var transform: simd_float4x4 { fatalError("stub") }
}
public final class ARFaceAnchor: ARAnchor {
  public var isTracked: Bool { false }
}

public final class ARCamera: NSObject {
  public enum TrackingState {
    public enum Reason { case initializing }
    case notAvailable
    case limited(Reason)
    case normal
  }
  public var transform: simd_float4x4 { fatalError("stub") }
  public var intrinsics: simd_float3x3 { fatalError("stub") }
  public var imageResolution: CGSize { .zero }
  public var trackingState: TrackingState { .notAvailable }
  public func viewMatrix(for orientation: UIInterfaceOrientation) -> simd_float4x4 {
    fatalError("stub")
  }
}

public final class ARPointCloud: NSObject {
  public var points: [SIMD3<Float>] { [] }
  public var identifiers: [UInt64] { [] }
}

public final class ARFrame: NSObject {
  public var timestamp: Double { 0 }
  public var anchors: [ARAnchor] { [] }
  public var camera: ARCamera { ARCamera() }
  public var capturedImage: CVPixelBuffer { CVPixelBuffer() }
  public var rawFeaturePoints: ARPointCloud? { nil }
}

public protocol ARSessionDelegate: NSObjectProtocol {
  func session(_ session: ARSession, didUpdate frame: ARFrame)
}

public final class ARSession: NSObject {
  public weak var delegate: (any ARSessionDelegate)?
  public func run(_ configuration: ARConfiguration) {}
  public func pause() {}
}

public final class ARSCNView: UIView {
  public var session = ARSession()
}
