import Foundation
import Observation

/// A training run, from the choice of a dataset to the scene.
@MainActor @Observable
public final class TrainingModel {
  public enum Phase: Equatable {
    case choosing
    case inspecting
    case ready(DatasetSummary)
    case preparing(ProgressStep)
    case running
    /// Stopped by a person, or because the app left the screen.
    case paused
    case finished(TestFigures?)
  }

  public private(set) var phase = Phase.choosing
  public private(set) var datasetName = ""
  public var preset = TrainingPreset.standard
  /// What the next run may train on.
  public var device = TrainingDevice.automatic
  /// What the run trains on.
  public private(set) var deviceName = ""
  /// Newest last.
  public private(set) var reports: [TrainReport] = []
  /// What happened on the way, in the core's words.
  public private(set) var notes: [String] = []
  public private(set) var savedStep: Int?
  public private(set) var preview: RenderedImage?
  /// The view that is shown while it trains, at the time of its photograph: an index into the dataset.
  public var previewView = 0 { didSet { if previewView != oldValue { refreshPreview() } } }
  public private(set) var viewCount = 0
  public var failure: Failure?

  @ObservationIgnored private let engine: any Engine
  @ObservationIgnored private let runs: URL
  @ObservationIgnored private var access: FileAccess?
  @ObservationIgnored private var summary: DatasetSummary?
  @ObservationIgnored private var trainer: (any TrainEngine)?
  @ObservationIgnored private var work: Task<Void, Never>?
  @ObservationIgnored private var drawing: Task<Void, Never>?

  /// Reports that the graph shows.
  static let reportCapacity = 2_000

  /// `runs` is where checkpoints are kept, a folder for each dataset.
  public init(engine: any Engine, runs: URL) {
    self.engine = engine
    self.runs = runs
  }

  public var report: TrainReport? { reports.last }
  /// Work that must not be interrupted by the device going to sleep.
  public var isRunning: Bool {
    switch phase {
    case .preparing, .running: true
    default: false
    }
  }
  public var canPause: Bool { phase == .running }
  public var canResume: Bool { phase == .paused && trainer != nil }
  public var secondsLeft: Double? {
    guard let report, report.stepsPerSecond > 0 else { return nil }
    return Double(report.steps - report.step) / report.stepsPerSecond
  }

  /// Looks at a folder of photographs.
  public func choose(_ dataset: URL) {
    discard()
    let access = FileAccess(dataset)
    self.access = access
    datasetName = dataset.lastPathComponent
    phase = .inspecting
    work = Task {
      do {
        let summary = try await engine.inspectDataset(at: dataset)
        guard self.access === access else { return }
        self.summary = summary
        phase = .ready(summary)
      } catch {
        guard self.access === access else { return }
        discard()
        report(error)
      }
    }
  }

  /// Starts the run, or goes on with the one that this dataset and preset have.
  public func start() {
    guard case .ready(let summary) = phase, let access else { return }
    phase = .preparing(ProgressStep(.preparing))
    let folder = runs.appending(path: "\(datasetName)-\(preset.rawValue)")
    var configuration = preset.configuration(for: summary, folder: folder)
    configuration.device = device
    work = Task {
      do {
        let trainer: any TrainEngine =
          try await engine
          .makeTrainer(dataset: access.url, configuration: configuration)
          .result { self.phase = .preparing($0) }
        guard self.access === access else { return }
        self.trainer = trainer
        viewCount = trainer.photographs.count
        deviceName = trainer.deviceName
        await follow(trainer)
      } catch {
        guard self.access === access else { return }
        // A refusal for want of memory comes before anything was done: another preset can be tried.
        phase = .ready(summary)
        report(error)
      }
    }
  }

  public func resume() {
    guard canResume, let trainer else { return }
    phase = .running
    work = Task { await follow(trainer) }
  }

  /// Stops after the step that is being taken, and saves.
  public func pause() async {
    guard phase == .running, let trainer else { return }
    phase = .paused
    work?.cancel()
    await work?.value
    do {
      try await trainer.checkpoint()
      savedStep = trainer.step
    } catch {
      report(error)
    }
  }

  /// Gives the run up; its checkpoints stay.
  public func discard() {
    work?.cancel()
    drawing?.cancel()
    (trainer, access, summary, preview, savedStep) = (nil, nil, nil, nil, nil)
    reports = []
    notes = []
    viewCount = 0
    deviceName = ""
    phase = .choosing
  }

  /// The scene as it is now: to look at, share or keep.
  public func scene() async -> (any SceneEngine)? {
    guard let trainer else { return nil }
    do { return try await trainer.scene() } catch {
      report(error)
      return nil
    }
  }

  /// Waits for what is going on.
  public func settle() async {
    await work?.value
    // A picture may be followed by another.
    while let drawing { await drawing.value }
  }

  private func follow(_ trainer: any TrainEngine) async {
    phase = .running
    do {
      for try await event in trainer.run() {
        // One may be on its way still when the run was given up.
        guard self.trainer === trainer else { return }
        handle(event)
      }
      if self.trainer === trainer, phase == .running { phase = .paused }
    } catch {
      guard self.trainer === trainer, !Task.isCancelled else { return }
      phase = .paused
      report(error)
    }
  }

  private func handle(_ event: TrainEvent) {
    switch event {
    case .report(let report): record(report)
    case .saved(let step): savedStep = step
    case .rolledBack(_, _, let reason): notes.append(reason)
    case .finished(let report, let test):
      record(report)
      phase = .finished(test)
    }
  }

  private func record(_ report: TrainReport) {
    reports.append(report)
    if reports.count > Self.reportCapacity {
      // Every second one, so that the graph keeps its beginning.
      reports = reports.enumerated().filter { $0.offset % 2 == 1 }.map(\.element)
    }
    refreshPreview()
  }

  /// One picture at a time: a slow device draws fewer, training does not wait. The last one is of the
  /// view that was chosen last.
  private func refreshPreview() {
    guard drawing == nil, let trainer, trainer.photographs.indices.contains(previewView) else {
      return
    }
    let view = previewView
    drawing = Task {
      // A picture that fails is only a picture; the run tells its own faults.
      let image = try? await trainer.preview(trainer.photographs[view])
      drawing = nil
      guard self.trainer === trainer else { return }
      if let image { preview = image }
      if view != previewView { refreshPreview() }
    }
  }

  private func report(_ error: any Error) {
    if let failure = Failure(.training, error) { self.failure = failure }
  }
}
