import Foundation

/// Text search over the clusters of scenes, with one pair of models.
public protocol SearchEngine: AnyObject, Sendable {
  /// Name of the models, e.g. `MobileCLIP2-S0`.
  var modelName: String { get }

  /// The least score of a match, as it was measured for these models: they differ widely.
  var threshold: Double { get }

  /// Looks at every cluster from several sides and keeps an embedding of each, in memory and in
  /// `cache`. Clusters that are in `cache` or beside the scene already are not looked at again. Draws
  /// on the device of `renderer`; what is on the screen plays no part.
  func encode(
    _ scene: any SceneEngine, renderer: any RenderEngine, cache: URL?
  ) -> ProgressStream<SearchIndex>

  /// Scores clusters against a text, best first, every cluster once.
  func search(_ text: String, in index: SearchIndex) async throws -> [SearchHit]
}

/// The embeddings of a scene's clusters: an opaque token of the engine that made it.
public struct SearchIndex: Sendable {
  /// Clusters that could be seen well enough to be embedded.
  public var encodedClusters: Set<ClusterID>
  /// A picture of each, where there is one.
  public var thumbnails: [ClusterID: RenderedImage]
  /// The engine's own data.
  public var storage: any Sendable

  public init(
    encodedClusters: Set<ClusterID>, thumbnails: [ClusterID: RenderedImage],
    storage: any Sendable
  ) {
    self.encodedClusters = encodedClusters
    self.thumbnails = thumbnails
    self.storage = storage
  }
}

/// A cluster that matches.
public struct SearchHit: Sendable, Equatable, Identifiable {
  public var cluster: ClusterID
  /// How well it matches, 0 to 1: the text's share against the model's background texts.
  public var score: Double

  public var id: ClusterID { cluster }

  public init(cluster: ClusterID, score: Double) {
    self.cluster = cluster
    self.score = score
  }
}
