import Foundation
import Observation

/// Text search: models, embeddings, live results.
@MainActor @Observable
public final class SearchModel {
  /// The pair of models.
  public enum Models: Equatable {
    case notLoaded
    case loading(ProgressStep)
    /// They are not where they should be; the core's own line names the files.
    case missing(String)
    case ready(name: String)
  }

  /// A match, as it is listed.
  public struct Result: Equatable, Identifiable {
    public var row: ClusterRow
    /// 0 to 1.
    public var score: Double
    public var thumbnail: RenderedImage?

    public var id: ClusterID { row.id }
  }

  public private(set) var models = Models.notLoaded
  /// How far the encoding is; `nil` when it is not going on.
  public private(set) var encoding: ProgressStep?
  /// Clusters that have an embedding; `nil` before the first encoding.
  public private(set) var encodedClusters: Set<ClusterID>?
  public var text = "" { didSet { if text != oldValue { textChanged() } } }
  public var settings = SearchSettings() { didSet { refresh() } }
  public private(set) var results: [Result] = []
  public private(set) var isSearching = false
  /// `nil` before models were loaded.
  private var modelThreshold: Double?

  @ObservationIgnored private let engine: any Engine
  @ObservationIgnored private let modelFolder: @MainActor () -> URL?
  @ObservationIgnored private let selection: SelectionModel
  @ObservationIgnored private let cache: URL
  @ObservationIgnored private let pause: @Sendable () async throws -> Void
  @ObservationIgnored private var searcher: (any SearchEngine)?
  @ObservationIgnored private var index: SearchIndex?
  @ObservationIgnored private var scene: (any SceneEngine)?
  @ObservationIgnored private var renderer: (any RenderEngine)?
  @ObservationIgnored private var hits: [SearchHit] = []
  @ObservationIgnored private var work: Task<Void, Never>?
  @ObservationIgnored private var query: Task<Void, Never>?
  @ObservationIgnored var didFail: @MainActor (any Error) -> Void = { _ in }

  /// `cache` is where embeddings are kept. `pause` is waited for before a text is searched, so that
  /// fast typing costs one search.
  public init(
    engine: any Engine, models: @escaping @MainActor () -> URL?, selection: SelectionModel,
    cache: URL = StandardFolders.caches.appending(path: "Embeddings"),
    pause: @escaping @Sendable () async throws -> Void = {
      try await Task.sleep(for: .milliseconds(150))
    }
  ) {
    self.engine = engine
    modelFolder = models
    self.selection = selection
    self.cache = cache
    self.pause = pause
  }

  /// Lowest score that counts as a match: a person's choice, else the models' own.
  public var lowestScore: Double {
    get { settings.threshold ?? modelThreshold ?? SearchSettings.thresholds.lowerBound }
    set { settings.threshold = newValue }
  }

  public var canEncode: Bool { scene != nil && encoding == nil && !selection.rows.isEmpty }
  public var isEncoded: Bool { index != nil }

  func start(with scene: any SceneEngine, renderer: any RenderEngine) {
    (self.scene, self.renderer) = (scene, renderer)
  }

  /// After an edit: embeddings of what is still there stay right, results that are gone go.
  func sceneChanged(to scene: any SceneEngine) {
    self.scene = scene
    refresh()
  }

  func close() {
    work?.cancel()
    query?.cancel()
    (scene, renderer, index, encodedClusters) = (nil, nil, nil, nil)
    hits = []
    results = []
    text = ""
    encoding = nil
    isSearching = false
  }

  // MARK: Encoding

  /// Loads the models if need be, looks at every cluster, and searches for what is in the field.
  public func encode() {
    guard canEncode, let scene, let renderer else { return }
    encoding = ProgressStep(.preparing)
    work = Task {
      do {
        let searcher = try await loadedSearcher()
        let index = try await searcher.encode(scene, renderer: renderer, cache: cache)
          .result { self.encoding = $0 }
        guard self.renderer === renderer else { return }
        self.index = index
        encodedClusters = index.encodedClusters
        encoding = nil
        search()
      } catch {
        // Closed meanwhile: the state belongs to another scene.
        guard self.renderer === renderer else { return }
        encoding = nil
        report(error)
      }
    }
  }

  public func cancelEncoding() { work?.cancel() }

  /// Waits for what is going on.
  public func settle() async {
    await work?.value
    await query?.value
  }

  private func loadedSearcher() async throws -> any SearchEngine {
    if let searcher { return searcher }
    guard let folder = modelFolder() else {
      throw EngineError(.modelsMissing, "models: expected a folder with a text and an image model")
    }
    models = .loading(ProgressStep(.reading))
    do {
      let loaded: any SearchEngine = try await engine.makeSearcher(models: folder)
        .result { self.models = .loading($0) }
      searcher = loaded
      modelThreshold = loaded.threshold
      models = .ready(name: loaded.modelName)
      return loaded
    } catch {
      models = .notLoaded
      throw error
    }
  }

  /// Models that are missing are a state with an explanation in its place, not an alert.
  private func report(_ error: any Error) {
    if let error = error as? EngineError, error.code == .modelsMissing {
      models = .missing(error.message)
    } else {
      didFail(error)
    }
  }

  // MARK: Searching

  private func textChanged() {
    query?.cancel()
    guard !text.trimmingCharacters(in: .whitespaces).isEmpty else {
      hits = []
      refresh()
      isSearching = false
      return
    }
    search(afterPause: true)
  }

  /// Searches at once: the Return key.
  public func search() { search(afterPause: false) }

  private func search(afterPause: Bool) {
    query?.cancel()
    let text = text.trimmingCharacters(in: .whitespaces)
    guard let searcher, let index, !text.isEmpty else { return }
    isSearching = true
    query = Task {
      do {
        if afterPause { try await pause() }
        let found = try await searcher.search(text, in: index)
        // An older question's answer may come late.
        try Task.checkCancellation()
        hits = found
        isSearching = false
        refresh()
      } catch {
        guard !Task.isCancelled else { return }
        isSearching = false
        report(error)
      }
    }
  }

  /// Applies scope, threshold and number to what was found; no new search.
  public func refresh() {
    let scope = scopedClusters
    results =
      hits
      .filter { scope.contains($0.cluster) && $0.score >= lowestScore }
      .prefix(settings.topK)
      .compactMap { hit in
        selection.row(hit.cluster).map {
          Result(row: $0, score: hit.score, thumbnail: index?.thumbnails[hit.cluster])
        }
      }
  }

  private var scopedClusters: Set<ClusterID> {
    switch settings.scope {
    case .all: selection.state.known
    case .visible: selection.state.visible
    case .chosen: selection.state.chosen
    }
  }

  /// Chooses everything that is listed.
  public func chooseResults() { selection.choose(Set(results.map(\.id))) }
}
