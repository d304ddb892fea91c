import Foundation

@testable import TrapezeKit

/// A point with a cluster, where a splat would be.
struct TestPoint: Sendable {
  var position: Vector3
  var cluster: ClusterID
}

/// An engine of points, for view models to be driven with. It behaves like one: it projects, picks,
/// crops and counts; it can be told to be slow or to fail.
final class TestEngine: Engine, @unchecked Sendable {
  let version = "test"
  private let lock = NSLock()
  private var failures: [FailedTask: EngineError] = [:]
  let gate = Gate()
  let scene: TestScene
  private(set) var renderers: [TestRenderer] = []
  var trainer = TestTrainer()
  /// What the last run was asked for.
  private(set) var asked: TrainingConfiguration?
  var modelsAreThere = true

  init(scene: TestScene = .twoObjects()) { self.scene = scene }

  func fail(_ task: FailedTask, _ error: EngineError?) {
    lock.withLock { failures[task] = error }
  }

  func check(_ task: FailedTask) throws {
    if let error = lock.withLock({ failures[task] }) { throw error }
  }

  func stream<Value: Sendable>(
    _ stage: ProgressStep.Stage, _ task: FailedTask,
    _ value: @escaping @Sendable () async throws -> Value
  ) -> ProgressStream<Value> {
    ProgressStream { continuation in
      let work = Task {
        do {
          continuation.yield(.step(ProgressStep(stage, fraction: 0.5)))
          try await gate.pass()
          try check(task)
          continuation.yield(.finished(try await value()))
          continuation.finish()
        } catch {
          continuation.finish(throwing: error)
        }
      }
      continuation.onTermination = { _ in work.cancel() }
    }
  }

  func open(_ location: URL) -> ProgressStream<any SceneEngine> {
    stream(.reading, .opening) { [self] in scene }
  }

  func makeRenderer(
    for scene: any SceneEngine, options: RendererOptions
  ) -> ProgressStream<any RenderEngine> {
    stream(.compiling, .drawing) { [self] in
      let renderer = TestRenderer(engine: self, options: options)
      await renderer.setScene(scene)
      lock.withLock { renderers.append(renderer) }
      return renderer
    }
  }

  func inspectDataset(at location: URL) async throws -> DatasetSummary {
    try check(.training)
    return DatasetSummary(
      format: "transforms.json", viewCount: 20, width: 4032, height: 3024, pointCount: 100,
      warnings: [])
  }

  func makeTrainer(
    dataset: URL, configuration: TrainingConfiguration
  ) -> ProgressStream<any TrainEngine> {
    asked = configuration
    return stream(.preparing, .training) { [self] in trainer }
  }

  func makeSearcher(models: URL) -> ProgressStream<any SearchEngine> {
    stream(.reading, .searching) { [self] in
      guard modelsAreThere else {
        throw EngineError(.modelsMissing, "models: expected text.onnx, found none")
      }
      return TestSearcher(engine: self)
    }
  }

  func selfCheck() -> ProgressStream<SelfCheckReport> {
    stream(.rendering, .checking) {
      SelfCheckReport(
        device: "test", coreVersion: "1",
        entries: [.init(name: "needles", psnr: .infinity, milliseconds: 2, passed: true)])
    }
  }
}

/// Holds up whoever passes while it is closed.
actor Gate {
  private var isOpen = true
  private var waiting = 0
  var waitingCount: Int { waiting }

  func close() { isOpen = false }
  func open() { isOpen = true }

  func pass() async throws {
    waiting += 1
    defer { waiting -= 1 }
    while !isOpen { try await Task.sleep(for: .milliseconds(1)) }
    try Task.checkCancellation()
  }
}

final class TestScene: SceneEngine {
  let points: [TestPoint]
  let clusters: [ClusterRow]
  let summary: SceneSummary
  /// Points move along x by this over the whole time.
  let motion: Double

