/// A scene on the graphics device.
///
/// One frame is in flight at a time: whoever draws waits for ``draw(_:)`` before the next call.
public protocol RenderEngine: AnyObject, Sendable {
  /// What it runs on, e.g. `Apple A17 Pro GPU`.
  var deviceName: String { get }

  /// Draws onto this layer from now on; `nil` draws nowhere. Size in pixels.
  func attach(_ layer: LayerPointer?, width: Int, height: Int) async throws

  /// Shows another scene (an edited one, usually) or the same with other options.
  func show(_ scene: any SceneEngine, options: RendererOptions) -> ProgressStream<Void>

  /// Draws one frame onto the layer and returns when it is submitted.
  func draw(_ request: FrameRequest) async throws -> DrawReport

  /// Draws one frame into memory.
  func render(_ request: FrameRequest) async throws -> RenderedImage

  /// What is seen at a pixel; `nil` where nothing is.
  func pick(_ request: FrameRequest, x: Int, y: Int) async throws -> PickResult?

  /// Median time and error of each variant, over `times`, from `camera`; the error is against the
  /// same frames in full precision with every splat evaluated.
  func measure(
    _ variants: [FrameVariant], camera: Camera, times: [Double]
  ) -> ProgressStream<[VariantMeasurement]>

  /// Gives back what can be made again: caches, spare buffers, images of former sizes.
  func shedMemory() async

  /// Waits for the device, and submits nothing until ``resume()``: an app in the background may not.
  func suspend() async

  func resume() async
}

/// A `CAMetalLayer` as the bridge takes it. Whoever attaches it keeps the layer alive until another
/// one (or none) is attached.
public struct LayerPointer: @unchecked Sendable, Equatable {
  public let address: UnsafeMutableRawPointer

  public init(_ address: UnsafeMutableRawPointer) {
    self.address = address
  }
}

/// How a scene is kept on the device.
public struct RendererOptions: Sendable, Equatable, Codable {
  /// Arithmetic of the deformation network.
  public enum Precision: String, Sendable, Codable, CaseIterable {
    case single, half
  }

  public var precision: Precision
  /// Highest degree of the spherical harmonics to keep, 0 to 3.
  public var maxHarmonicsDegree: Int

  public init(precision: Precision = .single, maxHarmonicsDegree: Int = 3) {
    self.precision = precision
    self.maxHarmonicsDegree = maxHarmonicsDegree
  }
}

/// Everything that decides what a frame looks like: two equal requests give the same image.
public struct FrameRequest: Sendable, Equatable {
  /// What is shown.
  public enum Mode: String, Sendable, Codable, CaseIterable, Identifiable {
    case color, clusters, depth, motion
    public var id: Self { self }
  }

  public var camera: Camera
  /// Time for the network.
  public var time: Double
  public var mode: Mode
  public var visibility: ClusterVisibility
  /// Splats whose motion value is at most this hold their state at t = 0; `nil` moves all.
  public var staticThreshold: Float?
  /// What shows where the scene does not.
  public var background: RGBColor

  public init(
    camera: Camera, time: Double = 0, mode: Mode = .color, visibility: ClusterVisibility = .all,
    staticThreshold: Float? = nil, background: RGBColor = RGBColor(red: 0, green: 0, blue: 0)
  ) {
    self.camera = camera
    self.time = time
    self.mode = mode
    self.visibility = visibility
    self.staticThreshold = staticThreshold
    self.background = background
  }
}

/// Which clusters are drawn. No limit on their number.
public enum ClusterVisibility: Sendable, Equatable, Codable {
  case all
  case isolate(Set<ClusterID>)
  case hide(Set<ClusterID>)
}

/// What a frame cost.
public struct DrawReport: Sendable, Equatable {
  /// Whether the same request should be drawn again: the frame needed larger buffers, which it has
  /// now, or no drawable was free.
  public var needsRedraw: Bool
  public var stats: FrameStats

  public init(needsRedraw: Bool, stats: FrameStats) {
    self.needsRedraw = needsRedraw
    self.stats = stats
  }
}

/// Figures of the newest frame that the device has reported; seconds on the device.
public struct FrameStats: Sendable, Equatable {
  public var frameSeconds: Double?
  public var deformSeconds: Double?
  public var sortSeconds: Double?
  public var rasterizeSeconds: Double?
  /// Splats that went through the network.
  public var deformedSplats: Int
  public var visibleSplats: Int
  public var totalSplats: Int
  /// Bytes on the device.
  public var deviceBytes: UInt64

  public init(
    frameSeconds: Double? = nil, deformSeconds: Double? = nil, sortSeconds: Double? = nil,
    rasterizeSeconds: Double? = nil, deformedSplats: Int = 0, visibleSplats: Int = 0,
    totalSplats: Int = 0, deviceBytes: UInt64 = 0
  ) {
    self.frameSeconds = frameSeconds
    self.deformSeconds = deformSeconds
    self.sortSeconds = sortSeconds
    self.rasterizeSeconds = rasterizeSeconds
    self.deformedSplats = deformedSplats
    self.visibleSplats = visibleSplats
    self.totalSplats = totalSplats
    self.deviceBytes = deviceBytes
  }
}

/// What a pixel shows.
public struct PickResult: Sendable, Equatable {
  /// Index of the splat that contributes most.
  public var splat: Int
  /// Its cluster, where the scene has clusters.
  public var cluster: ClusterID?
  /// Depth along the view axis, world units.
  public var depth: Double

  public init(splat: Int, cluster: ClusterID?, depth: Double) {
    self.splat = splat
    self.cluster = cluster
    self.depth = depth
  }
}

/// A way to draw frames whose speed and error are of interest.
public struct FrameVariant: Sendable, Hashable, Codable {
  public var precision: RendererOptions.Precision
  /// Share of the splats in percent that hold still; `nil` moves all.
  public var staticPercentile: Double?

  public init(precision: RendererOptions.Precision, staticPercentile: Double?) {
    self.precision = precision
    self.staticPercentile = staticPercentile
  }
}

/// Speed and error of a variant: never one without the other.
public struct VariantMeasurement: Sendable, Equatable, Codable {
  public var variant: FrameVariant
  /// Median over the frames.
  public var frameMilliseconds: Double
  /// Peak signal-to-noise ratio in dB; `nil` when the images are equal.
  public var psnr: Double?

  public init(variant: FrameVariant, frameMilliseconds: Double, psnr: Double?) {
    self.variant = variant
    self.frameMilliseconds = frameMilliseconds
    self.psnr = psnr
  }
}
