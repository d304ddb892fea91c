import Foundation

/// A scene in memory. It never changes: an edit makes another one.
public protocol SceneEngine: AnyObject, Sendable {
  /// What there is, in numbers.
  var summary: SceneSummary { get }

  /// The instance clusters, ordered by id; empty where the scene has none.
  var clusters: [ClusterRow] { get }

  /// The motion value below or at which `percentile` percent (0–100) of the splats lie; `nil` where
  /// the scene has no motion values.
  func staticThreshold(percentile: Double) -> Float?

  /// Box around the splats of a cluster at a time, the 2 % furthest along each axis left out;
  /// `nil` when it has none.
  func bounds(of cluster: ClusterID, at time: Double) async throws -> Bounds?

  /// The scene after these edits, in order, with clusters, network and motion following their splats.
  func applying(_ edits: [SceneEdit]) -> ProgressStream<any SceneEngine>

  /// Writes the scene as it is. What is there is replaced only when the new file is whole.
  func export(to destination: URL, as format: ExportFormat) -> ProgressStream<ExportResult>
}

/// The number of a cluster in the file: any 32-bit value, stable through edits.
public typealias ClusterID = UInt32

/// Axis-aligned box in world units.
public struct Bounds: Sendable, Equatable, Codable {
  public var min: Vector3
  public var max: Vector3

  public init(min: Vector3, max: Vector3) {
    self.min = min
    self.max = max
  }
}

/// A scene in numbers.
public struct SceneSummary: Sendable, Equatable {
  public var splatCount: Int
  /// Degree of the spherical harmonics, 0 to 3.
  public var harmonicsDegree: Int
  /// Box for framing: far floaters left out; `nil` in a scene without splats.
  public var framingBounds: Bounds?
  /// Whether there is a deformation network: without one time means nothing.
  public var isDeformable: Bool
  /// Whether there are motion values, so that static splats can be masked.
  public var hasMotion: Bool
  /// Share of the splats in percent that the scene's author recommends to hold still.
  public var recommendedStaticPercentile: Double?
  /// Bytes of the scene's arrays.
  public var memoryBytes: UInt64
  /// What was guessed or left out while reading, one line each.
  public var warnings: [String]

  public init(
    splatCount: Int, harmonicsDegree: Int, framingBounds: Bounds?, isDeformable: Bool,
    hasMotion: Bool, recommendedStaticPercentile: Double?, memoryBytes: UInt64, warnings: [String]
  ) {
    self.splatCount = splatCount
    self.harmonicsDegree = harmonicsDegree
    self.framingBounds = framingBounds
    self.isDeformable = isDeformable
    self.hasMotion = hasMotion
    self.recommendedStaticPercentile = recommendedStaticPercentile
    self.memoryBytes = memoryBytes
    self.warnings = warnings
  }
}

/// One instance cluster.
public struct ClusterRow: Sendable, Equatable, Identifiable {
  public let id: ClusterID
  /// A person's name for it, where the scene has one.
  public var name: String?
  public var color: RGBColor
  public var splatCount: Int

  public init(id: ClusterID, name: String?, color: RGBColor, splatCount: Int) {
    self.id = id
    self.name = name
    self.color = color
    self.splatCount = splatCount
  }
}

/// Red, green and blue in 0–1, in display space.
public struct RGBColor: Sendable, Hashable, Codable {
  public var red: Float
  public var green: Float
  public var blue: Float

  public init(red: Float, green: Float, blue: Float) {
    self.red = red
    self.green = green
    self.blue = blue
  }
}
