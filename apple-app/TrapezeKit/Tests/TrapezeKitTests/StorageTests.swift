import Foundation
import Testing

@testable import TrapezeKit

@Suite struct FileAccessTests {
  final class Count: @unchecked Sendable {
    private let lock = NSLock()
    private var value = 0
    var current: Int { lock.withLock { value } }
    func add() { lock.withLock { value += 1 } }
  }

  @Test func theRightIsHeldForTheLifeOfTheObject() {
    let stops = Count()
    var access: FileAccess? = FileAccess(
      URL(filePath: "/a"), start: { _ in true }, stop: { _ in stops.add() })
    #expect(access?.url.path == "/a" && stops.current == 0)
    access = nil
    #expect(stops.current == 1)
  }

  @Test func aRightThatWasNotGivenIsNotGivenBack() {
    let stops = Count()
    _ = FileAccess(URL(filePath: "/a"), start: { _ in false }, stop: { _ in stops.add() })
    #expect(stops.current == 0)
  }
}

@Suite struct SceneSettingsTests {
  private let summary = SceneSummary(
    splatCount: 5, harmonicsDegree: 1, framingBounds: nil, isDeformable: false, hasMotion: false,
    recommendedStaticPercentile: nil, memoryBytes: 280, warnings: [])

  @Test func everySettingSurvivesTheFile() throws {
    let folder = try TemporaryFolder()
    let store = SettingsStore(folder: folder.url)
    var settings = SceneSettings()
    settings.pose = OrbitPose(target: Vector3(1, 2, 3), distance: 4, azimuth: 0.5, elevation: 0.1)
    settings.display.mode = .clusters
    settings.display.options = RendererOptions(precision: .half, maxHarmonicsDegree: 1)
    settings.display.masksStatic = true
    settings.display.staticPercentile = 33
    settings.display.showsStats = true
    settings.display.background = RGBColor(red: 0.1, green: 0.2, blue: 0.3)
    settings.playback.loopMode = .once
    settings.visibility = .isolate([1, 99, 4_000_000_000])
    settings.search.scope = .visible
    settings.search.threshold = 0.25
    settings.measurements = [
      VariantMeasurement(
        variant: FrameVariant(precision: .half, staticPercentile: 50), frameMilliseconds: 3,
        psnr: nil)
    ]
    let key = SceneKey(name: "a", summary: summary)
    try store.save(settings, for: key)
    #expect(store.load(key) == settings)
    #expect(store.load(SceneKey(name: "b", summary: summary)) == SceneSettings())
  }

  @Test func unknownAndBrokenFieldsCostOnlyThemselves() throws {
    let json = """
      {"display": {"mode": "hologram", "masksStatic": true, "staticPercentile": 900},
       "search": {"topK": -4}, "playback": 7, "future": [1]}
      """
    let settings = try JSONDecoder().decode(SceneSettings.self, from: Data(json.utf8))
    #expect(settings.display.mode == .color && settings.display.masksStatic)
    #expect(settings.display.staticPercentile == 100 && settings.search.topK == 1)
    #expect(settings.playback == PlaybackSettings())
  }

  @Test func aFileOfRubbishIsNoSettings() throws {
    let folder = try TemporaryFolder()
    let key = SceneKey(name: "a", summary: summary)
    try Data("{".utf8).write(to: folder.url.appending(path: "\(key.fingerprint).json"))
    #expect(SettingsStore(folder: folder.url).load(key) == SceneSettings())
  }

  @Test func keysAreTheSameInEveryProcess() {
    // FNV-1a of "a|5|1|280", computed apart.
    #expect(SceneKey(name: "a", summary: summary).fingerprint == "387fd54ea9d4c2a2")
  }
}

@MainActor @Suite struct RecentScenesTests {
  private func recents(_ folder: TemporaryFolder) -> RecentScenes {
    RecentScenes(file: folder.url.appending(path: "recents.json"))
  }

  @Test func theNewestIsFirstAndEachIsThereOnce() throws {
    let folder = try TemporaryFolder()
    let model = recents(folder)
    for name in ["a.ply", "b.spz", "a.ply"] { model.add(URL(filePath: "/x/\(name)")) }
    #expect(model.entries.map(\.name) == ["a.ply", "b.spz"])
    #expect(recents(folder).entries == model.entries)
    #expect(try model.resolve(model.entries[1]).path == "/x/b.spz")
    model.remove(model.entries[0])
    #expect(model.entries.map(\.name) == ["b.spz"])
    model.clear()
    #expect(recents(folder).entries.isEmpty)
  }

  @Test func theListHasAnEnd() throws {
    let model = recents(try TemporaryFolder())
    for number in 0..<50 { model.add(URL(filePath: "/x/\(number).ply")) }
    #expect(model.entries.count == RecentScenes.capacity && model.entries[0].name == "49.ply")
  }

  @Test func aSceneThatIsGoneIsSaidToBe() throws {
    struct Gone: Error {}
    let folder = try TemporaryFolder()
    let model = RecentScenes(
      file: folder.url.appending(path: "r.json"),
      bookmarks: .init(make: { Data($0.path.utf8) }, resolve: { _ in throw Gone() }))
    model.add(URL(filePath: "/x/a.ply"))
    #expect(throws: EngineError(.unreadableFile, "a.ply: moved or deleted")) {
      try model.resolve(model.entries[0])
    }
  }
}

@MainActor @Suite struct AppModelTests {
  @Test func onesOwnModelsComeBeforeTheBundledOnes() throws {
    let folder = try TemporaryFolder()
    let bundled = URL(filePath: "/bundled")
    let app = AppModel(
      engine: TestEngine(),
      system: .init(
        beginBackgroundTask: { 0 }, endBackgroundTask: { _ in }, setIdleSleep: { _ in }),
      sampleScene: nil, bundledModels: bundled, data: folder.url)
    #expect(app.models == bundled)
    try FileManager.default.createDirectory(
      at: app.modelFolder, withIntermediateDirectories: true)
    #expect(app.models == bundled)
    try Data().write(to: app.modelFolder.appending(path: "model.json"))
    #expect(app.models == app.modelFolder)
  }

  private func app(_ folder: TemporaryFolder) -> AppModel {
    AppModel(
      engine: TestEngine(),
      system: .init(
        beginBackgroundTask: { 0 }, endBackgroundTask: { _ in }, setIdleSleep: { _ in }),
      sampleScene: URL(filePath: "/sample-scene"), data: folder.url)
  }

  @Test func somebodyNewSeesTheSampleAndItIsNotListed() async throws {
    let folder = try TemporaryFolder()
    let app = app(folder)
    let scene = app.makeScene()
    app.openSampleOnFirstRun(in: scene)
    await scene.settle()
    #expect(scene.name == "sample-scene" && app.recents.entries.isEmpty)
    scene.open(URL(filePath: "/mine.ply"))
    await scene.settle()
    #expect(app.recents.entries.map(\.name) == ["mine.ply"])
    let second = app.makeScene()
    app.openSampleOnFirstRun(in: second)
    #expect(second.phase == .empty)
    app.open(app.recents.entries[0], in: second)
    await second.settle()
    #expect(second.name == "mine")
  }
}
