#if canImport(AppKit)
  import AppKit
  import QuartzCore
  import SwiftUI
  import TrapezeKit

  /// The picture of a scene, and mouse, trackpad and keys on it.
  struct MetalView: NSViewRepresentable {
    let scene: SceneModel

    func makeNSView(context: Context) -> SceneNSView { SceneNSView(scene: scene) }

    func updateNSView(_ view: SceneNSView, context: Context) {
      view.updateRate(scene.viewer.policy)
    }

    static func dismantleNSView(_ view: SceneNSView, coordinator: ()) { view.close() }
  }

  final class SceneNSView: NSView {
    private let scene: SceneModel
    private let metalLayer = CAMetalLayer()
    private var surface: SceneSurface?
    private var hasDragged = false

    init(scene: SceneModel) {
      self.scene = scene
      super.init(frame: .zero)
      wantsLayer = true
      surface = SceneSurface(scene: scene, layer: metalLayer)
      setAccessibilityElement(true)
      setAccessibilityLabel(NSLocalizedString("Scene", comment: "The picture of a scene"))
    }

    /// Not made from an archive.
    required init?(coder: NSCoder) { nil }

    override func makeBackingLayer() -> CALayer { metalLayer }
    override var acceptsFirstResponder: Bool { true }
    /// Points from the upper left corner, as everywhere else.
    override var isFlipped: Bool { true }

    override func viewDidMoveToWindow() {
      super.viewDidMoveToWindow()
      guard let window else {
        surface?.stop()
        return
      }
      surface?.start { displayLink(target: $0, selector: $1) }
      window.makeFirstResponder(self)
      needsLayout = true
    }

    override func viewDidChangeBackingProperties() {
      super.viewDidChangeBackingProperties()
      needsLayout = true
    }

    override func layout() {
      super.layout()
      guard let window else { return }
      surface?.resize(
        width: bounds.width, height: bounds.height, scale: window.backingScaleFactor,
        displayMaximum: window.screen?.maximumFramesPerSecond ?? 60)
    }

    /// Takes the policy that it follows as an argument, so that SwiftUI sees what it depends on.
    func updateRate(_ policy: ResolutionPolicy) { surface?.setRate() }

    func close() { surface?.stop() }

    // MARK: Mouse and trackpad

    private func location(_ event: NSEvent) -> SIMD2<Double> {
      let point = convert(event.locationInWindow, from: nil)
      return SIMD2(point.x, point.y)
    }

    private func delta(_ event: NSEvent) -> SIMD2<Double> { SIMD2(event.deltaX, event.deltaY) }

    override func mouseDown(with event: NSEvent) {
      window?.makeFirstResponder(self)
      hasDragged = false
    }

    override func mouseDragged(with event: NSEvent) {
      hasDragged = true
      let moves = event.modifierFlags.contains(.option) || event.modifierFlags.contains(.shift)
      surface?.perform([moves ? .pan(delta(event)) : .orbit(delta(event))])
    }

    override func mouseUp(with event: NSEvent) {
      if hasDragged { return }
      let flags = event.modifierFlags
      let extending = flags.contains(.shift) || flags.contains(.command)
      surface?.perform([
        event.clickCount == 2
          ? .doubleTap(location(event)) : .tap(location(event), extending: extending)
      ])
    }

    override func rightMouseDragged(with event: NSEvent) { surface?.perform([.pan(delta(event))]) }
    override func otherMouseDragged(with event: NSEvent) { surface?.perform([.pan(delta(event))]) }

    override func scrollWheel(with event: NSEvent) {
      let scroll = SIMD2(Double(event.scrollingDeltaX), Double(event.scrollingDeltaY))
      if event.hasPreciseScrollingDeltas, !event.modifierFlags.contains(.option) {
        surface?.perform([.pan(scroll)])
      } else {
        // A notch of a wheel is one line; a trackpad tells points, about ten a line.
        let lines = event.hasPreciseScrollingDeltas ? scroll.y / 10 : scroll.y
        surface?.perform([.zoom(factor: exp(lines * 0.1), at: location(event))])
      }
    }

    override func magnify(with event: NSEvent) {
      surface?.perform([.zoom(factor: 1 + event.magnification, at: location(event))])
    }

    override func rotate(with event: NSEvent) {
      // Degrees, counter-clockwise.
      surface?.perform([.roll(-Double(event.rotation) * .pi / 180)])
    }

    // MARK: Keys

    override func keyDown(with event: NSEvent) {
      if let command = Self.command(event) {
        scene.perform(command)
      } else {
        super.keyDown(with: event)
      }
    }

    private static func command(_ event: NSEvent) -> KeyCommand? {
      if !event.modifierFlags.isDisjoint(with: [.command, .control]) { return nil }
      switch event.specialKey {
      case .leftArrow?: return KeyCommand(.leftArrow)
      case .rightArrow?: return KeyCommand(.rightArrow)
      case .upArrow?: return KeyCommand(.upArrow)
      case .downArrow?: return KeyCommand(.downArrow)
      default: break
      }
      // The escape key has no name of its own.
      if event.keyCode == 53 { return KeyCommand(.escape) }
      return event.charactersIgnoringModifiers?.first.flatMap { KeyCommand(.character($0)) }
    }
  }
#endif
