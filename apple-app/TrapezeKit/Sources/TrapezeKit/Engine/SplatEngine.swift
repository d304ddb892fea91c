import Foundation
internal import TrapezeBridge

#if canImport(Darwin)
  import Darwin
#endif

/// The Rust core behind the contract of the app.
public final class SplatEngine: Engine {
  /// What may draw.
  public enum Backend: Sendable {
    /// The graphics device, or the CPU where there is none.
    case automatic
    case gpu
    case cpu
  }

  private let backend: Backend
  /// Opened when it is first needed, and shared by all renderers.
  private let device = Locked<Device?>(nil)

  public init(backend: Backend = .automatic) {
    self.backend = backend
  }

  public var version: String { core_version().toString() }

  public func open(_ location: URL) -> ProgressStream<any SceneEngine> {
    CoreQueue.concurrent.stream { work in SplatScene(try open_scene(location.path, work)) }
  }

  public func makeRenderer(
    for scene: any SceneEngine, options: RendererOptions
  ) -> ProgressStream<any RenderEngine> {
    CoreQueue.concurrent.stream { [self] work in
      let scene = try SplatScene.ofCore(scene)
      let device = try openedDevice(work)
      return SplatRenderer(try make_renderer(device, scene.core, options.parameters, work))
    }
  }

  public func inspectDataset(at location: URL) async throws -> DatasetSummary {
    try await CoreQueue.concurrent.run {
      let dataset = try inspect_dataset(location.path, 1, 0)
      let figures = dataset.figures()
      return DatasetSummary(
        format: dataset.format_name().toString(),
        viewCount: Int(figures.views),
        width: Int(figures.width),
        height: Int(figures.height),
        pointCount: Int(figures.points),
        warnings: dataset.warnings().strings
      )
    }
  }

  public func makeTrainer(
    dataset location: URL, configuration: TrainingConfiguration
  ) -> ProgressStream<any TrainEngine> {
    CoreQueue.concurrent.stream { [self] work in
      let dataset = try inspect_dataset(
        location.path, UInt32(clamping: configuration.downscale),
        UInt32(clamping: configuration.holdout ?? 0))
      let parameters = TrainParameters(
        steps: UInt32(clamping: configuration.steps),
        max_splats: UInt32(clamping: configuration.maxSplats ?? 0),
        harmonics_degree: UInt32(clamping: configuration.harmonicsDegree),
        memory_limit: configuration.memoryLimit ?? Self.availableMemory,
        backend: configuration.device.core
      )
      let photographs = (0..<dataset.figures().views).map { index in
        Photograph(
          camera: Camera(
            dataset.view_lens(index), rows: Array(dataset.view_world_to_camera(index))),
          time: dataset.view_time(index))
      }
      let trainer = try make_trainer(
        try openedDevice(work), dataset, parameters, configuration.folder.path, work)
      return SplatTrainer(trainer, photographs: photographs)
    }
  }

  public func makeSearcher(models: URL) -> ProgressStream<any SearchEngine> {
    CoreQueue.concurrent.stream { work in
      SceneSearcher(try open_search_model(models.path, work))
    }
  }

  public func selfCheck() -> ProgressStream<SelfCheckReport> {
    CoreQueue.concurrent.stream { [self] work in
      let check = try check_device(try openedDevice(work), work)
      let entries = (0..<check.count()).map { index in
        let figures = check.check(index)
        return SelfCheckReport.Entry(
          name: check.check_name(index).toString(), psnr: figures.psnr.known,
          milliseconds: figures.milliseconds.known, passed: figures.passed,
          note: check.check_note(index)?.toString())
      }
      return SelfCheckReport(
        device: check.device_name().toString(), coreVersion: version, entries: entries)
    }
  }

  /// Bytes that the app may still take before the system ends it; 0 lets the core ask.
  private static var availableMemory: UInt64 {
    #if os(iOS)
      UInt64(os_proc_available_memory())
    #else
      0
    #endif
  }

  private func openedDevice(_ work: Work) throws -> Device {
    try device.withValue { device in
      if let device { return device }
      let opened = try open_device(backend.core, work)
      device = opened
      return opened
    }
  }
}

extension TrainingDevice {
  fileprivate var core: TrapezeBridge.Backend {
    switch self {
    case .automatic: .Automatic
    case .gpu: .Gpu
    case .cpu: .Cpu
    }
  }
}

extension SplatEngine.Backend {
  fileprivate var core: TrapezeBridge.Backend {
    switch self {
    case .automatic: .Automatic
    case .gpu: .Gpu
    case .cpu: .Cpu
    }
  }
}
