import Observation

/// The list of objects, and what is done with them.
@MainActor @Observable
public final class SelectionModel {
  public private(set) var rows: [ClusterRow] = []
  public private(set) var state = ClusterSelection()

  public init() {}

  /// Rows that are chosen, in the list's order.
  public var chosenRows: [ClusterRow] { rows.filter { state.isChosen($0.id) } }
  public var chosenSplatCount: Int { chosenRows.reduce(0) { $0 + $1.splatCount } }
  public var hasChosen: Bool { !state.chosen.isEmpty }

  public func row(_ id: ClusterID) -> ClusterRow? { rows.first { $0.id == id } }

  public func pick(_ id: ClusterID?, extending: Bool) { state.pick(id, extending: extending) }
  public func choose(_ ids: Set<ClusterID>) { state.choose(ids) }
  public func chooseAll() { state.chooseAll() }
  public func clear() { state.clear() }
  public func isolateChosen() { state.isolateChosen() }
  public func hideChosen() { state.hideChosen() }
  public func showAll() { state.showAll() }

  public func setVisible(_ isVisible: Bool, _ id: ClusterID) { state.setVisible(isVisible, [id]) }

  /// Another scene, or the same after an edit.
  func update(rows: [ClusterRow], visibility: ClusterVisibility? = nil) {
    self.rows = rows
    state.update(known: Set(rows.map(\.id)), visibility: visibility)
  }
}
