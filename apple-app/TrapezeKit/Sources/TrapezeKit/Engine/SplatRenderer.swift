import Foundation
internal import TrapezeBridge

/// A scene on the graphics device, or drawn by the CPU where there is none.
public final class SplatRenderer: RenderEngine {
  let core: TrapezeBridge.Renderer
  public let deviceName: String
  /// One call after the other: a frame is in flight at a time.
  private let queue = CoreQueue.serial("trapeze.renderer", qos: .userInteractive)

  init(_ core: TrapezeBridge.Renderer) {
    self.core = core
    deviceName = core.device_name().toString()
  }

  public func attach(_ layer: LayerPointer?, width: Int, height: Int) async throws {
    let address = layer.map { UInt(bitPattern: $0.address) } ?? 0
    try await queue.run { [self] in
      try core.attach(address, UInt32(clamping: width), UInt32(clamping: height))
    }
  }

  public func show(
    _ scene: any SceneEngine, options: RendererOptions
  ) -> ProgressStream<Void> {
    queue.stream { [self] work in
      try core.show(try SplatScene.ofCore(scene).core, options.parameters, work)
    }
  }

  public func draw(_ request: FrameRequest) async throws -> DrawReport {
    try await queue.run { [self] in
      let figures = try request.camera.rows.withCoreSlice { camera in
        try request.visibility.clusters.withCoreSlice { clusters in
          try core.draw(request.parameters, camera, clusters)
        }
      }
      return DrawReport(needsRedraw: figures.needs_redraw, stats: FrameStats(figures))
    }
  }

  public func render(_ request: FrameRequest) async throws -> RenderedImage {
    try await queue.run { [self] in
      try RenderedImage(
        request.camera.rows.withCoreSlice { camera in
          try request.visibility.clusters.withCoreSlice { clusters in
            try core.render(request.parameters, camera, clusters)
          }
        })
    }
  }

  public func pick(_ request: FrameRequest, x: Int, y: Int) async throws -> PickResult? {
    guard x >= 0, y >= 0 else { return nil }
    return try await queue.run { [self] in
      let pick = try request.camera.rows.withCoreSlice { camera in
        try request.visibility.clusters.withCoreSlice { clusters in
          try core.pick(
            request.parameters, camera, clusters, UInt32(clamping: x), UInt32(clamping: y))
        }
      }
      guard pick.is_hit else { return nil }
      return PickResult(
        splat: Int(pick.splat), cluster: pick.has_cluster ? pick.cluster : nil, depth: pick.depth)
    }
  }

  public func measure(
    _ variants: [FrameVariant], camera: Camera, times: [Double]
  ) -> ProgressStream<[VariantMeasurement]> {
    // Beside the queue of the frames: playback goes on.
    CoreQueue.concurrent.stream { [self] work in
      let half: [UInt8] = variants.map { $0.precision == .half ? 1 : 0 }
      let percentiles = variants.map { $0.staticPercentile ?? .nan }
      let measurements = try camera.rows.withCoreSlice { rows in
        try times.withCoreSlice { times in
          try half.withCoreSlice { half in
            try percentiles.withCoreSlice { percentiles in
              try core.measure(camera.lens, rows, times, half, percentiles, work)
            }
          }
        }
      }
      return variants.enumerated().map { index, variant in
        let figures = measurements.measurement(UInt(index))
        return VariantMeasurement(
          variant: variant, frameMilliseconds: figures.frame_milliseconds,
          psnr: figures.psnr.isFinite ? figures.psnr : nil)
      }
    }
  }

  public func shedMemory() async {
    await quietly { try $0.shed_memory() }
  }

  public func suspend() async {
    await quietly { try $0.suspend() }
  }

  public func resume() async {
    await quietly { try $0.resume() }
  }

  /// What goes wrong here is told by the next frame.
  private func quietly(_ body: @escaping @Sendable (TrapezeBridge.Renderer) throws -> Void) async {
    try? await queue.run { [self] in try body(core) }
  }
}

extension SplatScene {
  /// The core can use its own scenes only.
  static func ofCore(_ scene: any SceneEngine) throws -> SplatScene {
    guard let scene = scene as? SplatScene else {
      throw EngineError(.invalidArgument, "scene: expected one of this engine, found another")
    }
    return scene
  }
}
