import Foundation
import Observation

/// What the windows share: the engine, recent scenes, models, one training run, one capture.
@MainActor @Observable
public final class AppModel {
  public let engine: any Engine
  public let recents: RecentScenes
  public let training: TrainingModel
  public let capture: CaptureModel
  public let selfCheck: SelfCheckModel
  public let lifeCycle: LifeCycle
  /// The scene that comes with the app; `nil` in a build without it.
  public let sampleScene: URL?
  @ObservationIgnored private let settings: SettingsStore
  @ObservationIgnored private let trainingLifeCycle: TrainingLifeCycle

  /// Files that can be opened, by extension.
  public nonisolated static let sceneExtensions = ["ply", "spz", "splat", "sog"]

  public init(
    engine: any Engine, system: LifeCycle.System, sampleScene: URL?, bundledModels: URL? = nil,
    data: URL = StandardFolders.data,
    bookmarks: RecentScenes.Bookmarks = .system
  ) {
    self.engine = engine
    self.sampleScene = sampleScene
    settings = SettingsStore(folder: data.appending(path: "Scenes"))
    recents = RecentScenes(file: data.appending(path: "recents.json"), bookmarks: bookmarks)
    training = TrainingModel(engine: engine, runs: data.appending(path: "Training"))
    capture = CaptureModel()
    selfCheck = SelfCheckModel(engine: engine)
    lifeCycle = LifeCycle(system: system)
    modelFolder = data.appending(path: "Models")
    self.bundledModels = bundledModels
    trainingLifeCycle = TrainingLifeCycle(training)
    lifeCycle.add(trainingLifeCycle)
    lifeCycle.add(selfCheck)
  }

  /// Where a person puts the models for text search.
  public let modelFolder: URL
  /// The small ones that come with the app.
  @ObservationIgnored private let bundledModels: URL?

  /// A person's own models, else the app's; where they would be when there are neither.
  var models: URL {
    let own = try? FileManager.default.contentsOfDirectory(atPath: modelFolder.path)
    return own?.isEmpty == false ? modelFolder : bundledModels ?? modelFolder
  }

  /// The model of a new window.
  public func makeScene() -> SceneModel {
    let scene = SceneModel(
      engine: engine, settings: settings, recents: recents, models: { [weak self] in self?.models })
    lifeCycle.add(scene)
    return scene
  }

  /// Opens the sample in a window of somebody who has nothing else yet.
  public func openSampleOnFirstRun(in scene: SceneModel) {
    guard recents.entries.isEmpty, scene.phase == .empty, let sampleScene else { return }
    scene.open(sampleScene, isOwn: true)
  }

  public func open(_ entry: RecentScenes.Entry, in scene: SceneModel) {
    do {
      scene.open(try recents.resolve(entry))
    } catch {
      recents.remove(entry)
      scene.report(.opening, error)
    }
  }
}
