import SwiftUI
import TrapezeKit
import TrapezeUI

@main
struct TrapezeApp: App {
  @State private var app = AppModel(
    engine: SplatEngine(), system: .device,
    sampleScene: Bundle.main.url(forResource: "sample-scene", withExtension: nil),
    bundledModels: Bundle.main.url(forResource: "search-model", withExtension: nil))

  var body: some Scene {
    WindowGroup {
      TrapezeWindow(app: app)
    }
    .commands { TrapezeCommands() }
  }
}
