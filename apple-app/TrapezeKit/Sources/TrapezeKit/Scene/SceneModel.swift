import Foundation
import Observation

/// One open scene and everything that is done with it: the model behind a window.
@MainActor @Observable
public final class SceneModel {
  public enum Phase: Equatable {
    case empty
    case loading(ProgressStep)
    case ready
  }

  public private(set) var phase = Phase.empty
  public private(set) var name = ""
  /// An alert that waits to be read.
  public var failure: Failure?
  public private(set) var summary: SceneSummary?

  public let playback: PlaybackModel
  public let selection: SelectionModel
  public let viewer: ViewerModel
  public let edits = EditModel()
  public let search: SearchModel
  public let export = ExportModel()
  public let tuning = TuningModel()
  public let movie = MovieModel()

  @ObservationIgnored private let engine: any Engine
  @ObservationIgnored private let settings: SettingsStore
  @ObservationIgnored private let recents: RecentScenes?
  @ObservationIgnored private var access: FileAccess?
  @ObservationIgnored private var key: SceneKey?
  @ObservationIgnored private var opening: Task<Void, Never>?

  public init(
    engine: any Engine, settings: SettingsStore, recents: RecentScenes? = nil,
    models: @escaping @MainActor () -> URL?,
    now: @escaping PlaybackModel.Now = { ProcessInfo.processInfo.systemUptime }
  ) {
    self.engine = engine
    self.settings = settings
    self.recents = recents
    playback = PlaybackModel(now: now)
    selection = SelectionModel()
    viewer = ViewerModel(playback: playback, selection: selection)
    search = SearchModel(engine: engine, models: models, selection: selection)
    viewer.didFail = { [weak self] in self?.report(.drawing, $0) }
    edits.didFail = { [weak self] in self?.report(.editing, $0) }
    search.didFail = { [weak self] in self?.report(.searching, $0) }
    export.didFail = { [weak self] in self?.report(.exporting, $0) }
    tuning.didFail = { [weak self] in self?.report(.drawing, $0) }
  }

  func report(_ task: FailedTask, _ error: any Error) {
    if let failure = Failure(task, error) { self.failure = failure }
  }

  public var scene: (any SceneEngine)? { viewer.scene }

  // MARK: Opening and closing

  /// Opens a scene instead of the one that is open. `isOwn` for files of the app itself, which are
  /// not listed among the recent ones.
  public func open(_ url: URL, isOwn: Bool = false) {
    close()
    phase = .loading(ProgressStep(.reading))
    name = url.deletingPathExtension().lastPathComponent
    let access = FileAccess(url)
    self.access = access
    opening = Task {
      do {
        let scene: any SceneEngine = try await engine.open(url).result { self.phase = .loading($0) }
        try await show(scene)
        if !isOwn { recents?.add(url) }
      } catch {
        // Another scene may be on its way by now: what belongs to it stays.
        guard self.access === access else { return }
        self.access = nil
        phase = .empty
        report(.opening, error)
      }
    }
  }

  /// Shows a scene that is in memory already: the result of training.
  public func open(_ scene: any SceneEngine, name: String) {
    close()
    self.name = name
    phase = .loading(ProgressStep(.uploading))
    opening = Task {
      do { try await show(scene) } catch {
        guard !Task.isCancelled else { return }
        phase = .empty
        report(.opening, error)
      }
    }
  }

  /// Waits until what was opened is there, or is not going to be.
  public func settle() async { await opening?.value }

  public func cancelOpening() {
    guard case .loading = phase else { return }
    close()
  }

  private func show(_ scene: any SceneEngine) async throws {
    let key = SceneKey(name: name, summary: scene.summary)
    let kept = settings.load(key)
    let renderer: any RenderEngine =
      try await engine
      .makeRenderer(for: scene, options: kept.display.options)
      .result { self.phase = .loading($0) }
    try Task.checkCancellation()
    self.key = key
    summary = scene.summary
    restore(kept, for: scene)
    viewer.show(scene, on: renderer)
    if let pose = kept.pose {
      viewer.jump(to: pose)
    } else {
      viewer.setUp(UpAxis.guess(for: scene.summary))
      viewer.frameAll()
    }
    edits.start(with: scene) { [weak self] in try await self?.install($0) }
    search.start(with: scene, renderer: renderer)
    tuning.start(with: renderer, measurements: kept.measurements)
    phase = .ready
    if scene.summary.isDeformable { playback.play() }
  }

