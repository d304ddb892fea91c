import SwiftUI
import TrapezeKit

/// The scene's objects: choose, isolate, hide, show, rename, colour, delete.
struct ObjectsPanel: View {
  let scene: SceneModel
  @State private var renamed: ClusterRow?
  @State private var newName = ""

  private var selection: SelectionModel { scene.selection }

  var body: some View {
    List {
      if selection.rows.isEmpty {
        ContentUnavailableView(
          "No objects", systemImage: "square.dashed",
          description: Text("This scene has no object labels."))
      } else {
        Section { actions }
        Section("Objects") {
          ForEach(selection.rows) { row in
            ObjectRow(scene: scene, row: row) {
              newName = row.name ?? ""
              renamed = row
            }
          }
        }
      }
    }
    .alert(
      "Rename", isPresented: Binding(get: { renamed != nil }, set: { if !$0 { renamed = nil } }),
      presenting: renamed
    ) { row in
      TextField("Name", text: $newName)
      Button("Rename") { Task { await scene.rename(row.id, to: newName) } }
      Button("Cancel", role: .cancel) {}
    }
  }

  @ViewBuilder private var actions: some View {
    LabeledContent("Selected") {
      Text(verbatim: "\(selection.state.chosen.count) / \(selection.rows.count)")
    }
    LabeledContent("Splats") { Text(verbatim: Figures.count(selection.chosenSplatCount)) }
    Group {
      Button("Isolate", systemImage: "scope") { selection.isolateChosen() }
      Button("Hide", systemImage: "eye.slash") { selection.hideChosen() }
      Button("Focus", systemImage: "viewfinder") {
        let chosen = selection.state.chosen
        Task { await scene.viewer.focus(on: chosen) }
      }
      Button("Deselect", systemImage: "xmark") { selection.clear() }
    }
    .disabled(!selection.hasChosen)
    Button("Select all", systemImage: "checkmark.circle") { selection.chooseAll() }
    Button("Show all", systemImage: "eye") { selection.showAll() }
      .disabled(selection.state.visibility == .all)
  }
}

/// One object.
private struct ObjectRow: View {
  let scene: SceneModel
  let row: ClusterRow
  let rename: @MainActor () -> Void

  private var isChosen: Bool { scene.selection.state.isChosen(row.id) }
  private var isVisible: Bool { scene.selection.state.isVisible(row.id) }

  var body: some View {
    HStack {
      ColorPicker("Colour of the object", selection: color, supportsOpacity: false).labelsHidden()
      Button {
        scene.selection.pick(row.id, extending: true)
      } label: {
        HStack {
          ObjectName(row: row)
          Spacer()
          Text(verbatim: Figures.count(row.splatCount)).foregroundStyle(.secondary)
          Image(systemName: isChosen ? "checkmark.circle.fill" : "circle")
        }
      }
      .buttonStyle(.plain)
      .accessibilityAddTraits(isChosen ? .isSelected : [])
      Button {
        scene.selection.setVisible(!isVisible, row.id)
      } label: {
        isVisible
          ? Label("Hide", systemImage: "eye") : Label("Show", systemImage: "eye.slash")
      }
      .labelStyle(.iconOnly)
      .buttonStyle(.borderless)
    }
    .contextMenu {
      Button("Rename…", action: rename)
      Button("Focus") { Task { await scene.viewer.focus(on: [row.id]) } }
      Button("Delete", role: .destructive) {
        Task { await scene.edits.apply(.delete([row.id])) }
      }
    }
  }

  private var color: Binding<Color> {
    Binding(
      get: { Color(row.color) },
      set: { color in Task { await scene.recolor(row.id, to: color.components) } })
  }
}

/// The name of an object, or its number where nobody has given it one.
struct ObjectName: View {
  let row: ClusterRow

  var body: some View {
    if let name = row.name {
      Text(verbatim: name)
    } else {
      Text("Object \(String(row.id))")
    }
  }
}
