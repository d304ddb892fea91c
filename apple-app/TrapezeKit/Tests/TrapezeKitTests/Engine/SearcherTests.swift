import Foundation
import Testing

@testable import TrapezeKit

@Suite struct SceneSearcherTests {
  /// What is looked for, and the name of the cluster that it means.
  private static let phrases = [
    ("red ball", "red ball"), ("green ball", "green ball"), ("blue and yellow box", "box"),
    ("checkered floor", "plate"),
  ]

  /// The model that comes with the app; `nil`, loudly, without ONNX Runtime.
  private func bundledModel() async throws -> (any SearchEngine)? {
    do {
      return try await Engines.cpu.makeSearcher(models: Repository.searchModel).result()
    } catch let error as EngineError
      where error.code == .modelsMissing && error.message.hasPrefix("ONNX Runtime")
    {
      print("SKIPPED: text search in the app's engine: \(error.message)")
      return nil
    }
  }

  private func renderer(of scene: any SceneEngine) async throws -> any RenderEngine {
    try await Engines.cpu.makeRenderer(for: scene, options: .init()).result()
  }

  @Test func phrasesFindTheirClustersAtOnceAndWhenTheSceneIsOpenedAgain() async throws {
    guard let model = try await bundledModel() else { return }
    #expect(model.modelName == "trapeze-objects" && model.threshold > 0 && model.threshold < 1)
    let folder = try TemporaryFolder()
    for isFirst in [true, false] {
      let scene = try await Engines.sampleScene()
      let renderer = try await renderer(of: scene)
      var fractions: [Double] = []
      let index = try await model.encode(scene, renderer: renderer, cache: folder.url)
        .result { if $0.stage == .encoding, let f = $0.fraction { fractions.append(f) } }
      #expect(fractions == fractions.sorted())
      #expect(fractions.contains { $0 > 0 } == isFirst, "the second time nothing is encoded")
      #expect(index.encodedClusters == Set(scene.clusters.map(\.id)))
      #expect(Set(index.thumbnails.keys) == index.encodedClusters)
      #expect(index.thumbnails.values.allSatisfy { $0.width == 144 && $0.height == 144 })
      let names = Dictionary(uniqueKeysWithValues: scene.clusters.map { ($0.id, $0.name ?? "") })
      for (phrase, name) in Self.phrases {
        let hits = try await model.search(phrase, in: index)
        #expect(hits.first.map { names[$0.cluster] } == name, "\(phrase)")
        #expect(Set(hits.map(\.cluster)) == index.encodedClusters && hits.count == names.count)
        #expect(hits.map(\.score) == hits.map(\.score).sorted(by: >))
      }
      let (ball, nonsense) = try await (
        model.search("red ball", in: index), model.search("zxqv wrtl", in: index)
      )
      #expect(try #require(ball.first).score >= model.threshold)
      #expect(try #require(nonsense.first).score < model.threshold)
    }
  }

  @Test func aCancelledEncodingStopsAndTheNextOneGoesOn() async throws {
    guard let model = try await bundledModel() else { return }
    let folder = try TemporaryFolder()
    let scene = try await Engines.sampleScene().applying([.keep([1, 3])]).result()
    let renderer = try await renderer(of: scene)
    let task = Task {
      for try await news in model.encode(scene, renderer: renderer, cache: folder.url) {
        guard case .step(let step) = news, step.stage == .encoding else { continue }
        if step.fraction ?? 0 > 0 { return true }
      }
      return false
    }
    // Leaving the stream is what cancels the work.
    #expect(try await task.value, "it had begun")
    var kept: [String] = []
    for _ in 0..<500 where kept.isEmpty {
      try await Task.sleep(for: .milliseconds(10))
      kept = try FileManager.default.contentsOfDirectory(atPath: folder.url.path)
    }
    #expect(kept.count == 1, "what was finished is kept")
    let index = try await model.encode(scene, renderer: renderer, cache: folder.url).result()
    #expect(index.encodedClusters == [1, 3])
    #expect(try await model.search("red ball", in: index).first?.cluster == 3)

    let waiting = Task {
      try await model.encode(scene, renderer: renderer, cache: nil).result().encodedClusters
    }
    waiting.cancel()
    await #expect(throws: CancellationError.self) { _ = try await waiting.value }
  }

  @Test func whatCannotBeSearchedIsRefused() async throws {
    guard let model = try await bundledModel() else { return }
    let scene = try await Engines.sampleScene().applying([.keep([4])]).result()
    let renderer = try await renderer(of: scene)
    let index = try await model.encode(scene, renderer: renderer, cache: nil).result()
    for text in ["", " \n", String(repeating: "ball ", count: 2_000)] {
      do {
        _ = try await model.search(text, in: index)
        Issue.record("\(text.count) characters were searched")
      } catch let error as EngineError {
        #expect(error.code == .invalidArgument && error.message.hasPrefix("text: "))
      }
    }
    let folder = try TemporaryFolder()
    let file = folder.url.appending(path: "bare.ply")
    _ = try await scene.export(to: file, as: .ply).result()
    let bare = try await Engines.cpu.open(file).result()
    do {
      _ = try await model.encode(bare, renderer: renderer, cache: nil).result()
      Issue.record("a scene without clusters was encoded")
    } catch let error as EngineError {
      #expect(error.code == .invalidArgument && error.message.contains("clusters"))
    }
  }

  /// The whole way of the search panel.
  @MainActor @Test func aPersonFindsTheRedBall() async throws {
    guard try await bundledModel() != nil else { return }
    let folder = try TemporaryFolder()
    let scene = try await Engines.sampleScene()
    let selection = SelectionModel()
    selection.update(rows: scene.clusters)
    let search = SearchModel(
      engine: Engines.cpu, models: { Repository.searchModel }, selection: selection,
      cache: folder.url, pause: {})
    search.start(with: scene, renderer: try await renderer(of: scene))
    search.encode()
    await search.settle()
    #expect(search.models == .ready(name: "trapeze-objects") && search.isEncoded)
    search.text = "red ball"
    await search.settle()
    #expect(search.results.first?.row.name == "red ball")
    #expect(search.results.first?.thumbnail?.width == 144)
    search.chooseResults()
    #expect(selection.state.chosen.contains(3))
  }
}
