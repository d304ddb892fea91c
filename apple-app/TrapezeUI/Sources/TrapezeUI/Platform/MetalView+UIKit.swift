#if canImport(UIKit)
  import QuartzCore
  import SwiftUI
  import TrapezeKit
  import UIKit

  /// The picture of a scene, and the fingers on it.
  struct MetalView: UIViewRepresentable {
    let scene: SceneModel

    func makeUIView(context: Context) -> SceneUIView { SceneUIView(scene: scene) }

    func updateUIView(_ view: SceneUIView, context: Context) {
      view.updateRate(scene.viewer.policy)
    }

    static func dismantleUIView(_ view: SceneUIView, coordinator: ()) { view.close() }
  }

  final class SceneUIView: UIView {
    private let scene: SceneModel
    private var surface: SceneSurface?
    private var touches = TouchInterpreter()

    init(scene: SceneModel) {
      self.scene = scene
      super.init(frame: .zero)
      isMultipleTouchEnabled = true
      isAccessibilityElement = true
      accessibilityLabel = NSLocalizedString("Scene", comment: "The picture of a scene")
      accessibilityTraits = .allowsDirectInteraction
      if let layer = layer as? CAMetalLayer {
        surface = SceneSurface(scene: scene, layer: layer)
      }
    }

    /// Not made from an archive.
    required init?(coder: NSCoder) { nil }

    override class var layerClass: AnyClass { CAMetalLayer.self }
    override var canBecomeFirstResponder: Bool { true }

    override func didMoveToWindow() {
      super.didMoveToWindow()
      guard window != nil else {
        surface?.stop()
        return
      }
      surface?.start { CADisplayLink(target: $0, selector: $1) }
      becomeFirstResponder()
      setNeedsLayout()
    }

    override func layoutSubviews() {
      super.layoutSubviews()
      guard let screen = window?.screen else { return }
      surface?.resize(
        width: bounds.width, height: bounds.height, scale: screen.nativeScale,
        displayMaximum: screen.maximumFramesPerSecond)
    }

    /// Takes the policy that it follows as an argument, so that SwiftUI sees what it depends on.
    func updateRate(_ policy: ResolutionPolicy) { surface?.setRate() }

    func close() { surface?.stop() }

    // MARK: Fingers

    private func locations(_ touches: Set<UITouch>) -> [TouchInterpreter.Finger: SIMD2<Double>] {
      var locations: [TouchInterpreter.Finger: SIMD2<Double>] = [:]
      for touch in touches {
        let point = touch.location(in: self)
        locations[ObjectIdentifier(touch).hashValue] = SIMD2(point.x, point.y)
      }
      return locations
    }

    private func moment(_ touches: Set<UITouch>) -> Double { touches.first?.timestamp ?? 0 }

    override func touchesBegan(_ touches: Set<UITouch>, with event: UIEvent?) {
      self.touches.began(locations(touches), at: moment(touches))
    }

    override func touchesMoved(_ touches: Set<UITouch>, with event: UIEvent?) {
      surface?.perform(self.touches.moved(locations(touches), at: moment(touches)))
    }

    override func touchesEnded(_ touches: Set<UITouch>, with event: UIEvent?) {
      let lifted = Set(locations(touches).keys)
      surface?.perform(self.touches.ended(lifted, at: moment(touches)))
    }

    override func touchesCancelled(_ touches: Set<UITouch>, with event: UIEvent?) {
      self.touches.cancelled()
    }

    // MARK: Keys of an iPad's keyboard

    override func pressesBegan(_ presses: Set<UIPress>, with event: UIPressesEvent?) {
      let commands = presses.compactMap { press in press.key.flatMap { Self.command($0) } }
      if commands.isEmpty {
        super.pressesBegan(presses, with: event)
      } else {
        for command in commands { scene.perform(command) }
      }
    }

    private static func command(_ key: UIKey) -> KeyCommand? {
      if !key.modifierFlags.isDisjoint(with: [.command, .control]) { return nil }
      switch key.keyCode {
      case .keyboardLeftArrow: return KeyCommand(.leftArrow)
      case .keyboardRightArrow: return KeyCommand(.rightArrow)
      case .keyboardUpArrow: return KeyCommand(.upArrow)
      case .keyboardDownArrow: return KeyCommand(.downArrow)
      case .keyboardEscape: return KeyCommand(.escape)
      default: return key.charactersIgnoringModifiers.first.flatMap { KeyCommand(.character($0)) }
      }
    }
  }
#endif
