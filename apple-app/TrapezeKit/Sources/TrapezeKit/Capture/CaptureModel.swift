import Foundation
import Observation

/// A capture with the phone: pictures are kept by themselves while the phone moves.
@MainActor @Observable
public final class CaptureModel {
  public enum Phase: Equatable {
    case idle
    case recording
    case finishing
    /// A dataset, ready to be trained on.
    case finished(URL)
  }

  public private(set) var phase = Phase.idle
  public private(set) var keptCount = 0
  public private(set) var pointCount = 0
  /// What keeps the newest picture from being kept, to tell the person who holds the phone.
  public private(set) var hint: KeyframePolicy.Rejection?
  public var failure: Failure?

  /// Pictures below which a training has too little to go on.
  public static let leastPictures = 12

  @ObservationIgnored private let root: URL
  @ObservationIgnored private var policy = KeyframePolicy()
  @ObservationIgnored private var folder: CaptureFolder?
  @ObservationIgnored private var writing: Task<Void, Never>?

  /// `root` is the folder of all captures.
  public init(root: URL = StandardFolders.documents.appending(path: "Captures")) {
    self.root = root
  }

  public var canFinish: Bool { phase == .recording && keptCount >= Self.leastPictures }

  public func start(at date: Date = Date()) {
    guard phase != .recording, phase != .finishing else { return }
    do {
      folder = try CaptureFolder(creating: root.appending(path: Self.name(date)))
    } catch {
      report(error)
      return
    }
    policy = KeyframePolicy()
    (keptCount, pointCount, hint) = (0, 0, nil)
    phase = .recording
  }

  /// Whether this picture should be encoded and handed to ``keep(_:jpeg:points:)``. Encoding costs
  /// more than a frame, so most pictures never are.
  public func wants(_ frame: CapturedFrame) -> Bool {
    guard phase == .recording else { return false }
    let rejection = policy.consider(frame)
    if rejection != hint { hint = rejection }
    return rejection == nil
  }

  public func keep(_ frame: CapturedFrame, jpeg: Data, points: [FeaturePoint]) {
    guard let folder, phase == .recording else { return }
    let before = writing
    // One after the other: the order of pictures is the order in which they were taken.
    writing = Task {
      await before?.value
      do {
        try await folder.append(frame, jpeg: jpeg, points: points)
        keptCount = await folder.frameCount
        pointCount = await folder.pointCount
      } catch {
        report(error)
      }
    }
  }

  /// Ends the capture and makes a dataset of it.
  public func finish() async {
    guard canFinish, let folder else { return }
    phase = .finishing
    await writing?.value
    do {
      try await folder.finish()
      phase = .finished(folder.url)
    } catch {
      phase = .idle
      report(error)
    }
    self.folder = nil
  }

  /// Ends the capture and removes it.
  public func cancel() async {
    guard phase == .recording, let folder else { return }
    phase = .idle
    await writing?.value
    self.folder = nil
    try? await folder.discard()
  }

  public func settle() async { await writing?.value }

  private func report(_ error: any Error) {
    if let failure = Failure(.capturing, error) { self.failure = failure }
  }

  /// A name that sorts by time and has no characters that a file system refuses.
  static func name(_ date: Date) -> String {
    var calendar = Calendar(identifier: .gregorian)
    calendar.timeZone = .current
    let parts = calendar.dateComponents(
      [.year, .month, .day, .hour, .minute, .second], from: date)
    func digits(_ value: Int?, _ count: Int = 2) -> String {
      let text = String(value ?? 0)
      return String(repeating: "0", count: max(0, count - text.count)) + text
    }
    let day = "\(digits(parts.year, 4))-\(digits(parts.month))-\(digits(parts.day))"
    return "Capture \(day) \(digits(parts.hour)).\(digits(parts.minute)).\(digits(parts.second))"
  }
}
