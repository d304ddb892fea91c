/// Edits that were made, and those that were taken back.
public struct EditHistory: Sendable, Equatable, Codable {
  /// In the order in which they were made.
  public private(set) var done: [SceneEdit] = []
  /// The next to redo is last.
  public private(set) var undone: [SceneEdit] = []

  public init() {}

  public var canUndo: Bool { !done.isEmpty }
  public var canRedo: Bool { !undone.isEmpty }

  /// A new edit; what was taken back before cannot come again.
  public mutating func record(_ edit: SceneEdit) {
    done.append(edit)
    undone.removeAll()
  }

  @discardableResult
  public mutating func undo() -> SceneEdit? {
    guard let edit = done.popLast() else { return nil }
    undone.append(edit)
    return edit
  }

  @discardableResult
  public mutating func redo() -> SceneEdit? {
    guard let edit = undone.popLast() else { return nil }
    done.append(edit)
    return edit
  }
}