  init(points: [TestPoint], rows: [ClusterRow], motion: Double) {
    self.points = points
    self.motion = motion
    clusters = rows.compactMap { row in
      let count = points.count { $0.cluster == row.id }
      return count == 0
        ? nil : ClusterRow(id: row.id, name: row.name, color: row.color, splatCount: count)
    }
    summary = SceneSummary(
      splatCount: points.count, harmonicsDegree: 3, framingBounds: Self.box(points),
      isDeformable: motion != 0, hasMotion: true, recommendedStaticPercentile: 45,
      memoryBytes: UInt64(points.count * 56), warnings: [])
  }

  static let white = RGBColor(red: 1, green: 1, blue: 1)

  /// Cluster 3 around x = −1, cluster 70 around x = 1.
  static func twoObjects(motion: Double = 0.5) -> TestScene {
    let points = (0..<2_00).map { index in
      let angle = Double(index) * 0.7
      let offset = Vector3(cos(angle), sin(angle), cos(3 * angle)) * 0.2
      return index.isMultiple(of: 2)
        ? TestPoint(position: Vector3(-1, 0, 0) + offset, cluster: 3)
        : TestPoint(position: Vector3(1, 0, 0) + offset, cluster: 70)
    }
    return TestScene(
      points: points,
      rows: [
        ClusterRow(id: 3, name: "red ball", color: white, splatCount: 0),
        ClusterRow(id: 70, name: nil, color: white, splatCount: 0),
      ], motion: motion)
  }

  static func box(_ points: [TestPoint]) -> Bounds? {
    points.reduce(nil) { box, point in
      let own = Bounds(min: point.position, max: point.position)
      return box?.union(own) ?? own
    }
  }

  func position(_ point: TestPoint, at time: Double) -> Vector3 {
    point.position + Vector3(motion * time, 0, 0)
  }

  func staticThreshold(percentile: Double) -> Float? { Float(percentile / 100) }

  func bounds(of cluster: ClusterID, at time: Double) async throws -> Bounds? {
    Self.box(
      points.filter { $0.cluster == cluster }
        .map { TestPoint(position: position($0, at: time), cluster: cluster) })
  }

  func applying(_ edits: [SceneEdit]) -> ProgressStream<any SceneEngine> {
    ProgressStream { continuation in
      do {
        continuation.yield(.step(ProgressStep(.preparing, fraction: 0)))
        let scene = try edits.reduce(self) { try $0.applying($1) }
        continuation.yield(.finished(scene))
        continuation.finish()
      } catch {
        continuation.finish(throwing: error)
      }
    }
  }

  private func applying(_ edit: SceneEdit) throws -> TestScene {
    var points = points
    var rows = clusters
    switch edit {
    case .crop(let box):
      points = points.filter { point in
        (0..<3).allSatisfy {
          point.position[$0] >= box.min[$0] && point.position[$0] <= box.max[$0]
        }
      }
    case .delete(let ids): points = points.filter { !ids.contains($0.cluster) }
    case .keep(let ids): points = points.filter { ids.contains($0.cluster) }
    case .deleteFaint, .removeFloaters: points.removeLast()
    case .rename(let id, let name):
      for index in rows.indices where rows[index].id == id { rows[index].name = name }
    case .recolor(let id, let color):
      for index in rows.indices where rows[index].id == id { rows[index].color = color }
    }
    if points.isEmpty { throw EngineError(.invalidEdit, "edit: expected splats to be left") }
    return TestScene(points: points, rows: rows, motion: motion)
  }

  func export(to destination: URL, as format: ExportFormat) -> ProgressStream<ExportResult> {
    ProgressStream { continuation in
      do {
        try Data("\(points.count)".utf8).write(to: destination)
        continuation.yield(
          .finished(ExportResult(splatCount: points.count, bytes: 3, warnings: [])))
        continuation.finish()
      } catch {
        continuation.finish(throwing: EngineError(.unwritableFile, destination.lastPathComponent))
      }
    }
  }
}
