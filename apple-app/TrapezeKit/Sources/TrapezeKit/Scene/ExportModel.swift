import Foundation
import Observation

/// Writes what is left of a scene.
@MainActor @Observable
public final class ExportModel {
  public private(set) var progress: ProgressStep?
  public private(set) var result: ExportResult?
  public var isExporting: Bool { progress != nil }

  @ObservationIgnored private var work: Task<Void, Never>?
  @ObservationIgnored var didFail: @MainActor (any Error) -> Void = { _ in }

  public init() {}

  /// Name to propose for a file.
  public static func fileName(_ name: String, _ format: ExportFormat) -> String {
    let base = name.isEmpty ? "scene" : name
    return format == .folder ? base : "\(base).\(format.fileExtension)"
  }

  public func export(_ scene: any SceneEngine, to destination: URL, as format: ExportFormat) {
    guard !isExporting else { return }
    progress = ProgressStep(.writing, fraction: 0)
    result = nil
    // The place was chosen by a person, too: the right to write there lasts until the file is whole.
    let access = FileAccess(destination)
    work = Task {
      defer {
        progress = nil
        withExtendedLifetime(access) {}
      }
      do {
        result = try await scene.export(to: destination, as: format)
          .result { self.progress = $0 }
      } catch {
        didFail(error)
      }
    }
  }

  public func cancel() { work?.cancel() }

  public func settle() async { await work?.value }
}
