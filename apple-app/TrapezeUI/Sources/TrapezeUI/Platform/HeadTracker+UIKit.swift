#if canImport(UIKit)
  import ARKit
  import Foundation
  import TrapezeKit
  import UIKit

  /// The viewer's head by ARKit's face tracking.
  @MainActor
  final class HeadTracker: NSObject {
    private var session: ARSession?
    private weak var parallax: ParallaxModel?

    func start(for parallax: ParallaxModel) {
      guard ARFaceTrackingConfiguration.isSupported else {
        parallax.source = .off
        return
      }
      self.parallax = parallax
      let session = ARSession()
      session.delegate = self
      session.run(ARFaceTrackingConfiguration())
      self.session = session
    }

    func stop() {
      session?.pause()
      session = nil
    }
  }

  extension HeadTracker: ARSessionDelegate {
    /// On the main queue, since the session was given no other.
    nonisolated func session(_ session: ARSession, didUpdate frame: ARFrame) {
      let face = frame.anchors.lazy.compactMap { $0 as? ARFaceAnchor }.first { $0.isTracked }
      let orientation = MainActor.assumeIsolated { Self.interfaceOrientation }
      let position = face.map { face in
        let p = frame.camera.viewMatrix(for: orientation) * face.transform.columns.3
        // The camera looks at the viewer: its right is the viewer's left, and −z is in front of it.
        return Vector3(-Double(p.x), Double(p.y), -Double(p.z))
      }
      MainActor.assumeIsolated { parallax?.headMoved(to: position) }
    }

    @MainActor private static var interfaceOrientation: UIInterfaceOrientation {
      switch ScreenOrientation.current {
      case .portrait: .portrait
      case .upsideDown: .portraitUpsideDown
      case .landscapeTopLeft: .landscapeRight
      case .landscapeTopRight: .landscapeLeft
      }
    }
  }
#endif
