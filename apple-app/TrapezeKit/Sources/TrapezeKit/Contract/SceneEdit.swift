/// A change of a scene, as a value: a history of them is an undo stack, and a file of them a recipe.
public enum SceneEdit: Sendable, Equatable, Codable {
  /// Keeps the splats with their centre in a box in world coordinates.
  case crop(Bounds)
  /// Deletes the splats of these clusters.
  case delete(Set<ClusterID>)
  /// Deletes the splats of all clusters but these.
  case keep(Set<ClusterID>)
  /// Deletes splats fainter than an opacity in 0–1.
  case deleteFaint(below: Double)
  /// Deletes splats that hang far away from everything else: more than `sigmas` standard deviations
  /// above the mean of the log distances to their neighbours.
  case removeFloaters(sigmas: Double)
  /// Gives a cluster a name; `nil` takes it away.
  case rename(ClusterID, String?)
  /// Gives a cluster a display colour.
  case recolor(ClusterID, RGBColor)
}

/// What a scene is written as.
public enum ExportFormat: String, Sendable, CaseIterable, Identifiable {
  /// INRIA's PLY: full precision, without clusters, network and motion.
  case ply
  /// Niantic's SPZ: about a tenth of the size, without clusters, network and motion.
  case spz
  /// A folder with everything the scene has.
  case folder

  public var id: Self { self }

  /// Extension of the file name; empty for a folder.
  public var fileExtension: String { self == .folder ? "" : rawValue }
}

/// What was written.
public struct ExportResult: Sendable, Equatable {
  public var splatCount: Int
  public var bytes: UInt64
  /// What the format could not hold, one line each.
  public var warnings: [String]

  public init(splatCount: Int, bytes: UInt64, warnings: [String]) {
    self.splatCount = splatCount
    self.bytes = bytes
    self.warnings = warnings
  }
}
