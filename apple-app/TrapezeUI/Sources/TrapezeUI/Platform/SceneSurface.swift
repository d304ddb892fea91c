import Foundation
import QuartzCore
import TrapezeKit

/// What the views of both systems have in common: a layer, a link, and the way to the model.
@MainActor
final class SceneSurface {
  let scene: SceneModel
  private let layer: CAMetalLayer
  private let pointer: LayerPointer
  private var link: DisplayLink?

  init(scene: SceneModel, layer: CAMetalLayer) {
    self.scene = scene
    self.layer = layer
    layer.isOpaque = true
    pointer = LayerPointer(Unmanaged.passUnretained(layer).toOpaque())
  }

  /// The view is on a screen.
  func start(make: @MainActor (DisplayLinkTarget, Selector) -> CADisplayLink?) {
    link?.end()
    let loop: RenderLoop = scene.viewer.loop
    let link = DisplayLink(tick: { loop.tick(at: $0) }, make: make)
    self.link = link
    loop.onWake = { [weak link] in link?.wake() }
    loop.setLayer(pointer)
    setRate()
  }

  /// The view has left the screen.
  func stop() {
    guard link != nil else { return }
    link?.end()
    link = nil
    let loop: RenderLoop = scene.viewer.loop
    loop.onWake = {}
    // The layer has to outlive the frame that is being drawn onto it.
    let (layer, pointer) = (layer, pointer)
    Task {
      await loop.removeLayer(pointer)
      withExtendedLifetime(layer) {}
    }
  }

  func resize(width: Double, height: Double, scale: Double, displayMaximum: Int) {
    layer.contentsScale = scale
    scene.viewer.displayMaximum = displayMaximum
    scene.viewer.resize(to: Viewport(width: width, height: height, scale: scale))
    setRate()
  }

  func setRate() { link?.setRate(maximum: scene.viewer.policy.maxFramesPerSecond) }

  func perform(_ actions: [PointerAction]) {
    for action in actions { scene.viewer.perform(action) }
  }
}
