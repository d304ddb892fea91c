import Foundation

@testable import TrapezeKit

/// A clock that stands still until it is moved.
@MainActor final class ManualClock {
  var now = 0.0
}

/// A folder that is gone with the test.
final class TemporaryFolder {
  let url: URL

  init() throws {
    url = FileManager.default.temporaryDirectory.appending(path: "trapeze-\(UUID().uuidString)")
    try FileManager.default.createDirectory(at: url, withIntermediateDirectories: true)
  }

  deinit { try? FileManager.default.removeItem(at: url) }
}

/// A window with a scene and a display link that is turned by hand.
@MainActor final class Window {
  let engine: TestEngine
  let clock = ManualClock()
  let folder: TemporaryFolder
  let scene: SceneModel
  private(set) var wakes = 0

  init(engine: TestEngine = TestEngine(), folder: TemporaryFolder? = nil) throws {
    self.engine = engine
    let folder = try folder ?? TemporaryFolder()
    self.folder = folder
    let clock = clock
    scene = SceneModel(
      engine: engine, settings: SettingsStore(folder: folder.url.appending(path: "Scenes")),
      recents: RecentScenes(file: folder.url.appending(path: "recents.json")),
      models: { folder.url }, now: { clock.now })
    scene.viewer.loop.onWake = { @MainActor [weak self] in
      guard let self else { return }
      wakes += 1
    }
  }

  var renderer: TestRenderer? { scene.viewer.renderer as? TestRenderer }
  var viewer: ViewerModel { scene.viewer }

  func open(_ name: String = "a.ply") async {
    viewer.resize(to: Viewport(width: 400, height: 300, scale: 2))
    scene.open(URL(filePath: "/\(name)"))
    await scene.settle()
  }

  /// One tick of the display link, and the frame that it asked for.
  @discardableResult
  func tick(_ seconds: Double = 1.0 / 60) async -> Bool {
    clock.now += seconds
    let goesOn = viewer.loop.tick(at: clock.now)
    await viewer.loop.settle()
    return goesOn
  }

  /// Ticks until the link may rest. Returns how many it took.
  func rest() async -> Int {
    var ticks = 0
    while await tick(), ticks < 1_000 { ticks += 1 }
    return ticks
  }

  func drawn() async -> [FrameRequest] { await renderer?.drawn ?? [] }

  /// Lets what was scheduled on the main actor happen.
  func yield() async { for _ in 0..<20 { await Task.yield() } }
}

extension OrbitPose {
  /// Where a point of the scene is in the window, in points.
  func location(of point: Vector3, in viewport: Viewport) -> SIMD2<Double>? {
    camera(in: viewport).project(point).map { SIMD2($0.x, $0.y) / viewport.scale }
  }
}
