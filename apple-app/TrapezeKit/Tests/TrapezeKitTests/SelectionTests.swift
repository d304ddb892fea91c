import Testing

@testable import TrapezeKit

@Suite struct ClusterSelectionTests {
  private let known: Set<ClusterID> = Set(0..<300)

  @Test func tapsWithAFingerAddAndTakeAway() {
    var selection = ClusterSelection(known: known)
    // More than the 64 of the original app.
    for id in known { selection.pick(id, extending: true) }
    #expect(selection.chosen == known)
    selection.pick(7, extending: true)
    #expect(!selection.isChosen(7))
    selection.pick(nil, extending: true)
    #expect(selection.chosen.count == 299)
  }

  @Test func aClickReplacesAndAClickBesideClears() {
    var selection = ClusterSelection(known: known)
    selection.pick(1, extending: false)
    selection.pick(2, extending: false)
    #expect(selection.chosen == [2])
    selection.pick(nil, extending: false)
    #expect(selection.chosen.isEmpty)
    selection.pick(5_000, extending: false)
    #expect(selection.chosen.isEmpty)
  }

  @Test func isolateHideAndShowAll() {
    var selection = ClusterSelection(known: known)
    selection.choose([1, 2])
    selection.isolateChosen()
    #expect(selection.visible == [1, 2])
    selection.choose([2])
    selection.hideChosen()
    #expect(selection.visible == [1] && selection.chosen.isEmpty)
    selection.showAll()
    #expect(selection.visibility == .all)
    selection.choose([4])
    selection.hideChosen()
    selection.choose([5])
    selection.hideChosen()
    #expect(selection.visibility == .hide([4, 5]))
    selection.setVisible(true, [4, 5])
    #expect(selection.visibility == .all)
  }

  @Test func isolatingNothingChangesNothing() {
    var selection = ClusterSelection(known: known)
    selection.isolateChosen()
    selection.hideChosen()
    #expect(selection.visibility == .all)
  }

  @Test func visibilityAgreesWithASetWhateverIsDone() {
    var random = RandomNumbers(seed: 20)
    var selection = ClusterSelection(known: known)
    var model = known
    for _ in 0..<3_000 {
      let ids = Set((0..<3).map { _ in ClusterID.random(in: 0..<300, using: &random) })
      switch Int.random(in: 0..<5, using: &random) {
      case 0: selection.setVisible(false, ids); model.subtract(ids)
      case 1: selection.setVisible(true, ids); model.formUnion(ids)
      case 2: selection.choose(ids); selection.hideChosen(); model.subtract(ids)
      case 3:
        if Bool.random(using: &random) {
          selection.choose(ids)
          selection.isolateChosen()
          model = ids
        }
      default:
        if Int.random(in: 0..<20, using: &random) == 0 { selection.showAll(); model = known }
      }
      #expect(selection.visible == model)
    }
  }

  @Test func anEditLeavesNoPhantoms() {
    var selection = ClusterSelection(known: known)
    selection.choose([1, 2])
    selection.isolateChosen()
    selection.update(known: [2, 3])
    #expect(selection.chosen == [2] && selection.visible == [2])
    selection.update(known: [3])
    #expect(selection.visibility == .all)
  }
}

@Suite struct EditHistoryTests {
  @Test func undoAndRedoMirrorEachOther() {
    var history = EditHistory()
    #expect(!history.canUndo && !history.canRedo && history.undo() == nil && history.redo() == nil)
    let edits: [SceneEdit] = [.delete([1]), .rename(2, "x"), .removeFloaters(sigmas: 3)]
    edits.forEach { history.record($0) }
    #expect(history.undo() == edits[2])
    #expect(history.undo() == edits[1])
    #expect(history.done == [edits[0]])
    #expect(history.redo() == edits[1])
    history.record(.keep([9]))
    #expect(!history.canRedo)
    #expect(history.done == [edits[0], edits[1], .keep([9])])
  }
}
