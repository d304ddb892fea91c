#if canImport(UIKit)
  import ARKit
  import CoreImage
  import Foundation
  import SwiftUI
  import TrapezeKit

  /// ARKit's world tracking as a source of pictures with poses.
  @MainActor
  final class CaptureSession: NSObject {
    let session = ARSession()
    private weak var capture: CaptureModel?
    private let encoder = JPEGEncoder()
    /// ARKit has few picture buffers and stops when they are all held: one is encoded at a time.
    private var isEncoding = false

    static var isSupported: Bool { ARWorldTrackingConfiguration.isSupported }

    func start(for capture: CaptureModel) {
      guard Self.isSupported else { return }
      self.capture = capture
      session.delegate = self
      session.run(ARWorldTrackingConfiguration())
    }

    func stop() { session.pause() }

    private func consider(_ frame: CapturedFrame, _ picture: Picture, _ points: [FeaturePoint]) {
      guard let capture, !isEncoding, capture.wants(frame) else { return }
      isEncoding = true
      let encoder = encoder
      Task {
        let jpeg = await encoder.jpeg(picture)
        isEncoding = false
        if let jpeg { capture.keep(frame, jpeg: jpeg, points: points) }
      }
    }
  }

  extension CaptureSession: ARSessionDelegate {
    /// On the main queue, since the session was given no other.
    nonisolated func session(_ session: ARSession, didUpdate frame: ARFrame) {
      let captured = CapturedFrame(frame)
      let picture = Picture(buffer: frame.capturedImage)
      let points = FeaturePoint.points(of: frame)
      MainActor.assumeIsolated { consider(captured, picture, points) }
    }
  }

  /// A pixel buffer on its way to the encoder: nobody writes into it any more.
  struct Picture: @unchecked Sendable {
    let buffer: CVPixelBuffer
  }

  /// JPEGs, away from the main thread.
  actor JPEGEncoder {
    private let context = CIContext()

    func jpeg(_ picture: Picture) -> Data? {
      guard let space = CGColorSpace(name: CGColorSpace.sRGB) else { return nil }
      return context.jpegRepresentation(
        of: CIImage(cvPixelBuffer: picture.buffer), colorSpace: space)
    }
  }

  extension CapturedFrame {
    init(_ frame: ARFrame) {
      let camera = frame.camera
      let k = camera.intrinsics
      var isNormal = false
      if case .normal = camera.trackingState { isNormal = true }
      self.init(
        timestamp: frame.timestamp, cameraToWorld: Matrix4(columns: camera.transform),
        fx: Double(k.columns.0.x), fy: Double(k.columns.1.y),
        cx: Double(k.columns.2.x), cy: Double(k.columns.2.y),
        width: Int(camera.imageResolution.width), height: Int(camera.imageResolution.height),
        isTrackingNormal: isNormal)
    }
  }

  extension FeaturePoint {
    static func points(of frame: ARFrame) -> [FeaturePoint] {
      guard let cloud = frame.rawFeaturePoints else { return [] }
      return zip(cloud.identifiers, cloud.points).map { id, point in
        FeaturePoint(
          id: id, position: Vector3(Double(point.x), Double(point.y), Double(point.z)), color: nil)
      }
    }
  }

  extension Matrix4 {
    init(columns m: simd_float4x4) {
      let c = m.columns
      func row(_ i: Int) -> SIMD4<Double> {
        SIMD4(Double(c.0[i]), Double(c.1[i]), Double(c.2[i]), Double(c.3[i]))
      }
      self.init(row(0), row(1), row(2), row(3))
    }
  }

  /// What the camera sees.
  struct CameraPreview: UIViewRepresentable {
    let session: CaptureSession

    func makeUIView(context: Context) -> ARSCNView {
      let view = ARSCNView(frame: .zero)
      view.session = session.session
      return view
    }

    func updateUIView(_ view: ARSCNView, context: Context) {}
  }
#endif
