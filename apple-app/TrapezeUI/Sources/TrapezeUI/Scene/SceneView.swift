import SwiftUI
import TrapezeKit

/// An open scene: the picture, the controls over it, the panels beside it.
struct SceneView: View {
  let app: AppModel
  let scene: SceneModel
  @State private var showsPanels = false
  @State private var panel = Panel.objects

  /// The panels beside the picture.
  enum Panel: String, CaseIterable, Identifiable {
    case objects, search, edit, display, export
    var id: Self { self }
  }

  var body: some View {
    ZStack(alignment: .bottom) {
      MetalView(scene: scene).ignoresSafeArea()
      OutlineOverlay(viewer: scene.viewer).ignoresSafeArea()
      VStack {
        if scene.viewer.display.showsStats {
          HStack {
            StatsOverlay(viewer: scene.viewer)
            Spacer()
          }
        }
        Spacer()
        if scene.summary?.isDeformable == true {
          PlaybackBar(playback: scene.playback).frame(maxWidth: 720)
        }
      }
      .padding()
    }
    .sensors(for: scene.viewer.parallax)
    .navigationTitle(Text(verbatim: scene.name))
    .toolbar { toolbar }
    .inspector(isPresented: $showsPanels) {
      panels.inspectorColumnWidth(min: 260, ideal: 320, max: 480)
    }
    .onChange(of: scene.selection.state.chosen) {
      Task { await scene.viewer.refreshChosenBounds() }
    }
    .onChange(of: scene.viewer.restingTime) {
      Task { await scene.viewer.refreshChosenBounds() }
    }
  }

  @ToolbarContentBuilder private var toolbar: some ToolbarContent {
    ToolbarItem(placement: .cancellationAction) {
      Button("Close scene", systemImage: "xmark") { scene.close() }
    }
    ToolbarItemGroup(placement: .primaryAction) {
      Button("Undo", systemImage: "arrow.uturn.backward") { Task { await scene.edits.undo() } }
        .disabled(!scene.edits.canUndo)
      Button("Redo", systemImage: "arrow.uturn.forward") { Task { await scene.edits.redo() } }
        .disabled(!scene.edits.canRedo)
      Button("Show the whole scene", systemImage: "viewfinder") { scene.viewer.frameAll() }
      Button("Panels", systemImage: "sidebar.trailing") { showsPanels.toggle() }
    }
  }

  private var panels: some View {
    VStack(spacing: 0) {
      Picker("Panel", selection: $panel) {
        ForEach(Panel.allCases) { panel in
          Label(panel.title, systemImage: panel.symbol).labelStyle(.iconOnly).tag(panel)
        }
      }
      .pickerStyle(.segmented)
      .labelsHidden()
      .padding(8)
      switch panel {
      case .objects: ObjectsPanel(scene: scene)
      case .search:
        SearchPanel(search: scene.search, scene: scene, modelFolder: app.modelFolder)
      case .edit: EditPanel(scene: scene)
      case .display: DisplayPanel(viewer: scene.viewer, scene: scene)
      case .export: ExportPanel(scene: scene)
      }
    }
  }
}

extension SceneView.Panel {
  var title: LocalizedStringKey {
    switch self {
    case .objects: "Objects"
    case .search: "Search"
    case .edit: "Edit"
    case .display: "Display"
    case .export: "Export"
    }
  }

  var symbol: String {
    switch self {
    case .objects: "square.3.layers.3d"
    case .search: "magnifyingglass"
    case .edit: "scissors"
    case .display: "slider.horizontal.3"
    case .export: "square.and.arrow.up"
    }
  }
}
