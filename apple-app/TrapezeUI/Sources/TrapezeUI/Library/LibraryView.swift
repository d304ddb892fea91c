import SwiftUI
import TrapezeKit
import UniformTypeIdentifiers

/// What there is to do when no scene is open.
struct LibraryView: View {
  let app: AppModel
  let scene: SceneModel
  @State private var isChoosing = false
  @State private var chosenTypes: [UTType] = SceneFileTypes.files
  @State private var sheet: Sheet?

  enum Sheet: String, Identifiable {
    case training, capture, selfCheck
    var id: Self { self }
  }

  var body: some View {
    List {
      Section("Scenes") {
        Button("Open file…", systemImage: "doc") { choose(SceneFileTypes.files) }
        Button("Open folder…", systemImage: "folder") { choose([.folder]) }
        if let sample = app.sampleScene {
          Button("Sample scene", systemImage: "sparkles") { scene.open(sample, isOwn: true) }
        }
      }
      if !app.recents.entries.isEmpty { recents }
      Section("Make a scene") {
        #if canImport(UIKit)
          Button("Capture with the camera", systemImage: "camera.viewfinder") { sheet = .capture }
        #endif
        Button("Train from photographs", systemImage: "photo.stack") { sheet = .training }
      }
      Section("This device") {
        Button("Self-check", systemImage: "checkmark.seal") { sheet = .selfCheck }
      }
    }
    .navigationTitle("Trapeze")
    .fileImporter(isPresented: $isChoosing, allowedContentTypes: chosenTypes) { result in
      switch result {
      case .success(let url): scene.open(url)
      case .failure(let error): scene.failure = Failure(.opening, error)
      }
    }
    .sheet(item: $sheet) { sheet in
      NavigationStack { content(of: sheet) }
    }
  }

  private func choose(_ types: [UTType]) {
    chosenTypes = types
    isChoosing = true
  }

  private var recents: some View {
    Section("Recent") {
      ForEach(app.recents.entries) { entry in
        Button {
          app.open(entry, in: scene)
        } label: {
          VStack(alignment: .leading) {
            Text(verbatim: entry.name)
            Text(entry.opened, style: .date).font(.caption).foregroundStyle(.secondary)
          }
        }
        .contextMenu {
          Button("Remove from list", role: .destructive) { app.recents.remove(entry) }
        }
      }
      Button("Clear list", role: .destructive) { app.recents.clear() }
    }
  }

  @ViewBuilder private func content(of sheet: Sheet) -> some View {
    switch sheet {
    case .training: TrainingView(app: app, scene: scene)
    case .selfCheck: SelfCheckView(model: app.selfCheck)
    case .capture:
      #if canImport(UIKit)
        CaptureView(app: app)
      #else
        EmptyView()
      #endif
    }
  }
}

/// The kinds of files that are scenes.
enum SceneFileTypes {
  static let files: [UTType] = AppModel.sceneExtensions.compactMap { UTType(filenameExtension: $0) }
}
