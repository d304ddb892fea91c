/// Keys without modifiers while the scene has the focus. Menus have the ones with Command.
public enum KeyCommand: Sendable, Equatable, CaseIterable {
  case playPause, stepBackward, stepForward
  case left, right, up, down
  case zoomIn, zoomOut
  case front, back, leftSide, rightSide, top, bottom
  case frameAll, focusChosen, isolate, hide, showAll, clear, recenter

  /// By what the key writes; arrows are named.
  public enum Key: Sendable, Equatable {
    case character(Character)
    case leftArrow, rightArrow, upArrow, downArrow, escape
  }

  public init?(_ key: Key) {
    switch key {
    case .leftArrow: self = .left
    case .rightArrow: self = .right
    case .upArrow: self = .up
    case .downArrow: self = .down
    case .escape: self = .clear
    case .character(let character):
      guard let command = Self.characters[character] else { return nil }
      self = command
    }
  }

  private static let characters: [Character: KeyCommand] = [
    " ": .playPause, ",": .stepBackward, ".": .stepForward, "+": .zoomIn, "=": .zoomIn,
    "-": .zoomOut, "1": .front, "2": .back, "3": .leftSide, "4": .rightSide, "5": .top,
    "6": .bottom, "a": .frameAll, "f": .focusChosen, "i": .isolate, "h": .hide, "s": .showAll,
    "r": .recenter,
  ]
}

extension SceneModel {
  /// Points of a drag, and radians of parallax, that an arrow key stands for.
  static let keyPoints = 20.0
  static let keyRadians = 0.05
  static let keyZoom = 1.15

  public func perform(_ command: KeyCommand) {
    guard phase == .ready else { return }
    switch command {
    case .playPause: playback.toggle()
    case .stepBackward: playback.step(frames: -1)
    case .stepForward: playback.step(frames: 1)
    case .left: move(-1, 0)
    case .right: move(1, 0)
    case .up: move(0, 1)
    case .down: move(0, -1)
    case .zoomIn: viewer.zoom(by: Self.keyZoom)
    case .zoomOut: viewer.zoom(by: 1 / Self.keyZoom)
    case .front: viewer.look(from: .front)
    case .back: viewer.look(from: .back)
    case .leftSide: viewer.look(from: .left)
    case .rightSide: viewer.look(from: .right)
    case .top: viewer.look(from: .top)
    case .bottom: viewer.look(from: .bottom)
    case .frameAll: viewer.frameAll()
    case .focusChosen:
      let chosen = selection.state.chosen
      Task { await viewer.focus(on: chosen) }
    case .isolate: selection.isolateChosen()
    case .hide: selection.hideChosen()
    case .showAll: selection.showAll()
    case .clear: selection.clear()
    case .recenter: viewer.parallax.recenter()
    }
  }

  /// Arrows turn the eye around the scene; with fake depth by a head that no camera follows they
  /// stand in for the head, as in the original app.
  private func move(_ x: Double, _ y: Double) {
    if viewer.parallax.source == .off {
      viewer.orbit(by: SIMD2(-x, y) * Self.keyPoints)
    } else {
      viewer.parallax.nudge(horizontal: x * Self.keyRadians, vertical: y * Self.keyRadians)
    }
  }
}
