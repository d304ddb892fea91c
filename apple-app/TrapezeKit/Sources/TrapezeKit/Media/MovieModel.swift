import Foundation
import Observation

/// Takes the frames of a video, in order.
public protocol MovieWriter: Sendable {
  /// One frame. Waits while the encoder is busy.
  func append(_ image: RenderedImage) async throws
  /// Ends the file.
  func finish() async throws
  /// Removes what was written.
  func discard() async
}

/// Screenshots and videos.
@MainActor @Observable
public final class MovieModel {
  public var move = CameraMove()
  public private(set) var progress: ProgressStep?
  public var isRecording: Bool { progress != nil }

  @ObservationIgnored private var work: Task<Void, Never>?

  public init() {}

  /// Draws every frame of the move from where the viewer stands and gives it to the writer.
  public func record(
    _ request: FrameRequest, pose: OrbitPose, viewport: Viewport,
    with renderer: any RenderEngine, to writer: any MovieWriter,
    didFail: @escaping @MainActor (any Error) -> Void
  ) {
    guard !isRecording else { return }
    progress = ProgressStep(.rendering, fraction: 0)
    let move = move
    work = Task {
      defer { progress = nil }
      do {
        for index in 0..<move.frameCount {
          try Task.checkCancellation()
          var request = request
          let (pose, time) = move.frame(index, from: pose, time: request.time)
          request.camera = pose.camera(in: viewport)
          request.time = time
          try await writer.append(try await renderer.render(request))
          progress = ProgressStep(
            .rendering, fraction: Double(index + 1) / Double(move.frameCount))
        }
        try await writer.finish()
      } catch {
        await writer.discard()
        if !(error is CancellationError) { didFail(error) }
      }
    }
  }

  public func cancel() { work?.cancel() }

  public func settle() async { await work?.value }
}
