import Foundation
import Testing

@testable import TrapezeKit

@MainActor @Suite struct LifeCycleTests {
  private let window = ObjectIdentifier(Log.self)

  final class Log { var entries: [String] = [] }

  private func system(_ log: Log) -> LifeCycle.System {
    LifeCycle.System(
      beginBackgroundTask: {
        log.entries.append("begin"); return 7
      },
      endBackgroundTask: { log.entries.append("end \($0)") },
      setIdleSleep: { log.entries.append("sleep \($0)") })
  }

  final class Participant: LifeCycleParticipant {
    let log: Log
    var preventsSleep = false
    init(_ log: Log) { self.log = log }
    func suspend() async { log.entries.append("suspend"); await Task.yield() }
    func resume() async { log.entries.append("resume") }
    func shedMemory() async { log.entries.append("shed") }
  }

  @Test func workStopsInsideTheTimeThatTheSystemGives() async {
    let log = Log()
    let cycle = LifeCycle(system: system(log))
    let participant = Participant(log)
    cycle.add(participant)
    cycle.enterBackground(window: window)
    await cycle.settle()
    #expect(log.entries == ["begin", "suspend", "end 7"])
    #expect(cycle.state == .suspended)
    cycle.enterBackground(window: window)
    await cycle.settle()
    #expect(log.entries.count == 3)
    cycle.enterForeground(window: window)
    await cycle.settle()
    #expect(log.entries.last == "resume" && cycle.state == .active)
  }

  @Test func comingBackWhileThingsAreStoppedResumesThemAfterwards() async {
    let log = Log()
    let cycle = LifeCycle(system: system(log))
    let participant = Participant(log)
    cycle.add(participant)
    cycle.enterBackground(window: window)
    await Task.yield()
    cycle.enterForeground(window: window)
    await cycle.settle()
    #expect(log.entries == ["begin", "suspend", "end 7", "resume"])
    #expect(cycle.state == .active)
  }

  @Test func workGoesOnWhileOneWindowIsInFront() async {
    let log = Log()
    let cycle = LifeCycle(system: system(log))
    let other = ObjectIdentifier(Participant.self)
    cycle.enterForeground(window: window)
    cycle.enterForeground(window: other)
    cycle.enterBackground(window: other)
    await cycle.settle()
    #expect(cycle.state == .active && log.entries.isEmpty)
    cycle.enterBackground(window: window)
    await cycle.settle()
    #expect(cycle.state == .suspended)
  }

  @Test func aMemoryWarningReachesTheRenderer() async throws {
    let window = try Window()
    await window.open()
    let cycle = LifeCycle(system: system(Log()))
    cycle.add(window.scene)
    await cycle.memoryWarning()
    #expect(await window.renderer?.sheddings == 1)
  }

  @Test func theRendererRestsInTheBackgroundAndSettingsAreKept() async throws {
    let screen = try Window()
    await screen.open()
    let cycle = LifeCycle(system: system(Log()))
    cycle.add(screen.scene)
    screen.viewer.display.mode = .depth
    cycle.enterBackground(window: window)
    await cycle.settle()
    #expect(await screen.renderer?.isSuspended == true)
    let files = try FileManager.default.contentsOfDirectory(
      atPath: screen.folder.url.appending(path: "Scenes").path)
    #expect(files.count == 1)
    cycle.enterForeground(window: window)
    await cycle.settle()
    #expect(await screen.renderer?.isSuspended == false)
    await screen.tick()
    #expect(await screen.drawn().last?.mode == .depth)
  }

  @Test func aVideoStopsBeforeTheBackground() async throws {
    let screen = try Window()
    await screen.open()
    await screen.engine.gate.close()
    let writer = FrameCollector()
    let request = try #require(screen.viewer.request)
    let renderer = try #require(screen.renderer)
    screen.scene.movie.record(
      request, pose: screen.viewer.camera.pose, viewport: Viewport(width: 8, height: 8),
      with: renderer, to: writer
    ) { _ in }
    await screen.yield()
    await screen.scene.suspend()
    #expect(!screen.scene.movie.isRecording)
    #expect(await writer.isDiscarded)
  }

  @Test func trainingIsSavedInTheBackgroundAndKeepsTheDeviceAwake() async throws {
    let folder = try TemporaryFolder()
    let engine = TestEngine()
    let log = Log()
    let training = TrainingModel(engine: engine, runs: folder.url)
    let participant = TrainingLifeCycle(training)
    let cycle = LifeCycle(system: system(log))
    cycle.add(participant)
    training.choose(URL(filePath: "/photos"))
    await training.settle()
    training.start()
    for _ in 0..<5_000 where training.reports.isEmpty {
      try await Task.sleep(for: .milliseconds(1))
    }
    cycle.refreshSleep()
    #expect(log.entries == ["sleep false"])
    cycle.enterBackground(window: window)
    await cycle.settle()
    #expect(training.phase == .paused)
    #expect(await engine.trainer.checkpoints.count == 1)
    #expect(log.entries == ["sleep false", "begin", "sleep true", "end 7"])
    cycle.enterForeground(window: window)
    await cycle.settle()
    await Task.yield()
    #expect(training.isRunning)
    await training.pause()
    // A person's own pause stays one.
    cycle.enterBackground(window: window)
    await cycle.settle()
    cycle.enterForeground(window: window)
    await cycle.settle()
    #expect(training.phase == .paused)
  }

  @Test func theSelfCheckCanBeRunAndExported() async throws {
    let engine = TestEngine()
    let model = SelfCheckModel(engine: engine)
    #expect(model.json() == nil)
    model.run()
    await model.settle()
    #expect(model.report?.passed == true && !model.isRunning)
    let json = try #require(model.json().map { String(decoding: $0, as: UTF8.self) })
    #expect(json.contains("needles") && json.contains("\"inf\""))
    engine.fail(.checking, EngineError(.noDevice, "no adapter"))
    model.run()
    await model.settle()
    #expect(model.failure?.advice == .useAnotherDevice)
  }

  @Test func aCheckWithoutEntriesHasNotPassed() {
    #expect(!SelfCheckReport(device: "", coreVersion: "", entries: []).passed)
  }
}
