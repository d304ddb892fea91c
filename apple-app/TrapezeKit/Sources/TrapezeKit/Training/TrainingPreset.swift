import Foundation

/// How much work a scene is worth.
public enum TrainingPreset: String, Sendable, CaseIterable, Identifiable {
  /// A look at the result.
  case draft
  case standard
  /// Everything the photographs give.
  case fine

  public var id: Self { self }

  /// `nil` for `maxSplats` lets the run find how many splats the scene needs.
  public func configuration(for dataset: DatasetSummary, folder: URL) -> TrainingConfiguration {
    let (steps, splats, degree): (Int, Int?, Int) =
      switch self {
      case .draft: (2_000, 30_000, 1)
      case .standard: (7_000, nil, 3)
      case .fine: (30_000, nil, 3)
      }
    return TrainingConfiguration(
      steps: steps, maxSplats: splats, harmonicsDegree: degree,
      downscale: Self.downscale(dataset, longestSide: longestSide),
      // With a handful of photographs every one is needed.
      holdout: dataset.viewCount >= 16 ? 8 : nil,
      folder: folder)
  }

  /// Pixels of a photograph's longer side that the preset trains on at most.
  private var longestSide: Int {
    switch self {
    case .draft: 640
    case .standard: 1_280
    case .fine: 1_920
    }
  }

  private static func downscale(_ dataset: DatasetSummary, longestSide: Int) -> Int {
    let longest = max(dataset.width, dataset.height, 1)
    return max(1, (longest + longestSide - 1) / longestSide)
  }
}
