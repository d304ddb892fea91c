import SwiftUI
import TrapezeKit

/// The menus of a Mac, and of an iPad with a keyboard.
public struct TrapezeCommands: Commands {
  @FocusedValue(\.openScene) private var scene

  public init() {}

  public var body: some Commands {
    CommandGroup(replacing: .undoRedo) {
      Button("Undo") { Task { await scene?.edits.undo() } }
        .keyboardShortcut("z", modifiers: .command)
        .disabled(scene?.edits.canUndo != true)
      Button("Redo") { Task { await scene?.edits.redo() } }
        .keyboardShortcut("z", modifiers: [.command, .shift])
        .disabled(scene?.edits.canRedo != true)
    }
    CommandGroup(after: .saveItem) {
      Button("Close scene") { scene?.close() }
        .keyboardShortcut("w", modifiers: [.command, .shift])
        .disabled(!isOpen)
    }
    CommandMenu("Playback") { playback }
    CommandMenu("Camera") { camera }
    CommandMenu("Objects") { objects }
  }

  private var isOpen: Bool { scene?.phase == .ready }

  @ViewBuilder private var playback: some View {
    Group {
      Button("Play or pause") { scene?.playback.toggle() }
        .keyboardShortcut("p", modifiers: .command)
      Button("Next frame") { scene?.playback.step(frames: 1) }
        .keyboardShortcut(.rightArrow, modifiers: .command)
      Button("Previous frame") { scene?.playback.step(frames: -1) }
        .keyboardShortcut(.leftArrow, modifiers: .command)
      Divider()
      ForEach(PlaybackClock.LoopMode.allCases) { mode in
        Button(mode.title) { scene?.playback.loopMode = mode }
      }
    }
    .disabled(!isOpen)
  }

  @ViewBuilder private var camera: some View {
    Group {
      ForEach(Array(ViewPreset.allCases.enumerated()), id: \.element) { index, preset in
        Button(preset.title) { scene?.viewer.look(from: preset) }
          .keyboardShortcut(
            KeyEquivalent(Character("\(index + 1)")), modifiers: .command)
      }
      Divider()
      Button("Show the whole scene") { scene?.viewer.frameAll() }
        .keyboardShortcut("0", modifiers: .command)
      Button("Zoom in") { scene?.perform(.zoomIn) }
        .keyboardShortcut("+", modifiers: .command)
      Button("Zoom out") { scene?.perform(.zoomOut) }
        .keyboardShortcut("-", modifiers: .command)
    }
    .disabled(!isOpen)
  }

  @ViewBuilder private var objects: some View {
    Group {
      Button("Select all") { scene?.selection.chooseAll() }
        .keyboardShortcut("a", modifiers: [.command, .shift])
      Button("Isolate") { scene?.selection.isolateChosen() }
        .keyboardShortcut("i", modifiers: .command)
      Button("Hide") { scene?.selection.hideChosen() }
        .keyboardShortcut("e", modifiers: .command)
      Button("Show all") { scene?.selection.showAll() }
        .keyboardShortcut("e", modifiers: [.command, .shift])
      Divider()
      Button("Delete selected") { Task { await scene?.deleteChosen() } }
        .keyboardShortcut(.delete, modifiers: .command)
    }
    .disabled(!isOpen)
  }
}
