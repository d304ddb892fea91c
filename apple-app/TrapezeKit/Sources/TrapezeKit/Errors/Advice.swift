import Foundation

/// What a person can do about a failure. The texts belong to the views.
public enum Advice: String, Sendable, CaseIterable {
  case chooseAnotherFile
  case checkFormat
  case freeStorage
  case reportFault
  case closeOtherScenes
  case useAnotherDevice
  case tryAgain
  case addModels
  case checkDataset
  case lowerQuality
  case changeEdit

  public init(_ code: EngineError.Code) {
    self =
      switch code {
      case .unreadableFile: .chooseAnotherFile
      case .malformedFile: .checkFormat
      case .unwritableFile: .freeStorage
      case .invalidArgument, .internalFault: .reportFault
      case .outOfMemory: .closeOtherScenes
      case .noDevice: .useAnotherDevice
      case .deviceFailed: .tryAgain
      case .modelsMissing: .addModels
      case .unusableDataset: .checkDataset
      case .trainingDiverged: .lowerQuality
      case .invalidEdit: .changeEdit
      }
  }
}

/// What was being done when something failed.
public enum FailedTask: String, Sendable, CaseIterable {
  case opening, drawing, editing, exporting, searching, training, capturing, checking
}

/// An alert: what failed, why, and what to do.
public struct Failure: Sendable, Equatable, Identifiable {
  public let task: FailedTask
  /// The core's own line, or the system's.
  public let reason: String
  public let advice: Advice

  public var id: String { "\(task.rawValue): \(reason)" }

  public init(task: FailedTask, reason: String, advice: Advice) {
    self.task = task
    self.reason = reason
    self.advice = advice
  }

  /// `nil` for a cancellation: a person asked for it and needs no alert.
  public init?(_ task: FailedTask, _ error: any Error) {
    if error is CancellationError { return nil }
    if (error as? CocoaError)?.code == .userCancelled { return nil }
    if let error = error as? EngineError {
      let advice =
        task == .training && error.code == .outOfMemory ? .lowerQuality : Advice(error.code)
      self.init(task: task, reason: error.message, advice: advice)
    } else {
      self.init(
        task: task, reason: error.localizedDescription,
        advice: task == .exporting || task == .capturing ? .freeStorage : .tryAgain)
    }
  }
}
