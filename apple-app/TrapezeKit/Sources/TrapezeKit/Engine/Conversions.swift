import Foundation
internal import TrapezeBridge

extension ProgressStep {
  init(_ progress: WorkProgress) {
    let stage: Stage =
      switch progress.stage {
      case .Preparing: .preparing
      case .Reading: .reading
      case .Uploading: .uploading
      case .Compiling: .compiling
      case .Encoding: .encoding
      case .Rendering: .rendering
      case .Measuring: .measuring
      case .Writing: .writing
      }
    self.init(stage, fraction: progress.fraction.known)
  }
}

extension FloatingPoint {
  /// The core says NaN where it knows nothing.
  var known: Self? { isNaN ? nil : self }
}

extension Bounds {
  init?(_ box: Box3) {
    guard !box.min_x.isNaN else { return nil }
    self.init(
      min: Vector3(box.min_x, box.min_y, box.min_z), max: Vector3(box.max_x, box.max_y, box.max_z))
  }

  var core: Box3 {
    Box3(
      min_x: min.x, min_y: min.y, min_z: min.z, max_x: max.x, max_y: max.y, max_z: max.z)
  }
}

extension Camera {
  init(_ lens: Lens, rows: [Double]) {
    func row(_ index: Int) -> SIMD4<Double> {
      let start = 4 * index
      guard rows.count == 16 else { return SIMD4(repeating: .nan) }
      return SIMD4(rows[start], rows[start + 1], rows[start + 2], rows[start + 3])
    }
    self.init(
      width: Int(lens.width), height: Int(lens.height), fx: lens.fx, fy: lens.fy, cx: lens.cx,
      cy: lens.cy, worldToCamera: Matrix4(row(0), row(1), row(2), row(3)))
  }

  /// Sizes that no image has become 0, which the core refuses by name.
  var lens: Lens {
    Lens(
      width: UInt32(clamping: width), height: UInt32(clamping: height), fx: fx, fy: fy, cx: cx,
      cy: cy)
  }

  /// `worldToCamera`, row by row.
  var rows: [Double] {
    let rows = worldToCamera.rows
    return [rows.0, rows.1, rows.2, rows.3].flatMap { [$0.x, $0.y, $0.z, $0.w] }
  }
}

extension FrameRequest {
  var parameters: FrameParameters {
    FrameParameters(
      lens: camera.lens,
      time: time,
      mode: mode.core,
      visibility: visibility.kind,
      static_threshold: staticThreshold ?? .nan,
      background_red: background.red,
      background_green: background.green,
      background_blue: background.blue
    )
  }
}

extension FrameRequest.Mode {
  fileprivate var core: FrameMode {
    switch self {
    case .color: .Color
    case .clusters: .Clusters
    case .depth: .Depth
    case .motion: .Motion
    }
  }
}

extension ClusterVisibility {
  fileprivate var kind: Visibility {
    switch self {
    case .all: .All
    case .isolate: .Isolate
    case .hide: .Hide
    }
  }

  var clusters: [ClusterID] {
    switch self {
    case .all: []
    case .isolate(let clusters), .hide(let clusters): clusters.sorted()
    }
  }
}

extension RendererOptions {
  var parameters: RendererParameters {
    RendererParameters(
      half_precision: precision == .half,
      max_harmonics_degree: UInt32(clamping: maxHarmonicsDegree))
  }
}

extension RenderedImage {
  /// A copy of the core's image.
  init(_ image: TrapezeBridge.Image) throws {
    let rgba = withExtendedLifetime(image) {
      Data(bytes: image.bytes(), count: Int(image.byte_count()))
    }
    guard
      let copy = RenderedImage(
        width: Int(image.width()), height: Int(image.height()), rgba: rgba)
    else { throw EngineError(.internalFault, "image: expected 4 bytes a pixel") }
    self = copy
  }
}

extension FrameStats {
  init(_ figures: DrawFigures) {
    self.init(
      frameSeconds: figures.frame_seconds.known,
      deformSeconds: figures.deform_seconds.known,
      sortSeconds: figures.sort_seconds.known,
      rasterizeSeconds: figures.rasterize_seconds.known,
      deformedSplats: Int(figures.deformed_splats),
      visibleSplats: Int(figures.visible_splats),
      totalSplats: Int(figures.total_splats),
      deviceBytes: figures.device_bytes
    )
  }
}

extension TrainReport {
  init(_ figures: TrainFigures) {
    self.init(
      step: Int(figures.step), steps: Int(figures.steps), seconds: figures.seconds,
      stepsPerSecond: figures.steps_per_second, loss: figures.loss, psnr: figures.psnr,
      splatCount: Int(figures.splats))
  }
}

extension RustVec<RustString> {
  var strings: [String] { map { $0.as_str().toString() } }
}
