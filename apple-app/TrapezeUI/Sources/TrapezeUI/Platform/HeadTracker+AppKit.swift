#if canImport(AppKit)
  import AVFoundation
  import Foundation
  import TrapezeKit
  import Vision

  /// The viewer's head by faces in the Mac's camera.
  @MainActor
  final class HeadTracker {
    private let camera = FaceCamera()
    private var updates: Task<Void, Never>?

    func start(for parallax: ParallaxModel) {
      updates = Task { [camera] in
        guard await AVCaptureDevice.requestAccess(for: .video), await camera.start() else {
          parallax.source = .off
          return
        }
        for await position in camera.positions { parallax.headMoved(to: position) }
      }
    }

    func stop() {
      updates?.cancel()
      updates = nil
      camera.stop()
    }
  }

  /// Runs the camera on a queue of its own. What the queue touches, only it touches.
  private final class FaceCamera: NSObject, AVCaptureVideoDataOutputSampleBufferDelegate,
    @unchecked Sendable
  {
    private let queue = DispatchQueue(label: "head tracking")
    private let session = AVCaptureSession()
    private let request = VNDetectFaceRectanglesRequest()
    private var continuation: AsyncStream<Vector3?>.Continuation?

    /// Where the head is, or that none is seen. An old place is of no use: only the newest waits.
    var positions: AsyncStream<Vector3?> {
      AsyncStream(bufferingPolicy: .bufferingNewest(1)) { continuation in
        queue.async { self.continuation = continuation }
      }
    }

    /// Returns whether there is a camera. It takes a moment to start.
    func start() async -> Bool {
      await withCheckedContinuation { started in
        queue.async {
          let isConnected = !self.session.inputs.isEmpty || self.connect()
          if isConnected { self.session.startRunning() }
          started.resume(returning: isConnected)
        }
      }
    }

    func stop() {
      queue.async {
        self.session.stopRunning()
        self.continuation?.finish()
        self.continuation = nil
      }
    }

    private func connect() -> Bool {
      guard let device = AVCaptureDevice.default(for: .video),
        let input = try? AVCaptureDeviceInput(device: device), session.canAddInput(input)
      else { return false }
      let output = AVCaptureVideoDataOutput()
      output.alwaysDiscardsLateVideoFrames = true
      output.setSampleBufferDelegate(self, queue: queue)
      guard session.canAddOutput(output) else { return false }
      session.sessionPreset = .vga640x480
      session.addInput(input)
      session.addOutput(output)
      return true
    }

    func captureOutput(
      _ output: AVCaptureOutput, didOutput sampleBuffer: CMSampleBuffer,
      from connection: AVCaptureConnection
    ) {
      let handler = VNImageRequestHandler(cmSampleBuffer: sampleBuffer, options: [:])
      guard (try? handler.perform([request])) != nil else { return }
      // The nearest face is the widest.
      let face = request.results?.max { $0.boundingBox.width < $1.boundingBox.width }
      continuation?.yield(
        face.map {
          HeadEstimate.position(
            x: $0.boundingBox.midX, y: $0.boundingBox.midY, aspect: 640.0 / 480)
        })
    }
  }
#endif
