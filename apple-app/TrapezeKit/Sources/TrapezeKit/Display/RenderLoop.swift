import Foundation
import Observation

/// Decides when a frame is drawn: when it would differ from the one on the screen, one at a time.
///
/// The display link calls ``tick(at:)``. When that answers `false` nothing moves by itself and the
/// link may stop; ``onWake`` is called as soon as anything that a frame depends on has changed.
@MainActor
public final class RenderLoop {
  /// What a frame would look like now. Reads observable state and changes none: what it reads is
  /// what ``onWake`` follows. `nil` while there is nothing to draw.
  public typealias MakeRequest = @MainActor () -> FrameRequest?

  /// Starts the display link again.
  public var onWake: @MainActor () -> Void = {}
  public private(set) var isSuspended = false
  /// Frames that were drawn.
  public private(set) var drawnFrames = 0

  private let advance: @MainActor (Double) -> Void
  private let makeRequest: MakeRequest
  private let isAnimating: @MainActor () -> Bool
  private let didDraw: @MainActor (DrawReport, Double) -> Void
  private let didFail: @MainActor (any Error) -> Void
  private var engine: (any RenderEngine)?
  private var onScreen: FrameRequest?
  private var inFlight: Task<Void, Never>?
  private var layer: LayerPointer?
  /// The layer and size that the engine draws onto now.
  private var attached: (layer: LayerPointer, width: Int, height: Int)?
  private var isWatching = false
  /// Counts what invalidates a frame on its way: another engine, another size of the layer.
  private var generation = 0

  /// `advance` lets the state follow the clock, to a moment in seconds.
  public init(
    advance: @escaping @MainActor (Double) -> Void,
    makeRequest: @escaping MakeRequest, isAnimating: @escaping @MainActor () -> Bool,
    didDraw: @escaping @MainActor (DrawReport, Double) -> Void,
    didFail: @escaping @MainActor (any Error) -> Void
  ) {
    self.advance = advance
    self.makeRequest = makeRequest
    self.isAnimating = isAnimating
    self.didDraw = didDraw
    self.didFail = didFail
  }

  public func setEngine(_ engine: (any RenderEngine)?) {
    self.engine = engine
    attached = nil
    invalidate()
  }

  /// Draws onto this layer from the next frame on. Its drawables have the size of the frames.
  public func setLayer(_ layer: LayerPointer) {
    self.layer = layer
    invalidate()
  }

  /// Lets go of the layer, and returns once nothing is drawn onto it any more.
  public func removeLayer(_ layer: LayerPointer) async {
    guard self.layer == layer else { return }
    self.layer = nil
    attached = nil
    await settle()
    // A layer that cannot be detached belongs to a device that is lost.
    try? await engine?.attach(nil, width: 0, height: 0)
  }

  /// What is on the screen is out of date for a reason that the request does not show.
  public func invalidate() {
    generation += 1
    onScreen = nil
    onWake()
  }

  /// Lets time pass and draws if needed. Returns whether the next tick is needed.
  public func tick(at moment: Double) -> Bool {
    advance(moment)
    guard let engine, !isSuspended, let request = makeRequest() else {
      watch()
      return false
    }
    if inFlight == nil, request != onScreen {
      draw(request, with: engine, at: moment)
    }
    if inFlight != nil || request != onScreen || isAnimating() { return true }
    watch()
    return false
  }

  private func draw(_ request: FrameRequest, with engine: any RenderEngine, at moment: Double) {
    let generation = generation
    inFlight = Task { [weak self] in
      let result: Result<DrawReport, any Error>
      do {
        try await self?.attachLayer(to: engine, request.camera)
        result = .success(try await engine.draw(request))
      } catch {
        result = .failure(error)
      }
      self?.finish(request, result, generation, moment)
    }
  }

  private func attachLayer(to engine: any RenderEngine, _ camera: Camera) async throws {
    guard let layer else { return }
    let wanted = (layer: layer, width: camera.width, height: camera.height)
    if let attached, attached == wanted { return }
    try await engine.attach(layer, width: wanted.width, height: wanted.height)
    attached = wanted
  }

  private func finish(
    _ request: FrameRequest, _ result: Result<DrawReport, any Error>, _ generation: Int,
    _ moment: Double
  ) {
    inFlight = nil
    switch result {
    case .success(let report):
      drawnFrames += 1
      if generation == self.generation, !report.needsRedraw { onScreen = request }
      didDraw(report, moment)
    case .failure(let error):
      // The same request would fail again, sixty times a second.
      if generation == self.generation { onScreen = request }
      didFail(error)
    }
    onWake()
  }

  /// Waits for the frame that is on its way.
  public func settle() async { await inFlight?.value }

  /// Draws nothing until ``resume()``.
  public func suspend() async {
    isSuspended = true
    await settle()
    await engine?.suspend()
  }

  public func resume() async {
    await engine?.resume()
    isSuspended = false
    invalidate()
  }

  private func watch() {
    guard !isWatching else { return }
    isWatching = true
    withObservationTracking {
      _ = makeRequest()
      _ = isAnimating()
    } onChange: { [weak self] in
      // Called before the change and on any thread: look again once it is there.
      Task { @MainActor [weak self] in
        self?.isWatching = false
        self?.onWake()
      }
    }
  }
}
