import Foundation
import Testing

@testable import TrapezeKit

@Suite struct SplatTrainerTests {
  private func configuration(_ folder: TemporaryFolder, steps: Int) -> TrainingConfiguration {
    TrainingConfiguration(
      steps: steps, maxSplats: 2_000, harmonicsDegree: 0, downscale: 2, holdout: 8,
      folder: folder.url.appending(path: "run"))
  }

  @Test func theDatasetIsDescribed() async throws {
    let summary = try await Engines.cpu.inspectDataset(at: Repository.sampleDataset)
    #expect(summary.format == "transforms.json")
    #expect(summary.viewCount > 8 && summary.width == 200 && summary.height == 200)
  }

  @Test func aRunIsTrainedToItsEndAndMeasured() async throws {
    let folder = try TemporaryFolder()
    let configuration = configuration(folder, steps: 30)
    let trainer = try await Engines.cpu
      .makeTrainer(dataset: Repository.sampleDataset, configuration: configuration).result()
    #expect(trainer.step == 0)
    let photograph = try #require(trainer.photographs.first)
    var steps: [Int] = []
    var finished: (TrainReport, TestFigures?)?
    for try await event in trainer.run() {
      switch event {
      case .report(let report):
        steps.append(report.step)
        #expect(report.steps == 30 && report.loss.isFinite && report.splatCount <= 10_000)
      case .finished(let report, let test): finished = (report, test)
      case .saved, .rolledBack: break
      }
    }
    #expect(steps == steps.sorted() && steps.last == 30)
    let test = try #require(finished?.1)
    #expect(test.psnr > 5 && test.ssim > 0)
    #expect(trainer.step == 30)

    let image = try await trainer.preview(photograph)
    #expect(image.width == 100 && image.colors.contains { $0 > 0 })
    let scene = try await trainer.scene()
    let file = configuration.folder.appending(path: "point_cloud.ply")
    let written = try await Engines.cpu.open(file).result()
    #expect(written.summary.splatCount == scene.summary.splatCount)
    // A complete run is not written over.
    do {
      _ = try await Engines.cpu
        .makeTrainer(dataset: Repository.sampleDataset, configuration: configuration).result()
      Issue.record("a complete run was begun again")
    } catch let error as EngineError {
      #expect(error.code == .invalidArgument)
    }
  }

  @Test func aRunOnAGraphicsDeviceSaysSoIsPausedAndGoesOn() async throws {
    let folder = try TemporaryFolder()
    var configuration = configuration(folder, steps: 24)
    configuration.downscale = 4
    configuration.device = .gpu
    let engine = SplatEngine(backend: .gpu)
    let first: any TrainEngine
    do {
      first =
        try await engine
        .makeTrainer(dataset: Repository.sampleDataset, configuration: configuration).result()
    } catch let error as EngineError where error.code == .noDevice {
      print("SKIPPED: training on a graphics device: \(error.message)")
      return
    }
    #expect(!first.deviceName.isEmpty && first.deviceName != "CPU")
    let photograph = try #require(first.photographs.first)
    let start = try await first.preview(photograph)
    let reader = Task {
      for try await event in first.run() {
        if case .report = event { return }
      }
    }
    try await reader.value
    try await first.checkpoint()
    #expect(first.step > 0)
    #expect(try await first.preview(photograph) != start)

    let second =
      try await engine
      .makeTrainer(dataset: Repository.sampleDataset, configuration: configuration).result()
    #expect(second.step == first.step && second.deviceName == first.deviceName)
    var test: TestFigures?
    for try await event in second.run() {
      if case .finished(_, let figures) = event { test = figures }
    }
    #expect(try #require(test).psnr > 5)
  }

  @Test func aGraphicsDeviceThatIsNotThereIsNotReplacedBySomethingElse() async throws {
    let folder = try TemporaryFolder()
    var configuration = configuration(folder, steps: 10)
    configuration.device = .gpu
    do {
      _ = try await Engines.cpu
        .makeTrainer(dataset: Repository.sampleDataset, configuration: configuration).result()
      Issue.record("the CPU was taken for a graphics device")
    } catch let error as EngineError {
      #expect(error.code == .noDevice)
    }
    configuration.device = .automatic
    let trainer = try await Engines.cpu
      .makeTrainer(dataset: Repository.sampleDataset, configuration: configuration).result()
    #expect(trainer.deviceName == "CPU")
  }

  @Test func aRunThatIsLeftGoesOnInAnotherProcess() async throws {
    let folder = try TemporaryFolder()
    let configuration = configuration(folder, steps: 2_000)
    let first = try await Engines.cpu
      .makeTrainer(dataset: Repository.sampleDataset, configuration: configuration).result()
    let reader = Task {
      for try await event in first.run() {
        if case .report = event { return }
      }
    }
    try await reader.value
    // Waits for the turn that is being taken, and for the state that is saved behind it.
    try await first.checkpoint()
    let reached = first.step
    #expect(reached > 0 && reached < 2_000)

    let second = try await Engines.cpu
      .makeTrainer(dataset: Repository.sampleDataset, configuration: configuration).result()
    #expect(second.step == reached)
  }

  @Test func aRunThatDoesNotFitIsRefusedBeforeItStarts() async throws {
    let folder = try TemporaryFolder()
    var configuration = configuration(folder, steps: 10)
    configuration.memoryLimit = 1 << 20
    do {
      _ = try await Engines.cpu
        .makeTrainer(dataset: Repository.sampleDataset, configuration: configuration).result()
      Issue.record("a run was begun in a megabyte")
    } catch let error as EngineError {
      #expect(error.code == .outOfMemory)
      #expect(error.message.contains("MB are needed"))
    }
    configuration.memoryLimit = nil
    configuration.steps = 0
    do {
      _ = try await Engines.cpu
        .makeTrainer(dataset: Repository.sampleDataset, configuration: configuration).result()
      Issue.record("a run without steps was begun")
    } catch let error as EngineError {
      #expect(error.code == .invalidArgument)
    }
  }

  @Test func whatIsNoDatasetIsRefused() async throws {
    let folder = try TemporaryFolder()
    await #expect(throws: EngineError.self) {
      try await Engines.cpu.inspectDataset(at: folder.url)
    }
  }
}
