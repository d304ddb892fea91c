import Foundation
internal import TrapezeBridge

/// Text search with one pair of models.
public final class SceneSearcher: SearchEngine {
  private let model: TrapezeBridge.SearchModel
  public let modelName: String
  public let threshold: Double

  init(_ model: TrapezeBridge.SearchModel) {
    self.model = model
    modelName = model.name().toString()
    threshold = model.threshold()
  }

  public func encode(
    _ scene: any SceneEngine, renderer: any RenderEngine, cache: URL?
  ) -> ProgressStream<SearchIndex> {
    CoreQueue.concurrent.stream { [self] work in
      guard let renderer = renderer as? SplatRenderer else {
        throw EngineError(.invalidArgument, "renderer: expected one of this engine, found another")
      }
      let searcher = try make_searcher(model, try SplatScene.ofCore(scene).core)
      try searcher.encode(renderer.core, cache?.path ?? "", work)
      let clusters = Set(searcher.encoded_clusters())
      var thumbnails: [ClusterID: RenderedImage] = [:]
      for cluster in clusters.sorted() {
        // A cluster that was encoded in another pose may not be seen in this one.
        thumbnails[cluster] = try? RenderedImage(try searcher.take_picture(cluster))
      }
      return SearchIndex(
        encodedClusters: clusters, thumbnails: thumbnails, storage: Index(searcher: searcher))
    }
  }

  public func search(_ text: String, in index: SearchIndex) async throws -> [SearchHit] {
    guard let index = index.storage as? Index else {
      throw EngineError(.invalidArgument, "index: expected one of this engine, found another")
    }
    return try await CoreQueue.concurrent.run {
      let hits = try index.searcher.search(text)
      return (0..<hits.count()).map { place in
        let hit = hits.hit(place)
        return SearchHit(cluster: hit.cluster, score: hit.score)
      }
    }
  }

  /// The core's data of a scene that was encoded.
  private struct Index: Sendable {
    let searcher: Searcher
  }
}
