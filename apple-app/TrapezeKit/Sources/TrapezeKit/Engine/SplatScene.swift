import Foundation
internal import TrapezeBridge

/// A scene in the core's memory.
public final class SplatScene: SceneEngine {
  let core: TrapezeBridge.Scene
  public let summary: SceneSummary
  public let clusters: [ClusterRow]

  init(_ core: TrapezeBridge.Scene) {
    self.core = core
    let figures = core.figures()
    summary = SceneSummary(
      splatCount: Int(figures.splats),
      harmonicsDegree: Int(figures.harmonics_degree),
      framingBounds: Bounds(figures.framing),
      isDeformable: figures.deformable,
      hasMotion: figures.has_motion,
      recommendedStaticPercentile: figures.recommended_percentile.known,
      memoryBytes: figures.memory_bytes,
      warnings: core.warnings().strings
    )
    clusters = (0..<figures.clusters).map { index in
      let cluster = core.cluster(index)
      return ClusterRow(
        id: cluster.id,
        name: core.cluster_name(index)?.toString(),
        color: RGBColor(red: cluster.red, green: cluster.green, blue: cluster.blue),
        splatCount: Int(cluster.splats)
      )
    }
  }

  public func staticThreshold(percentile: Double) -> Float? {
    core.static_threshold(percentile).known
  }

  public func bounds(of cluster: ClusterID, at time: Double) async throws -> Bounds? {
    try await CoreQueue.concurrent.run { [self] in
      Bounds(try core.cluster_bounds(cluster, time))
    }
  }

  public func applying(_ edits: [SceneEdit]) -> ProgressStream<any SceneEngine> {
    CoreQueue.concurrent.stream { [self] work in
      let list = Edits()
      for edit in edits { list.append(edit) }
      return SplatScene(try core.edited(list, work))
    }
  }

  /// The same scene with the motion value of every splat, so that static ones can be masked.
  public func measuringMotion() -> ProgressStream<any SceneEngine> {
    CoreQueue.concurrent.stream { [self] work in SplatScene(try core.with_motion(work)) }
  }

  public func export(to destination: URL, as format: ExportFormat) -> ProgressStream<ExportResult> {
    CoreQueue.concurrent.stream { [self] work in
      let exported = try core.export_to(destination.path, format.core, work)
      return ExportResult(
        splatCount: Int(exported.splat_count()), bytes: exported.file_bytes(),
        warnings: exported.warnings().strings)
    }
  }
}

extension Edits {
  fileprivate func append(_ edit: SceneEdit) {
    switch edit {
    case .crop(let bounds):
      crop(bounds.core)
    case .delete(let clusters):
      clusters.sorted().withCoreSlice { delete_clusters($0) }
    case .keep(let clusters):
      clusters.sorted().withCoreSlice { keep_clusters($0) }
    case .deleteFaint(let below):
      delete_faint(below)
    case .removeFloaters(let sigmas):
      remove_floaters(sigmas)
    case .rename(let cluster, let name):
      rename(cluster, name)
    case .recolor(let cluster, let color):
      recolor(cluster, color.red, color.green, color.blue)
    }
  }
}

extension ExportFormat {
  fileprivate var core: TrapezeBridge.ExportFormat {
    switch self {
    case .ply: .Ply
    case .spz: .Spz
    case .folder: .Folder
    }
  }
}
