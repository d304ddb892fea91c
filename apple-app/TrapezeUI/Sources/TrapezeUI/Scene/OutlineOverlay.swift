import SwiftUI
import TrapezeKit

/// Boxes around what is selected, and the crop box, drawn over the picture.
struct OutlineOverlay: View {
  let viewer: ViewerModel

  var body: some View {
    // Reading the camera only where there is something to draw: it changes with every frame.
    if !viewer.outlines.isEmpty || viewer.cropBox != nil { canvas }
  }

  private var canvas: some View {
    Canvas { context, _ in
      guard let camera = viewer.request?.camera, viewer.viewport.width > 0 else { return }
      // The camera may be drawn at less than the display's resolution.
      let scale = viewer.viewport.width / Double(camera.width)
      for bounds in viewer.outlines {
        context.stroke(path(bounds, camera, scale), with: .color(.accentColor), lineWidth: 1.5)
      }
      if let box = viewer.cropBox {
        context.stroke(path(box, camera, scale), with: .color(.yellow), lineWidth: 2)
      }
    }
    .allowsHitTesting(false)
    .accessibilityHidden(true)
  }

  private func path(_ bounds: Bounds, _ camera: Camera, _ scale: Double) -> Path {
    var path = Path()
    for segment in BoxOutline(bounds, camera: camera).segments {
      path.move(to: CGPoint(x: segment.start.x * scale, y: segment.start.y * scale))
      path.addLine(to: CGPoint(x: segment.end.x * scale, y: segment.end.y * scale))
    }
    return path
  }
}
