import Observation

/// Edits of the scene, with undo and redo.
///
/// A scene never changes: every state is made from the scene as it was opened and the edits in
/// order, so undoing is making the state before, and nothing that was deleted has to be kept.
@MainActor @Observable
public final class EditModel {
  public private(set) var history = EditHistory()
  /// How far the edit is that is being made; `nil` when none is.
  public private(set) var progress: ProgressStep?
  public var isEditing: Bool { progress != nil }
  public var canUndo: Bool { history.canUndo && !isEditing }
  public var canRedo: Bool { history.canRedo && !isEditing }
  public var hasChanges: Bool { history.canUndo }

  @ObservationIgnored private var original: (any SceneEngine)?
  @ObservationIgnored private var current: (any SceneEngine)?
  @ObservationIgnored private var install: (any SceneEngine) async throws -> Void = { _ in }
  @ObservationIgnored var didFail: @MainActor (any Error) -> Void = { _ in }

  public init() {}

  func start(
    with scene: any SceneEngine,
    install: @escaping @MainActor (any SceneEngine) async throws -> Void
  ) {
    (original, current) = (scene, scene)
    self.install = install
    history = EditHistory()
  }

  func close() {
    (original, current) = (nil, nil)
    history = EditHistory()
  }

  /// Makes an edit. When it fails the scene and the history stay as they were.
  public func apply(_ edit: SceneEdit) async {
    guard let current else { return }
    await become(after: { $0.record(edit) }, from: current, edits: [edit])
  }

  public func undo() async {
    guard canUndo, let original else { return }
    await become(after: { $0.undo() }, from: original, edits: Array(history.done.dropLast()))
  }

  public func redo() async {
    guard canRedo, let current, let edit = history.undone.last else { return }
    await become(after: { $0.redo() }, from: current, edits: [edit])
  }

  private func become(
    after change: (inout EditHistory) -> Void, from base: any SceneEngine, edits: [SceneEdit]
  ) async {
    guard !isEditing else { return }
    let original = original
    progress = ProgressStep(.preparing)
    defer { progress = nil }
    do {
      let scene: any SceneEngine =
        edits.isEmpty
        ? base : try await base.applying(edits).result { self.progress = $0 }
      // Closed meanwhile, and perhaps another one opened: this one belongs nowhere.
      guard let original, self.original === original else { return }
      try await install(scene)
      current = scene
      change(&history)
    } catch {
      didFail(error)
    }
  }
}
