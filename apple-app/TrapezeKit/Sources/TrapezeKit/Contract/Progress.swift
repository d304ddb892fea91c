/// News of something that takes long.
public enum Progress<Value: Sendable>: Sendable {
  /// How far it is.
  case step(ProgressStep)
  /// The result; the stream ends after it.
  case finished(Value)
}

/// How far something is.
public struct ProgressStep: Sendable, Equatable {
  /// What is being done.
  public enum Stage: String, Sendable, Codable, CaseIterable {
    case reading, uploading, compiling, encoding, rendering, measuring, writing, preparing
  }

  public var stage: Stage
  /// From 0 to 1; `nil` where the end is not known.
  public var fraction: Double?

  public init(_ stage: Stage, fraction: Double? = nil) {
    self.stage = stage
    self.fraction = fraction.map { min(max($0, 0), 1) }
  }
}

/// Steps, then one result. Ends without one only by throwing; dropping it cancels the work.
public typealias ProgressStream<Value: Sendable> = AsyncThrowingStream<Progress<Value>, any Error>

extension AsyncThrowingStream where Failure == any Error {
  /// Waits for the result and tells each step on the way.
  ///
  /// - Throws: what the stream throws; `CancellationError` when the task that waits was cancelled,
  ///   whatever the stream has still to tell, and when the stream ends without a result.
  public func result<Value>(
    isolation: isolated (any Actor)? = #isolation,
    onStep: (ProgressStep) -> Void = { _ in }
  ) async throws -> Value where Element == Progress<Value> {
    for try await news in self {
      try Task.checkCancellation()
      switch news {
      case .step(let step): onStep(step)
      case .finished(let value): return value
      }
    }
    throw CancellationError()
  }
}
