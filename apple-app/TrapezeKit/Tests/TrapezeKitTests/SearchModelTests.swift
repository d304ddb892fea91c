import Foundation
import Testing

@testable import TrapezeKit

@MainActor @Suite struct SearchModelTests {
  private func encoded() async throws -> Window {
    let window = try Window()
    await window.open()
    window.scene.search.encode()
    await window.scene.search.settle()
    return window
  }

  @Test func encodingLoadsTheModelsAndTellsProgress() async throws {
    let window = try Window()
    await window.open()
    let search = window.scene.search
    #expect(search.canEncode && search.models == .notLoaded)
    await window.engine.gate.close()
    search.encode()
    await window.yield()
    #expect(search.encoding != nil && !search.canEncode)
    await window.engine.gate.open()
    await search.settle()
    #expect(search.models == .ready(name: "letters"))
    #expect(search.encodedClusters == [3, 70] && search.encoding == nil)
  }

  @Test func resultsFollowTheTextTheThresholdAndTheNumber() async throws {
    let window = try await encoded()
    let search = window.scene.search
    #expect(search.lowestScore == 0.75, "the models' own")
    search.lowestScore = 0.5
    #expect(search.settings.threshold == 0.5)
    search.text = "red"
    await search.settle()
    #expect(search.results.map(\.id) == [3])
    #expect(search.results.first?.score == 1 && search.results.first?.thumbnail != nil)
    search.settings.threshold = 0
    #expect(search.results.map(\.id) == [3, 70])
    search.settings.topK = 1
    #expect(search.results.map(\.id) == [3])
    search.chooseResults()
    #expect(window.scene.selection.state.chosen == [3])
    search.text = " "
    #expect(search.results.isEmpty && !search.isSearching)
  }

  @Test func scopeLimitsWhatIsFound() async throws {
    let window = try await encoded()
    let search = window.scene.search
    search.settings.threshold = 0
    search.text = "red"
    await search.settle()
    window.scene.selection.setVisible(false, 3)
    search.settings.scope = .visible
    #expect(search.results.map(\.id) == [70])
    search.settings.scope = .chosen
    #expect(search.results.isEmpty)
    search.settings.scope = .all
    #expect(search.results.count == 2)
  }

  @Test func onlyTheLastTextIsAnswered() async throws {
    let window = try await encoded()
    let search = window.scene.search
    search.settings.threshold = 0.9
    await window.engine.gate.close()
    search.text = "zzz"
    search.search()
    await window.yield()
    search.text = "red ball"
    await window.engine.gate.open()
    await search.settle()
    #expect(search.results.map(\.id) == [3])
  }

  @Test func missingModelsAreExplainedInTheirPlace() async throws {
    let window = try Window()
    window.engine.modelsAreThere = false
    await window.open()
    window.scene.search.encode()
    await window.scene.search.settle()
    #expect(
      window.scene.search.models == .missing("models: expected text.onnx, found none"))
    #expect(window.scene.failure == nil)
    window.engine.modelsAreThere = true
    window.scene.search.encode()
    await window.scene.search.settle()
    #expect(window.scene.search.isEncoded)
  }

  @Test func encodingCanBeCancelled() async throws {
    let window = try Window()
    await window.open()
    await window.engine.gate.close()
    window.scene.search.encode()
    await window.yield()
    window.scene.search.cancelEncoding()
    await window.scene.search.settle()
    #expect(window.scene.search.encoding == nil && !window.scene.search.isEncoded)
    #expect(window.scene.failure == nil)
    await window.engine.gate.open()
  }

  @Test func deletedClustersLeaveTheResults() async throws {
    let window = try await encoded()
    let search = window.scene.search
    search.settings.threshold = 0
    search.text = "red"
    await search.settle()
    window.scene.selection.choose([3])
    await window.scene.deleteChosen()
    #expect(search.results.map(\.id) == [70])
    await window.scene.edits.undo()
    #expect(search.results.map(\.id) == [3, 70])
  }

  @Test func settingsStayInTheirRanges() {
    var settings = SearchSettings()
    settings.topK = 0
    settings.threshold = 7
    #expect(settings.topK == 1 && settings.threshold == 1)
  }
}
