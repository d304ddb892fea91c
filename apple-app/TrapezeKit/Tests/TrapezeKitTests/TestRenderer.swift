import Foundation

@testable import TrapezeKit

/// Draws points: the front-most within three pixels is what a pixel shows.
actor TestRenderer: RenderEngine {
  nonisolated let deviceName = "test"
  private let engine: TestEngine
  private(set) var options: RendererOptions
  private(set) var scene: TestScene?
  private(set) var drawn: [FrameRequest] = []
  private(set) var isSuspended = false
  private(set) var sheddings = 0
  /// Drawing says so many times that it has to be repeated.
  private var repeats = 0

  init(engine: TestEngine, options: RendererOptions) {
    self.engine = engine
    self.options = options
  }

  func setScene(_ scene: any SceneEngine) { self.scene = scene as? TestScene }
  func repeatFrames(_ count: Int) { repeats = count }

  /// Layers that were attached, with their sizes; `nil` for none.
  private(set) var attachments: [SIMD2<Int>?] = []

  func attach(_ layer: LayerPointer?, width: Int, height: Int) async throws {
    attachments.append(layer == nil ? nil : SIMD2(width, height))
  }

  nonisolated func show(
    _ scene: any SceneEngine, options: RendererOptions
  ) -> ProgressStream<Void> {
    engine.stream(.uploading, .drawing) { [self] in await install(scene, options) }
  }

  private func install(_ scene: any SceneEngine, _ options: RendererOptions) {
    setScene(scene)
    self.options = options
  }

  func draw(_ request: FrameRequest) async throws -> DrawReport {
    try await engine.gate.pass()
    try engine.check(.drawing)
    precondition(!isSuspended, "drew in the background")
    drawn.append(request)
    repeats -= 1
    return DrawReport(
      needsRedraw: repeats >= 0,
      stats: FrameStats(frameSeconds: 0.004, totalSplats: scene?.points.count ?? 0))
  }

  func render(_ request: FrameRequest) async throws -> RenderedImage {
    try await engine.gate.pass()
    try engine.check(.drawing)
    drawn.append(request)
    let (width, height) = (request.camera.width, request.camera.height)
    guard
      let image = RenderedImage(
        width: width, height: height, rgba: Data(count: 4 * width * height))
    else { throw EngineError(.invalidArgument, "size") }
    return image
  }

  func pick(_ request: FrameRequest, x: Int, y: Int) async throws -> PickResult? {
    guard let scene else { return nil }
    var best: PickResult?
    for (index, point) in scene.points.enumerated() {
      if case .hide(let hidden) = request.visibility, hidden.contains(point.cluster) { continue }
      if case .isolate(let shown) = request.visibility, !shown.contains(point.cluster) { continue }
      guard let seen = request.camera.project(scene.position(point, at: request.time)),
        hypot(seen.x - Double(x) - 0.5, seen.y - Double(y) - 0.5) < 3
      else { continue }
      if seen.depth < best?.depth ?? .infinity {
        best = PickResult(splat: index, cluster: point.cluster, depth: seen.depth)
      }
    }
    return best
  }

  nonisolated func measure(
    _ variants: [FrameVariant], camera: Camera, times: [Double]
  ) -> ProgressStream<[VariantMeasurement]> {
    engine.stream(.measuring, .drawing) {
      variants.map { variant in
        let share = (variant.staticPercentile ?? 0) / 100
        let isExact = variant == FrameVariant(precision: .single, staticPercentile: nil)
        return VariantMeasurement(
          variant: variant, frameMilliseconds: 10 * (1 - share) + 2,
          psnr: isExact ? nil : 60 - 40 * share)
      }
    }
  }

  func shedMemory() async { sheddings += 1 }
  func suspend() async { isSuspended = true }
  func resume() async { isSuspended = false }
}

/// Scores a cluster by how many characters of its name are in the text.
final class TestSearcher: SearchEngine {
  let modelName = "letters"
  let threshold = 0.75
  private let engine: TestEngine

  init(engine: TestEngine) { self.engine = engine }

  func encode(
    _ scene: any SceneEngine, renderer: any RenderEngine, cache: URL?
  ) -> ProgressStream<SearchIndex> {
    engine.stream(.encoding, .searching) {
      let names = Dictionary(uniqueKeysWithValues: scene.clusters.map { ($0.id, $0.name ?? "") })
      let image = RenderedImage(width: 1, height: 1, rgba: Data(count: 4))
      return SearchIndex(
        encodedClusters: Set(names.keys), thumbnails: names.compactMapValues { _ in image },
        storage: names)
    }
  }

  func search(_ text: String, in index: SearchIndex) async throws -> [SearchHit] {
    try await engine.gate.pass()
    try engine.check(.searching)
    let names = index.storage as? [ClusterID: String] ?? [:]
    return names.map { id, name in
      let common = Set(text).intersection(name).count
      return SearchHit(cluster: id, score: Double(common) / Double(max(Set(text).count, 1)))
    }
    .sorted { ($0.score, $1.cluster) > ($1.score, $0.cluster) }
  }
}

/// Takes a step whenever it is asked for the next event.
actor TestTrainer: TrainEngine {
  private nonisolated let counter = Counter()
  private(set) var checkpoints: [Int] = []
  nonisolated let deviceName = "test"
  nonisolated let steps: Int
  nonisolated let fault: EngineError?

  final class Counter: @unchecked Sendable {
    private let lock = NSLock()
    private var value = 0
    var current: Int { lock.withLock { value } }
    func next() -> Int {
      lock.withLock {
        value += 1; return value
      }
    }
  }

  init(steps: Int = 1_000_000, fault: EngineError? = nil) {
    self.steps = steps
    self.fault = fault
  }

  nonisolated var step: Int { counter.current }
  nonisolated var photographs: [Photograph] {
    let camera = OrbitPose().camera(in: Viewport(width: 4, height: 4))
    return [0, 0.5, 1].map { Photograph(camera: camera, time: $0) }
  }

  nonisolated func run() -> AsyncThrowingStream<TrainEvent, any Error> {
    AsyncThrowingStream { [self] in
      if let fault, step >= steps / 2 { throw fault }
      if step >= steps { return nil }
      try? await Task.sleep(for: .microseconds(200))
      if Task.isCancelled { return nil }
      let report = report(step: counter.next())
      return report.step == steps
        ? .finished(report, test: TestFigures(psnr: 30, ssim: 0.9)) : .report(report)
    }
  }

  private nonisolated func report(step: Int) -> TrainReport {
    TrainReport(
      step: step, steps: steps, seconds: Double(step), stepsPerSecond: 10, loss: 1 / Double(step),
      psnr: 20, splatCount: 100)
  }

  func checkpoint() async throws { checkpoints.append(step) }

  /// One pixel, whose red is the time.
  func preview(_ photograph: Photograph) async throws -> RenderedImage {
    let red = UInt8(255 * photograph.time)
    guard let image = RenderedImage(width: 1, height: 1, rgba: Data([red, 0, 0, 255])) else {
      throw EngineError(.internalFault, "size")
    }
    return image
  }

  func scene() async throws -> any SceneEngine { TestScene.twoObjects(motion: 0) }
}
