import Foundation
import Testing

@testable import TrapezeKit

@MainActor @Suite struct TrainingModelTests {
  private func ready(_ engine: TestEngine) async throws -> (TrainingModel, TemporaryFolder) {
    let folder = try TemporaryFolder()
    let model = TrainingModel(engine: engine, runs: folder.url)
    model.choose(URL(filePath: "/photos"))
    await model.settle()
    return (model, folder)
  }

  private func eventually(_ condition: @MainActor () -> Bool) async throws {
    for _ in 0..<5_000 where !condition() { try await Task.sleep(for: .milliseconds(1)) }
    #expect(condition())
  }

  @Test func aRunGoesFromTheDatasetToTheScene() async throws {
    let engine = TestEngine()
    engine.trainer = TestTrainer(steps: 20)
    let (model, _) = try await ready(engine)
    guard case .ready(let summary) = model.phase else { throw EngineError(.internalFault, "") }
    #expect(summary.viewCount == 20 && model.datasetName == "photos")
    model.device = .cpu
    model.start()
    await model.settle()
    #expect(engine.asked?.device == .cpu && model.deviceName == "test")
    #expect(model.phase == .finished(TestFigures(psnr: 30, ssim: 0.9)))
    #expect(model.reports.map(\.step) == Array(1...20))
    #expect(model.preview != nil && model.secondsLeft == 0)
    #expect(await model.scene()?.summary.splatCount == 200)
  }

  @Test func theViewThatIsChosenIsShownAtTheTimeOfItsPhotograph() async throws {
    let engine = TestEngine()
    engine.trainer = TestTrainer(steps: 3)
    let (model, _) = try await ready(engine)
    model.start()
    await model.settle()
    #expect(model.preview?.rgba.first == 0)
    // The third one is chosen while the picture of the second is drawn, and no report follows.
    model.previewView = 1
    model.previewView = 2
    await model.settle()
    #expect(model.viewCount == 3 && model.preview?.rgba.first == 255)
    model.previewView = 1
    await model.settle()
    #expect(model.preview?.rgba.first == 127)
  }

  @Test func pausingSavesAndResumingGoesOn() async throws {
    let engine = TestEngine()
    let (model, _) = try await ready(engine)
    model.start()
    try await eventually { model.reports.count > 5 }
    #expect(model.isRunning)
    await model.pause()
    #expect(model.phase == .paused && !model.isRunning)
    let step = engine.trainer.step
    #expect(await engine.trainer.checkpoints == [step] && model.savedStep == step)
    try await Task.sleep(for: .milliseconds(20))
    #expect(engine.trainer.step == step)
    model.resume()
    try await eventually { engine.trainer.step > step + 3 }
    await model.pause()
  }

  @Test func aRefusalForWantOfMemoryIsExplainedAndAnotherPresetCanBeTried() async throws {
    let engine = TestEngine()
    let (model, _) = try await ready(engine)
    engine.fail(
      .training, EngineError(.outOfMemory, "memory: 900 MB are needed, 400 MB are available"))
    model.preset = .fine
    model.start()
    await model.settle()
    #expect(model.failure?.advice == .lowerQuality)
    #expect(model.failure?.reason.contains("900 MB") == true)
    guard case .ready = model.phase else { throw EngineError(.internalFault, "") }
    engine.fail(.training, nil)
    engine.trainer = TestTrainer(steps: 3)
    model.preset = .draft
    model.start()
    await model.settle()
    guard case .finished = model.phase else { throw EngineError(.internalFault, "") }
  }

  @Test func aRunThatDivergesStopsWithItsReason() async throws {
    let engine = TestEngine()
    engine.trainer = TestTrainer(
      steps: 10, fault: EngineError(.trainingDiverged, "step 5: loss is not a number"))
    let (model, _) = try await ready(engine)
    model.start()
    await model.settle()
    #expect(model.phase == .paused && model.failure?.advice == .lowerQuality)
    #expect(model.report?.step == 5)
  }

  @Test func aDatasetThatCannotBeReadLeadsBackToTheChoice() async throws {
    let engine = TestEngine()
    engine.fail(.training, EngineError(.unusableDataset, "photos: expected transforms.json"))
    let (model, _) = try await ready(engine)
    #expect(model.phase == .choosing && model.failure?.advice == .checkDataset)
  }

  @Test func aRunThatIsGivenUpStops() async throws {
    let engine = TestEngine()
    let (model, _) = try await ready(engine)
    model.start()
    try await eventually { model.reports.count > 2 }
    model.discard()
    await model.settle()
    let step = engine.trainer.step
    try await Task.sleep(for: .milliseconds(20))
    #expect(engine.trainer.step == step)
    #expect(model.phase == .choosing && model.reports.isEmpty)
  }

  @Test func presetsMakePhotographsSmallerAndHoldViewsOutOnlyWhereThereAreEnough() {
    let folder = URL(filePath: "/x")
    func configuration(_ preset: TrainingPreset, _ side: Int, _ views: Int) -> TrainingConfiguration
    {
      preset.configuration(
        for: DatasetSummary(
          format: "", viewCount: views, width: side, height: side / 2, pointCount: 0,
          warnings: []), folder: folder)
    }
    #expect(configuration(.draft, 4032, 20).downscale == 7)
    #expect(configuration(.standard, 1280, 20).downscale == 1)
    #expect(configuration(.standard, 0, 20).downscale == 1)
    #expect(configuration(.standard, 100, 15).holdout == nil)
    #expect(configuration(.standard, 100, 16).holdout == 8)
    #expect(configuration(.draft, 1, 1).steps < configuration(.fine, 1, 1).steps)
  }
}
