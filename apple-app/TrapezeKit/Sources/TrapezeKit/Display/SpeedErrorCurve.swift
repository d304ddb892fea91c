/// Predicts what masking static splats costs and brings, from what was measured.
public struct SpeedErrorCurve: Sendable, Equatable {
  /// A prediction: never a speed without its error.
  public struct Prediction: Sendable, Equatable {
    public var frameMilliseconds: Double
    /// Against the unmasked frame.
    public var speedUp: Double
    /// dB; `nil` for no error at all.
    public var psnr: Double?
  }

  /// Shares in percent that are worth measuring: the error rises steeply at the end.
  public static let percentiles: [Double] = [0, 25, 50, 75, 90, 100]

  /// What to measure for one slider, the full-precision frame included.
  public static func variants(precision: RendererOptions.Precision) -> [FrameVariant] {
    let masked = percentiles.dropFirst().map {
      FrameVariant(precision: precision, staticPercentile: $0)
    }
    let plain = RendererOptions.Precision.allCases.map {
      FrameVariant(precision: $0, staticPercentile: nil)
    }
    return plain + masked
  }

  private struct Point: Sendable, Equatable {
    var percentile: Double
    var milliseconds: Double
    var psnr: Double?
  }

  private let points: [Point]
  private let plainMilliseconds: Double

  /// - Returns: `nil` when there is nothing to compare with.
  public init?(_ measurements: [VariantMeasurement], precision: RendererOptions.Precision) {
    let full = FrameVariant(precision: .single, staticPercentile: nil)
    guard let plain = measurements.first(where: { $0.variant == full }) else { return nil }
    plainMilliseconds = plain.frameMilliseconds
    points =
      measurements
      .filter { $0.variant.precision == precision }
      .map {
        Point(
          percentile: $0.variant.staticPercentile ?? 0, milliseconds: $0.frameMilliseconds,
          psnr: $0.psnr)
      }
      .sorted { $0.percentile < $1.percentile }
    if points.isEmpty { return nil }
  }

  /// Between two measurements on the line through both; dB as well, since dB over the share is
  /// nearly straight where the squared error is not. No error (∞ dB) next to a measured error
  /// counts as that error: a prediction does not promise more than was seen.
  public func prediction(at percentile: Double) -> Prediction? {
    guard let first = points.first, let last = points.last else { return nil }
    let p = clamped(percentile, first.percentile...last.percentile)
    let upper = points.first { $0.percentile >= p } ?? last
    let lower = points.last { $0.percentile <= p } ?? first
    let span = upper.percentile - lower.percentile
    let x = span > 0 ? (p - lower.percentile) / span : 0
    let milliseconds = lower.milliseconds + (upper.milliseconds - lower.milliseconds) * x
    return Prediction(
      frameMilliseconds: milliseconds, speedUp: plainMilliseconds / max(milliseconds, 1e-9),
      psnr: Self.psnr(lower, upper, x))
  }

  private static func psnr(_ lower: Point, _ upper: Point, _ x: Double) -> Double? {
    switch (lower.psnr, upper.psnr) {
    case (let low?, let high?): low + (high - low) * x
    case (nil, let high?): x == 0 ? nil : high
    case (let low?, nil): x == 1 ? nil : low
    case (nil, nil): nil
    }
  }
}
