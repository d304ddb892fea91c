import SwiftUI
import TrapezeKit

#if canImport(UIKit)
  import UIKit
#endif

extension View {
  /// Heat, low power and memory warnings, from the system to the models.
  func followsDevice(app: AppModel, viewer: ViewerModel) -> some View {
    modifier(DeviceFollower(app: app, viewer: viewer))
  }
}

private struct DeviceFollower: ViewModifier {
  let app: AppModel
  let viewer: ViewerModel

  func body(content: Content) -> some View {
    content
      .onReceive(NotificationCenter.default.publisher(for: .thermalState)) { _ in look() }
      .onReceive(NotificationCenter.default.publisher(for: .powerState)) { _ in look() }
      #if canImport(UIKit)
        .onReceive(
          NotificationCenter.default.publisher(
            for: UIApplication.didReceiveMemoryWarningNotification)
        ) { _ in
          Task { await app.lifeCycle.memoryWarning() }
        }
      #endif
      .onAppear { look() }
  }

  /// The system tells of changes on a thread of its own.
  private func look() {
    Task { @MainActor in viewer.condition = .current }
  }
}

extension Notification.Name {
  #if canImport(Darwin)
    fileprivate static let thermalState = ProcessInfo.thermalStateDidChangeNotification
    fileprivate static let powerState = Notification.Name.NSProcessInfoPowerStateDidChange
  #else
    fileprivate static let thermalState = Notification.Name("thermalState")
    fileprivate static let powerState = Notification.Name("powerState")
  #endif
}

#if !canImport(Darwin)
  extension DeviceCondition {
    static var current: Self { Self() }
  }
#endif
