import Foundation
import Observation

/// What is on the screen: where the viewer stands, what is drawn and how.
@MainActor @Observable
public final class ViewerModel {
  public private(set) var camera = CameraController()
  public var display = DisplaySettings()
  public private(set) var viewport = Viewport(width: 0, height: 0)
  public var condition = DeviceCondition()
  /// Highest rate of the display, frames per second.
  public var displayMaximum = 120
  public let parallax = ParallaxModel()
  public let stats = StatsModel()
  public let playback: PlaybackModel
  public let selection: SelectionModel
  /// Boxes of what is chosen, at the time that is shown.
  public private(set) var chosenBounds: [ClusterID: Bounds] = [:]
  /// While a box is being drawn to crop to.
  public var cropBox: Bounds?
  public private(set) var renderer: (any RenderEngine)?

  @ObservationIgnored public private(set) var loop: RenderLoop!
  @ObservationIgnored private var lastMoment: Double?
  @ObservationIgnored private var keptThreshold:
    (scene: any SceneEngine, percentile: Double, value: Float?)?
  @ObservationIgnored private var framingPending = false
  @ObservationIgnored var didFail: @MainActor (any Error) -> Void = { _ in }
  private(set) var scene: (any SceneEngine)?

  public init(playback: PlaybackModel, selection: SelectionModel) {
    self.playback = playback
    self.selection = selection
    loop = RenderLoop(
      advance: { [weak self] in self?.advance(to: $0) },
      makeRequest: { [weak self] in self?.request },
      isAnimating: { [weak self] in self?.isAnimating ?? false },
      didDraw: { [weak self] in self?.stats.record($0.stats, at: $1) },
      didFail: { [weak self] in self?.didFail($0) })
  }

  // MARK: What is drawn

  /// The frame that is due now.
  public var request: FrameRequest? {
    guard let scene, !viewport.isEmpty else { return nil }
    var reduced = viewport
    reduced.scale *= policy.scale
    return FrameRequest(
      camera: parallax.value.applied(to: camera.pose).camera(in: reduced),
      time: scene.summary.isDeformable ? playback.time : 0,
      mode: display.mode,
      visibility: selection.state.visibility,
      staticThreshold: display.masksStatic ? staticThreshold(of: scene) : nil,
      background: display.background)
  }

  /// Kept from frame to frame: the core looks through all motion values for it.
  private func staticThreshold(of scene: any SceneEngine) -> Float? {
    let percentile = display.staticPercentile
    if let kept = keptThreshold, kept.scene === scene, kept.percentile == percentile {
      return kept.value
    }
    let value = scene.staticThreshold(percentile: percentile)
    keptThreshold = (scene, percentile, value)
    return value
  }

  public var policy: ResolutionPolicy {
    ResolutionPolicy(condition, displayMaximum: displayMaximum)
  }

  /// Boxes to draw over the picture; empty while things move.
  public var outlines: [Bounds] {
    let isStill = restingTime != nil || scene?.summary.isDeformable == false
    return isStill ? chosenBounds.sorted { $0.key < $1.key }.map(\.value) : []
  }

  private var isAnimating: Bool {
    camera.isMoving || (playback.isRunning && scene?.summary.isDeformable == true)
  }

  private func advance(to moment: Double) {
    // After a pause of the link the first step is one frame, not the length of the pause.
    let elapsed = min(moment - (lastMoment ?? moment), 0.1)
    lastMoment = moment
    // Writing a state that stays as it is would wake the link for ever.
    if camera.isMoving { camera.advance(by: elapsed) }
    playback.advance(to: moment)
  }

  /// The view has another size, in points.
  public func resize(to viewport: Viewport) {
    guard viewport != self.viewport else { return }
    self.viewport = viewport
    if framingPending { frameAll() }
  }

  func show(_ scene: any SceneEngine, on renderer: any RenderEngine) {
    self.scene = scene
    if self.renderer !== renderer {
      self.renderer = renderer
      loop.setEngine(renderer)
    } else {
      loop.invalidate()
    }
  }

  func close() {
    scene = nil
    renderer = nil
    keptThreshold = nil
    chosenBounds = [:]
    cropBox = nil
    parallax.source = .off
    loop.setEngine(nil)
  }

  // MARK: Gestures

