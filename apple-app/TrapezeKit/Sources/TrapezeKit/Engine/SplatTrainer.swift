import Foundation
internal import TrapezeBridge

/// A training run of the core.
public final class SplatTrainer: TrainEngine {
  private let core: TrapezeBridge.Trainer
  public let photographs: [Photograph]
  /// Steps are taken in turns of a tenth of a second, each a block on this queue: a preview or a
  /// checkpoint gets in between two of them.
  private let queue = CoreQueue.serial("trapeze.trainer", qos: .utility)

  init(_ core: TrapezeBridge.Trainer, photographs: [Photograph]) {
    self.core = core
    self.photographs = photographs
  }

  public var deviceName: String { core.device_name().toString() }

  public var step: Int { Int(core.current_step()) }

  public func run() -> AsyncThrowingStream<TrainEvent, any Error> {
    AsyncThrowingStream { continuation in
      let work = Work()
      continuation.onTermination = { _ in work.cancel() }
      takeTurn(work, continuation)
    }
  }

  private typealias Continuation = AsyncThrowingStream<TrainEvent, any Error>.Continuation

  private func takeTurn(_ work: Work, _ continuation: Continuation) {
    queue.async { [self] in
      do {
        try callingCore {
          if !core.is_finished() { try core.advance(work) }
        }
        for event in takeEvents() { continuation.yield(event) }
        guard core.is_finished() else { return takeTurn(work, continuation) }
        let test = try callingCore { try core.finish(work) }
        let figures = test.psnr.known.map { TestFigures(psnr: $0, ssim: test.ssim) }
        continuation.yield(.finished(TrainReport(core.report()), test: figures))
        continuation.finish()
      } catch is CancellationError {
        stop(continuation)
      } catch {
        for event in takeEvents() { continuation.yield(event) }
        continuation.finish(throwing: error)
      }
    }
  }

  /// The reader has gone: the state is kept for the next one.
  private func stop(_ continuation: Continuation) {
    do {
      try callingCore { try core.checkpoint() }
      continuation.finish()
    } catch {
      continuation.finish(throwing: error)
    }
  }

  private func takeEvents() -> [TrainEvent] {
    var events: [TrainEvent] = []
    while true {
      let event = core.next_event()
      guard event.is_event else { return events }
      switch event.kind {
      case .Report:
        events.append(.report(TrainReport(event.report)))
      case .Saved:
        events.append(.saved(step: Int(event.step)))
      case .RolledBack:
        events.append(
          .rolledBack(
            from: Int(event.step), to: Int(event.to),
            reason: core.rollback_reason().toString()))
      }
    }
  }

  public func checkpoint() async throws {
    try await queue.run { [self] in try core.checkpoint() }
  }

  public func preview(_ photograph: Photograph) async throws -> RenderedImage {
    try await queue.run { [self] in
      let camera = photograph.camera
      return try RenderedImage(
        camera.rows.withCoreSlice { try core.preview(camera.lens, $0, photograph.time) })
    }
  }

  public func scene() async throws -> any SceneEngine {
    try await queue.run { [self] in SplatScene(try core.trained_scene()) }
  }
}
