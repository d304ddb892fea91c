import Foundation
import Testing

@testable import TrapezeKit

actor FrameCollector: MovieWriter {
  private(set) var frames = 0
  private(set) var isFinished = false
  private(set) var isDiscarded = false
  private let capacity: Int

  init(capacity: Int = .max) { self.capacity = capacity }

  func append(_ image: RenderedImage) async throws {
    if frames == capacity { throw EngineError(.unwritableFile, "movie.mp4: disk full") }
    frames += 1
  }
  func finish() async throws { isFinished = true }
  func discard() async { isDiscarded = true }
}

@MainActor @Suite struct MovieTests {
  @Test func aTurnEndsBeforeItBeginsAgain() {
    let move = CameraMove(kind: .turntable, seconds: 1, framesPerSecond: 10)
    let pose = OrbitPose(azimuth: 0.2)
    #expect(move.frame(0, from: pose, time: 0.3).pose == pose)
    #expect(move.frame(0, from: pose, time: 0.3).time == 0.3)
    let last = move.frame(9, from: pose, time: 0.3).pose
    #expect(abs(last.azimuth - 0.2 - 2 * .pi * 0.9) < 1e-12)
  }

  @Test func aPassageOfTimeShowsBothEnds() {
    let move = CameraMove(kind: .time, seconds: 1, framesPerSecond: 10)
    #expect(move.frame(0, from: OrbitPose(), time: 0.3).time == 0)
    #expect(move.frame(9, from: OrbitPose(), time: 0.3).time == 1)
    #expect(move.frame(5, from: OrbitPose(), time: 0.3).pose == OrbitPose())
    #expect(CameraMove(seconds: .nan, framesPerSecond: 0).frameCount >= 1)
  }

  private func record(
    _ window: Window, _ model: MovieModel, to writer: FrameCollector
  ) throws {
    let request = try #require(window.viewer.request)
    let renderer = try #require(window.renderer)
    model.record(
      request, pose: window.viewer.camera.pose, viewport: Viewport(width: 8, height: 8),
      with: renderer, to: writer
    ) { window.scene.failure = Failure(.exporting, $0) }
  }

  @Test func everyFrameIsDrawnInOrder() async throws {
    let window = try Window()
    await window.open()
    let model = MovieModel()
    model.move = CameraMove(kind: .turntableAndTime, seconds: 1, framesPerSecond: 12)
    let writer = FrameCollector()
    try record(window, model, to: writer)
    #expect(model.isRecording)
    await model.settle()
    #expect(await writer.frames == 12)
    #expect(await writer.isFinished)
    let drawn = await window.drawn()
    #expect(drawn.map(\.time) == drawn.map(\.time).sorted() && drawn.last?.time == 1)
    #expect(drawn.allSatisfy { $0.camera.width == 8 })
  }

  @Test func cancellingRemovesTheFile() async throws {
    let window = try Window()
    await window.open()
    await window.engine.gate.close()
    let model = MovieModel()
    let writer = FrameCollector()
    try record(window, model, to: writer)
    await window.yield()
    model.cancel()
    await model.settle()
    #expect(await writer.isDiscarded)
    #expect(window.scene.failure == nil && !model.isRecording)
  }

  @Test func aFullDiskIsAnAlertAndLeavesNoFile() async throws {
    let window = try Window()
    await window.open()
    let model = MovieModel()
    let writer = FrameCollector(capacity: 3)
    try record(window, model, to: writer)
    await model.settle()
    #expect(await writer.isDiscarded)
    #expect(window.scene.failure?.advice == .freeStorage)
  }
}