  public func orbit(by points: SIMD2<Double>) { camera.orbit(by: points) }
  public func endOrbit(velocity: SIMD2<Double>) { camera.endOrbit(velocity: velocity) }
  public func pan(by points: SIMD2<Double>) { camera.pan(by: points, in: viewport) }
  public func roll(by radians: Double) { camera.roll(by: radians) }
  public func look(from preset: ViewPreset) { camera.look(from: preset) }
  public func setUp(_ axis: UpAxis) { camera.setUp(axis) }
  public func useImageUp() { camera.useImageUp() }
  public func jump(to pose: OrbitPose) { camera.jump(to: pose) }
  func setSceneRadius(_ radius: Double) { camera.setSceneRadius(radius) }

  /// `location` is in points from the upper left corner.
  public func zoom(by factor: Double, at location: SIMD2<Double>? = nil) {
    let middle = SIMD2(viewport.width, viewport.height) / 2
    camera.zoom(by: factor, anchor: (location ?? middle) - middle, in: viewport)
  }

  /// Shows the whole scene, from the side where the viewer is. Waits for the view's size.
  public func frameAll() {
    framingPending = viewport.isEmpty
    guard !viewport.isEmpty, let bounds = scene?.summary.framingBounds else { return }
    camera.frame(bounds, in: viewport)
  }

  // MARK: Picking

  /// A tap or click at a place in points.
  public func tap(at location: SIMD2<Double>, extending: Bool) async {
    guard let hit = await pick(at: location) else { return }
    selection.pick(hit.result?.cluster, extending: extending)
    await refreshChosenBounds()
  }

  /// A double tap: flies to the cluster under the finger, or turns around what is there.
  public func focus(at location: SIMD2<Double>) async {
    guard let hit = await pick(at: location), let result = hit.result else { return }
    let point = hit.request.camera.unproject(
      x: hit.x + 0.5, y: hit.y + 0.5, depth: result.depth)
    if let cluster = result.cluster, await focus(on: [cluster]) { return }
    var end = camera.pose
    end.target = point
    camera.fly(to: end)
  }

  /// Flies to where the clusters fill the view. Returns whether they are anywhere.
  @discardableResult
  public func focus(on clusters: Set<ClusterID>) async -> Bool {
    guard let scene else { return false }
    var all: Bounds?
    do {
      for cluster in clusters {
        guard let bounds = try await scene.bounds(of: cluster, at: playback.time) else { continue }
        all = all.map { $0.union(bounds) } ?? bounds
      }
    } catch {
      didFail(error)
    }
    guard let all else { return false }
    camera.focus(on: all, in: viewport)
    return true
  }

  /// The time that is shown while it stands still: outlines of moving things would lag behind.
  public var restingTime: Double? {
    playback.isPlaying || playback.clock.isScrubbing ? nil : playback.time
  }

  /// Where what is chosen is now: for the outlines.
  public func refreshChosenBounds() async {
    guard let scene else { return }
    let chosen = selection.state.chosen
    var boxes: [ClusterID: Bounds] = [:]
    do {
      for cluster in chosen {
        boxes[cluster] = try await scene.bounds(of: cluster, at: playback.time)
      }
    } catch {
      didFail(error)
    }
    // Another choice may have been made meanwhile; its own call brings its boxes.
    if chosen == selection.state.chosen { chosenBounds = boxes }
  }

  private struct Hit {
    var request: FrameRequest
    var x: Double
    var y: Double
    var result: PickResult?
  }

  /// Asks for the frame that is on the screen, at its own resolution.
  private func pick(at location: SIMD2<Double>) async -> Hit? {
    guard let request, let renderer else { return nil }
    let scale = SIMD2(
      Double(request.camera.width) / viewport.width,
      Double(request.camera.height) / viewport.height)
    let pixel = location * scale
    let (x, y) = (pixel.x.rounded(.down), pixel.y.rounded(.down))
    guard x >= 0, y >= 0, x < Double(request.camera.width), y < Double(request.camera.height)
    else { return nil }
    do {
      let result = try await renderer.pick(request, x: Int(x), y: Int(y))
      return Hit(request: request, x: x, y: y, result: result)
    } catch {
      didFail(error)
      return nil
    }
  }
}

extension Bounds {
  /// The smallest box around both.
  public func union(_ other: Bounds) -> Bounds {
    Bounds(
      min: pointwiseMin(min, other.min), max: pointwiseMax(max, other.max))
  }
}