  private func restore(_ kept: SceneSettings, for scene: any SceneEngine) {
    var display = kept.display
    if kept == SceneSettings(), let recommended = scene.summary.recommendedStaticPercentile {
      display.staticPercentile = recommended
    }
    viewer.display = display
    playback.settings = kept.playback
    search.settings = kept.search
    selection.update(rows: scene.clusters, visibility: kept.visibility)
    if let bounds = scene.summary.framingBounds { viewer.setSceneRadius(bounds.radius) }
  }

  /// Puts the scene after an edit in place of the one before.
  private func install(_ scene: any SceneEngine) async throws {
    guard let renderer = viewer.renderer else { return }
    try await renderer.show(scene, options: viewer.display.options).result()
    summary = scene.summary
    selection.update(rows: scene.clusters)
    viewer.show(scene, on: renderer)
    await viewer.refreshChosenBounds()
    search.sceneChanged(to: scene)
  }

  /// Changes the arithmetic; the scene goes to the device again.
  public func setOptions(_ options: RendererOptions) async {
    guard let renderer = viewer.renderer, let scene, options != viewer.display.options else {
      return
    }
    do {
      try await renderer.show(scene, options: options).result()
      viewer.display.options = options
      viewer.show(scene, on: renderer)
    } catch {
      report(.drawing, error)
    }
  }

  /// Closes the scene and keeps its settings. The right to read its file ends here.
  public func close() {
    opening?.cancel()
    opening = nil
    saveSettings()
    search.close()
    edits.close()
    export.cancel()
    movie.cancel()
    tuning.close()
    viewer.close()
    selection.update(rows: [])
    playback.pause()
    playback.seek(to: 0)
    summary = nil
    key = nil
    access = nil
    phase = .empty
  }

  /// Writes the settings: when the scene is closed and when the app leaves the screen.
  public func saveSettings() {
    guard let key, scene != nil else { return }
    var kept = SceneSettings()
    kept.pose = viewer.camera.pose
    kept.display = viewer.display
    kept.playback = playback.settings
    kept.visibility = selection.state.visibility
    kept.search = search.settings
    kept.measurements = tuning.measurements
    // A full disk costs the settings, not the scene.
    try? settings.save(kept, for: key)
  }

  // MARK: Editing

  public func deleteChosen() async { await edit { .delete($0) } }
  public func keepChosen() async { await edit { .keep($0) } }

  private func edit(_ make: (Set<ClusterID>) -> SceneEdit) async {
    let chosen = selection.state.chosen
    guard !chosen.isEmpty else { return }
    await edits.apply(make(chosen))
  }

  /// Starts with the box around the scene.
  public func beginCrop() { viewer.cropBox = summary?.framingBounds }
  public func cancelCrop() { viewer.cropBox = nil }

  public func applyCrop() async {
    guard let box = viewer.cropBox else { return }
    viewer.cropBox = nil
    await edits.apply(.crop(box))
  }

  /// An empty name takes the name away.
  public func rename(_ id: ClusterID, to name: String) async {
    let trimmed = name.trimmingCharacters(in: .whitespacesAndNewlines)
    await edits.apply(.rename(id, trimmed.isEmpty ? nil : trimmed))
  }

  public func recolor(_ id: ClusterID, to color: RGBColor) async {
    await edits.apply(.recolor(id, color))
  }

  public func removeFloaters(sigmas: Double = 3) async {
    await edits.apply(.removeFloaters(sigmas: sigmas))
  }

  public func deleteFaint(below opacity: Double) async {
    await edits.apply(.deleteFaint(below: opacity))
  }
}
