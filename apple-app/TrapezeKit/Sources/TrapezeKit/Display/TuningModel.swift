import Observation

/// Measures what precision and masking cost and bring on this device, for the slider to show.
@MainActor @Observable
public final class TuningModel {
  public private(set) var measurements: [VariantMeasurement] = []
  public private(set) var progress: ProgressStep?
  public var isMeasuring: Bool { progress != nil }

  @ObservationIgnored private var renderer: (any RenderEngine)?
  @ObservationIgnored private var work: Task<Void, Never>?
  @ObservationIgnored var didFail: @MainActor (any Error) -> Void = { _ in }

  /// Times at which frames are compared.
  static let times = [0.0, 0.25, 0.5, 0.75, 1.0]

  public init() {}

  func start(with renderer: any RenderEngine, measurements: [VariantMeasurement]) {
    self.renderer = renderer
    self.measurements = measurements
  }

  func close() {
    cancel()
    renderer = nil
    measurements = []
  }

  /// Draws every variant from where the viewer stands.
  public func measure(from camera: Camera, precision: RendererOptions.Precision) {
    guard let renderer, !isMeasuring else { return }
    progress = ProgressStep(.measuring, fraction: 0)
    work = Task {
      defer { progress = nil }
      do {
        measurements = try await renderer.measure(
          SpeedErrorCurve.variants(precision: precision), camera: camera, times: Self.times
        ).result { self.progress = $0 }
      } catch {
        didFail(error)
      }
    }
  }

  public func cancel() { work?.cancel() }

  public func settle() async { await work?.value }

  /// What a position of the slider means; `nil` until it was measured.
  public func prediction(
    at percentile: Double, precision: RendererOptions.Precision
  ) -> SpeedErrorCurve.Prediction? {
    SpeedErrorCurve(measurements, precision: precision)?.prediction(at: percentile)
  }
}
