/// Which clusters are chosen and which are shown. Any number of either.
public struct ClusterSelection: Sendable, Equatable {
  /// What the scene has.
  public private(set) var known: Set<ClusterID>
  public private(set) var chosen: Set<ClusterID> = []
  public private(set) var visibility = ClusterVisibility.all

  public init(known: Set<ClusterID> = []) {
    self.known = known
  }

  public func isChosen(_ id: ClusterID) -> Bool { chosen.contains(id) }

  public func isVisible(_ id: ClusterID) -> Bool {
    switch visibility {
    case .all: true
    case .isolate(let shown): shown.contains(id)
    case .hide(let hidden): !hidden.contains(id)
    }
  }

  public var visible: Set<ClusterID> { known.filter(isVisible) }

  /// A tap or click on a cluster, or on none. `extending` adds to what is chosen, or takes from it:
  /// every tap with a finger, and clicks with Shift or Command.
  public mutating func pick(_ id: ClusterID?, extending: Bool) {
    guard let id, known.contains(id) else {
      if !extending { chosen = [] }
      return
    }
    if extending {
      chosen.formSymmetricDifference([id])
    } else {
      chosen = [id]
    }
  }

  public mutating func choose(_ ids: Set<ClusterID>) { chosen = ids.intersection(known) }

  public mutating func chooseAll() { chosen = visible }

  public mutating func clear() { chosen = [] }

  /// Shows what is chosen and nothing else.
  public mutating func isolateChosen() {
    guard !chosen.isEmpty else { return }
    visibility = .isolate(chosen)
  }

  /// Hides what is chosen; what was hidden stays so. Nothing is chosen afterwards.
  public mutating func hideChosen() {
    setVisible(false, chosen)
    chosen = []
  }

  public mutating func showAll() { visibility = .all }

  public mutating func setVisible(_ isVisible: Bool, _ ids: Set<ClusterID>) {
    let ids = ids.intersection(known)
    guard !ids.isEmpty else { return }
    switch visibility {
    case .all:
      if !isVisible { visibility = .hide(ids) }
    case .hide(let hidden):
      let left = isVisible ? hidden.subtracting(ids) : hidden.union(ids)
      visibility = left.isEmpty ? .all : .hide(left)
    case .isolate(let shown):
      let left = isVisible ? shown.union(ids) : shown.subtracting(ids)
      visibility = left == known ? .all : .isolate(left)
    }
  }

  /// After an edit, or for restored settings: what is gone is neither chosen nor hidden.
  public mutating func update(known: Set<ClusterID>, visibility restored: ClusterVisibility? = nil)
  {
    self.known = known
    chosen.formIntersection(known)
    switch restored ?? visibility {
    case .all: visibility = .all
    case .hide(let hidden):
      let left = hidden.intersection(known)
      visibility = left.isEmpty ? .all : .hide(left)
    case .isolate(let shown):
      let left = shown.intersection(known)
      // With all that was isolated deleted, an empty picture would look like a fault.
      visibility = left.isEmpty ? .all : .isolate(left)
    }
  }
}
