import Foundation
import Observation

/// The renderer's check of itself on this device.
@MainActor @Observable
public final class SelfCheckModel {
  public private(set) var progress: ProgressStep?
  public private(set) var report: SelfCheckReport?
  public var failure: Failure?
  public var isRunning: Bool { progress != nil }

  @ObservationIgnored private let engine: any Engine
  @ObservationIgnored private var work: Task<Void, Never>?

  public init(engine: any Engine) {
    self.engine = engine
  }

  public func run() {
    guard !isRunning else { return }
    progress = ProgressStep(.preparing)
    work = Task {
      defer { progress = nil }
      do {
        report = try await engine.selfCheck().result { self.progress = $0 }
      } catch {
        if let failure = Failure(.checking, error) { self.failure = failure }
      }
    }
  }

  public func cancel() { work?.cancel() }

  public func settle() async { await work?.value }

  /// The report as JSON, to be sent to whoever mends it; `nil` before there is one.
  public func json() -> Data? {
    guard let report else { return nil }
    let encoder = JSONEncoder()
    encoder.outputFormatting = [.prettyPrinted, .sortedKeys]
    // Numbers that are not finite have no form in JSON.
    encoder.nonConformingFloatEncodingStrategy = .convertToString(
      positiveInfinity: "inf", negativeInfinity: "-inf", nan: "nan")
    return try? encoder.encode(report)
  }
}
