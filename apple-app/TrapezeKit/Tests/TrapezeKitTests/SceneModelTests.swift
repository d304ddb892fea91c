import Foundation
import Testing

@testable import TrapezeKit

@MainActor @Suite struct SceneModelTests {
  private let left = Vector3(-1, 0, 0)

  @Test func openingShowsProgressThenTheFramedScene() async throws {
    let window = try Window()
    await window.engine.gate.close()
    window.viewer.resize(to: Viewport(width: 400, height: 300))
    window.scene.open(URL(filePath: "/garden.ply"))
    await window.yield()
    guard case .loading = window.scene.phase else { throw Unexpected() }
    await window.engine.gate.open()
    await window.scene.settle()
    #expect(window.scene.phase == .ready)
    #expect(window.scene.name == "garden")
    let bounds = try #require(window.scene.summary?.framingBounds)
    #expect(window.viewer.camera.pose.target == bounds.center)
    for corner in bounds.corners {
      let seen = try #require(
        window.viewer.camera.pose.location(of: corner, in: window.viewer.viewport))
      #expect((0...400).contains(seen.x) && (0...300).contains(seen.y))
    }
  }

  @Test func aSceneThatIsOpenedBeforeTheViewHasASizeIsFramedLater() async throws {
    let window = try Window()
    window.scene.open(URL(filePath: "/a.ply"))
    await window.scene.settle()
    window.viewer.resize(to: Viewport(width: 100, height: 100))
    let bounds = try #require(window.scene.summary?.framingBounds)
    #expect(window.viewer.camera.pose.target == bounds.center)
  }

  @Test func openingCanBeCancelled() async throws {
    let window = try Window()
    await window.engine.gate.close()
    window.scene.open(URL(filePath: "/a.ply"))
    await window.yield()
    window.scene.cancelOpening()
    await window.engine.gate.open()
    await window.scene.settle()
    #expect(window.scene.phase == .empty && window.scene.failure == nil)
    await window.open("b.ply")
    #expect(window.scene.phase == .ready && window.scene.name == "b")
  }

  @Test func anEditOfASceneThatWasClosedDoesNotReachTheNextOne() async throws {
    let window = try Window()
    await window.open("a.ply")
    window.scene.selection.choose([3])
    await window.engine.gate.close()
    let edit = Task { await window.scene.deleteChosen() }
    await window.yield()
    window.scene.close()
    await window.engine.gate.open()
    await edit.value
    await window.open("b.ply")
    #expect(window.scene.summary?.splatCount == 200 && !window.scene.edits.hasChanges)
  }

  @Test func newsAfterACancellationAreNotTold() async throws {
    let (stream, continuation) = ProgressStream<Int>.makeStream()
    continuation.yield(.step(ProgressStep(.reading)))
    continuation.yield(.finished(1))
    continuation.finish()
    let task = Task { @MainActor in
      var steps = 0
      withUnsafeCurrentTask { $0?.cancel() }
      let value: Int? = try? await stream.result { _ in steps += 1 }
      return (steps, value)
    }
    let (steps, value) = await task.value
    #expect(steps == 0 && value == nil)
  }

  @Test func aBrokenFileIsAnAlertThatSaysWhatToDo() async throws {
    let window = try Window()
    window.engine.fail(.opening, EngineError(.malformedFile, "a.ply: header: expected x"))
    await window.open()
    #expect(window.scene.phase == .empty)
    #expect(
      window.scene.failure
        == Failure(task: .opening, reason: "a.ply: header: expected x", advice: .checkFormat))
  }

  @Test func everyCodeHasAdviceAndCancellationNone() {
    for code in EngineError.Code.allCases {
      #expect(Failure(.opening, EngineError(code, "x"))?.reason == "x")
    }
    #expect(Failure(.opening, CancellationError()) == nil)
    #expect(Failure(.opening, CocoaError(.userCancelled)) == nil)
    #expect(Failure(.exporting, CocoaError(.fileWriteOutOfSpace))?.advice == .freeStorage)
    #expect(Failure(.training, EngineError(.outOfMemory, "x"))?.advice == .lowerQuality)
  }

  @Test func tappingChoosesTheClusterUnderTheFinger() async throws {
    let window = try Window(engine: TestEngine(scene: .twoObjects(motion: 0)))
    await window.open()
    let point = try #require(window.engine.scene.points.first { $0.cluster == 3 })
    let viewer = window.viewer
    let spot = try #require(viewer.camera.pose.location(of: point.position, in: viewer.viewport))
    await viewer.tap(at: spot, extending: true)
    #expect(window.scene.selection.chosenRows.map(\.id) == [3])
    #expect(viewer.chosenBounds[3] != nil)
    await viewer.tap(at: spot, extending: true)
    #expect(!window.scene.selection.hasChosen && viewer.chosenBounds.isEmpty)
    await viewer.tap(at: SIMD2(-5, 1e9), extending: true)
    #expect(window.scene.failure == nil)
  }

  @Test func hiddenClustersAreNotHit() async throws {
    let window = try Window(engine: TestEngine(scene: .twoObjects(motion: 0)))
    await window.open()
    let viewer = window.viewer
    window.scene.selection.setVisible(false, 3)
    let point = try #require(window.engine.scene.points.first { $0.cluster == 3 })
    let spot = try #require(viewer.camera.pose.location(of: point.position, in: viewer.viewport))
    await viewer.tap(at: spot, extending: true)
    #expect(!window.scene.selection.state.isChosen(3))
  }

  @Test func aDoubleTapFramesTheClusterWhereItIsNow() async throws {
    let window = try Window()
    await window.open()
    window.scene.playback.pause()
    window.scene.playback.seek(to: 1)
    let viewer = window.viewer
    let point = try #require(window.engine.scene.points.first { $0.cluster == 70 })
    let now = window.engine.scene.position(point, at: 1)
    let spot = try #require(viewer.camera.pose.location(of: now, in: viewer.viewport))
    await viewer.focus(at: spot)
    _ = await window.rest()
    let bounds = try #require(try await window.engine.scene.bounds(of: 70, at: 1))
    #expect(viewer.camera.pose.target == bounds.center)
  }

  @Test func settingsComeBackWithTheScene() async throws {
    let window = try Window()
    await window.open()
    window.viewer.orbit(by: SIMD2(33, 11))
    window.viewer.display.mode = .motion
    window.viewer.display.masksStatic = true
    window.viewer.display.staticPercentile = 62
    window.scene.playback.speed = 2
    window.scene.playback.loopMode = .pingPong
    window.scene.selection.setVisible(false, 70)
    window.scene.search.settings.topK = 3
    let kept = window.viewer.display
    let pose = window.viewer.camera.pose
    window.scene.close()
    #expect(window.scene.phase == .empty && window.scene.selection.rows.isEmpty)

    let again = try Window(folder: window.folder)
    await again.open()
    #expect(again.viewer.display == kept)
    #expect(again.viewer.camera.pose == pose)
    #expect(again.scene.playback.speed == 2 && again.scene.playback.loopMode == .pingPong)
    #expect(again.scene.selection.state.visibility == .hide([70]))
    #expect(again.scene.search.settings.topK == 3)
    await again.open("other.ply")
    #expect(again.viewer.display.mode == .color)
  }

  @Test func theAuthorsRecommendationIsTheFirstPercentile() async throws {
    let window = try Window()
    await window.open()
    #expect(window.viewer.display.staticPercentile == 45 && !window.viewer.display.masksStatic)
    #expect(window.viewer.request?.staticThreshold == nil)
    window.viewer.display.masksStatic = true
    #expect(window.viewer.request?.staticThreshold == 0.45)
    window.viewer.display.staticPercentile = 20
    #expect(window.viewer.request?.staticThreshold == 0.2)
  }

  @Test func editsUndoAndRedo() async throws {
    let window = try Window()
    await window.open()
    let scene = window.scene
    scene.selection.choose([3])
    await scene.deleteChosen()
    #expect(scene.summary?.splatCount == 100 && scene.selection.rows.map(\.id) == [70])
    #expect(!scene.selection.hasChosen)
    await scene.rename(70, to: "  green ball ")
    #expect(scene.selection.row(70)?.name == "green ball")
    await scene.recolor(70, to: RGBColor(red: 1, green: 0, blue: 0))
    await scene.removeFloaters()
    #expect(scene.summary?.splatCount == 99)
    #expect(await window.renderer?.scene?.points.count == 99)
    for _ in 0..<4 { await scene.edits.undo() }
    #expect(scene.summary?.splatCount == 200 && scene.selection.row(70)?.name == nil)
    #expect(!scene.edits.canUndo)
    for _ in 0..<4 { await scene.edits.redo() }
    #expect(scene.summary?.splatCount == 99 && scene.selection.row(70)?.name == "green ball")
    #expect(!scene.edits.canRedo)
  }

  @Test func anEditThatFailsChangesNothing() async throws {
    let window = try Window()
    await window.open()
    window.scene.selection.choose([3, 70])
    await window.scene.deleteChosen()
    #expect(window.scene.failure?.advice == .changeEdit)
    #expect(window.scene.summary?.splatCount == 200 && !window.scene.edits.hasChanges)
    #expect(!window.scene.edits.isEditing)
  }

  @Test func croppingStartsWithTheWholeSceneAndCanBeCancelled() async throws {
    let window = try Window()
    await window.open()
    let scene = window.scene
    scene.beginCrop()
    #expect(window.viewer.cropBox == scene.summary?.framingBounds)
    scene.cancelCrop()
    await scene.applyCrop()
    #expect(scene.summary?.splatCount == 200)
    scene.beginCrop()
    window.viewer.cropBox?.max.x = 0
    await scene.applyCrop()
    #expect(scene.summary?.splatCount == 100 && window.viewer.cropBox == nil)
  }

  @Test func exportWritesWhatIsLeft() async throws {
    let window = try Window()
    await window.open()
    window.scene.selection.choose([70])
    await window.scene.keepChosen()
    let scene = try #require(window.scene.scene)
    let place = window.folder.url.appending(
      path: ExportModel.fileName(window.scene.name, .spz))
    window.scene.export.export(scene, to: place, as: .spz)
    await window.scene.export.settle()
    #expect(window.scene.export.result?.splatCount == 100)
    #expect(try String(contentsOf: place, encoding: .utf8) == "100")
    window.scene.export.export(
      scene, to: window.folder.url.appending(path: "no/such/folder.ply"), as: .ply)
    await window.scene.export.settle()
    #expect(window.scene.failure?.advice == .freeStorage)
  }

  @Test func changingThePrecisionKeepsTheViewAndShowsOnDevice() async throws {
    let window = try Window()
    await window.open()
    let pose = window.viewer.camera.pose
    await window.scene.setOptions(RendererOptions(precision: .half))
    #expect(await window.renderer?.options.precision == .half)
    #expect(window.viewer.display.options.precision == .half)
    #expect(window.viewer.camera.pose == pose)
  }

  @Test func theSliderShowsMeasuredSpeedAndError() async throws {
    let window = try Window()
    await window.open()
    #expect(window.scene.tuning.prediction(at: 50, precision: .single) == nil)
    let camera = try #require(window.viewer.request?.camera)
    window.scene.tuning.measure(from: camera, precision: .single)
    await window.scene.tuning.settle()
    let half = try #require(window.scene.tuning.prediction(at: 50, precision: .single))
    #expect(abs(half.frameMilliseconds - 7) < 1e-12 && abs(half.speedUp - 12.0 / 7) < 1e-12)
    #expect(half.psnr == 40)
    let none = try #require(window.scene.tuning.prediction(at: 0, precision: .single))
    #expect(none.speedUp == 1 && none.psnr == nil)
    // Between no error and the first that was measured, the measured one is promised.
    #expect(window.scene.tuning.prediction(at: 10, precision: .single)?.psnr == 50)
    let kept = window.scene.tuning.measurements
    window.scene.close()
    await window.open()
    #expect(window.scene.tuning.measurements == kept)
  }

  @Test func twoWindowsHaveTwoScenes() async throws {
    let engine = TestEngine()
    let (first, second) = (try Window(engine: engine), try Window(engine: engine))
    async let one: Void = first.open("one.ply")
    async let two: Void = second.open("two.ply")
    _ = await (one, two)
    first.scene.selection.choose([3])
    #expect(!second.scene.selection.hasChosen)
    #expect(first.renderer !== second.renderer)
  }

  @Test func openingASceneFromMemoryNeedsNoFile() async throws {
    let window = try Window()
    window.scene.open(TestScene.twoObjects(motion: 0), name: "trained")
    await window.scene.settle()
    #expect(window.scene.phase == .ready && !window.scene.playback.isPlaying)
  }

  private struct Unexpected: Error {}
}
