import Foundation
internal import TrapezeBridge

/// Calls of the core block their thread, so they run on dispatch queues and never on the threads
/// of Swift's concurrency, of which there are only as many as cores.
struct CoreQueue: Sendable {
  private let queue: DispatchQueue

  /// One call after the other.
  static func serial(_ label: String, qos: DispatchQoS) -> CoreQueue {
    CoreQueue(queue: DispatchQueue(label: label, qos: qos))
  }

  /// Calls side by side.
  static let concurrent = CoreQueue(queue: DispatchQueue.global(qos: .userInitiated))

  private init(queue: DispatchQueue) {
    self.queue = queue
  }

  func async(_ body: @escaping @Sendable () -> Void) {
    queue.async(execute: body)
  }

  /// Runs a call and waits for it without blocking.
  func run<Value: Sendable>(_ body: @escaping @Sendable () throws -> Value) async throws -> Value {
    try await withCheckedThrowingContinuation { continuation in
      queue.async {
        continuation.resume(with: Result { try callingCore(body) })
      }
    }
  }

  /// Runs a long call and tells how far it is. Ending the stream cancels the call.
  func stream<Value: Sendable>(
    _ body: @escaping @Sendable (Work) throws -> Value
  ) -> ProgressStream<Value> {
    ProgressStream { continuation in
      let work = Work()
      let news = Task {
        var last: ProgressStep?
        while !Task.isCancelled {
          let step = ProgressStep(work.progress())
          if step != last { continuation.yield(.step(step)) }
          last = step
          try? await Task.sleep(for: .milliseconds(50))
        }
      }
      continuation.onTermination = { _ in
        work.cancel()
        news.cancel()
      }
      queue.async {
        do {
          let value = try callingCore { try body(work) }
          continuation.yield(.step(ProgressStep(work.progress())))
          continuation.yield(.finished(value))
          continuation.finish()
        } catch is CancellationError {
          continuation.finish()
        } catch {
          continuation.finish(throwing: error)
        }
      }
    }
  }
}

/// Runs calls of the core and translates what they throw.
func callingCore<Value>(_ body: () throws -> Value) throws -> Value {
  do {
    return try body()
  } catch let failure as TrapezeBridge.Failure {
    throw failure.translated
  }
}

extension TrapezeBridge.Failure {
  /// `CancellationError`, or an ``EngineError``.
  var translated: any Error {
    // The core's number for something that was cancelled; the others are those of the codes.
    if code() == 0 { return CancellationError() }
    return EngineError(
      EngineError.Code(rawValue: code()) ?? .internalFault, message().toString())
  }
}

extension Array {
  /// The elements as the core takes them: an empty array has an address too, which is never read.
  func withCoreSlice<Result>(
    _ body: (UnsafeBufferPointer<Element>) throws -> Result
  ) rethrows -> Result {
    guard isEmpty else { return try withUnsafeBufferPointer(body) }
    let aligned = UnsafePointer<Element>(bitPattern: MemoryLayout<Element>.alignment)
    return try body(UnsafeBufferPointer(start: aligned, count: 0))
  }
}

/// A value behind a lock.
final class Locked<Value>: @unchecked Sendable {
  private let lock = NSLock()
  private var value: Value

  init(_ value: Value) {
    self.value = value
  }

  func withValue<Result>(_ body: (inout Value) throws -> Result) rethrows -> Result {
    lock.lock()
    defer { lock.unlock() }
    return try body(&value)
  }
}
