import SwiftUI
import TrapezeKit

/// A window: the library, or the scene that is open in it.
public struct TrapezeWindow: View {
  private let app: AppModel
  @State private var scene: SceneModel
  @Environment(\.scenePhase) private var scenePhase

  public init(app: AppModel) {
    self.app = app
    _scene = State(wrappedValue: app.makeScene())
  }

  public var body: some View {
    @Bindable var scene = scene
    NavigationStack {
      switch scene.phase {
      case .empty: LibraryView(app: app, scene: scene)
      case .loading(let step):
        ProgressRow(step: step) { scene.cancelOpening() }
          .frame(maxWidth: 360).padding()
          .navigationTitle(Text(verbatim: scene.name))
      case .ready: SceneView(app: app, scene: scene)
      }
    }
    .failureAlert($scene.failure)
    .focusedSceneValue(\.openScene, scene)
    .onOpenURL { scene.open($0) }
    .task { app.openSampleOnFirstRun(in: scene) }
    .followsDevice(app: app, viewer: scene.viewer)
    .onChange(of: scenePhase) { changed(to: scenePhase) }
  }

  private func changed(to phase: ScenePhase) {
    switch phase {
    case .active: app.lifeCycle.enterForeground(window: ObjectIdentifier(scene))
    // A Mac's window in the background may be in plain view.
    #if canImport(UIKit)
      case .background: app.lifeCycle.enterBackground(window: ObjectIdentifier(scene))
    #else
      case .background: scene.saveSettings()
    #endif
    default: break
    }
  }
}

private struct OpenSceneKey: FocusedValueKey {
  typealias Value = SceneModel
}

extension FocusedValues {
  /// The scene of the window in front, for the menus.
  var openScene: SceneModel? {
    get { self[OpenSceneKey.self] }
    set { self[OpenSceneKey.self] = newValue }
  }
}
