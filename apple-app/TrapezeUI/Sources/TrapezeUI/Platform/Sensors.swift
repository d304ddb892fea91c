import SwiftUI
import TrapezeKit

extension View {
  /// Feeds fake depth from the sensor that was chosen, while the view is there.
  func sensors(for parallax: ParallaxModel) -> some View {
    modifier(SensorModifier(parallax: parallax))
  }
}

private struct SensorModifier: ViewModifier {
  let parallax: ParallaxModel
  @State private var head = HeadTracker()
  #if canImport(UIKit)
    @State private var motion = MotionSource()
  #endif

  func body(content: Content) -> some View {
    content
      .onChange(of: parallax.source, initial: true) { follow() }
      .onDisappear { stop() }
  }

  private func follow() {
    stop()
    switch parallax.source {
    case .off: break
    case .head: head.start(for: parallax)
    case .device:
      #if canImport(UIKit)
        motion.start(for: parallax)
      #endif
    }
  }

  private func stop() {
    head.stop()
    #if canImport(UIKit)
      motion.stop()
    #endif
  }
}
