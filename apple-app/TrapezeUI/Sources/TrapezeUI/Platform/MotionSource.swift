#if canImport(UIKit)
  import CoreMotion
  import Foundation
  import TrapezeKit
  import UIKit

  /// The device's attitude, sixty times a second.
  @MainActor
  final class MotionSource {
    private let manager = CMMotionManager()

    func start(for parallax: ParallaxModel) {
      guard manager.isDeviceMotionAvailable else {
        parallax.source = .off
        return
      }
      manager.deviceMotionUpdateInterval = 1.0 / 60
      manager.startDeviceMotionUpdates(to: .main) { [weak parallax] motion, _ in
        guard let q = motion?.attitude.quaternion else { return }
        let attitude = Attitude(w: q.w, x: q.x, y: q.y, z: q.z)
        MainActor.assumeIsolated {
          parallax?.deviceMoved(to: attitude, orientation: ScreenOrientation.current)
        }
      }
    }

    func stop() { manager.stopDeviceMotionUpdates() }
  }

  extension ScreenOrientation {
    /// How the app's window is turned.
    @MainActor static var current: Self { Self(windowScene?.interfaceOrientation) }

    @MainActor private static var windowScene: UIWindowScene? {
      let scenes = UIApplication.shared.connectedScenes
      return scenes.first { $0.activationState == .foregroundActive } as? UIWindowScene
    }

    /// UIKit names landscape by the home button: with it on the left, the top points right.
    init(_ orientation: UIInterfaceOrientation?) {
      self =
        switch orientation {
        case .landscapeLeft?: .landscapeTopRight
        case .landscapeRight?: .landscapeTopLeft
        case .portraitUpsideDown?: .upsideDown
        default: .portrait
        }
    }
  }
#endif
