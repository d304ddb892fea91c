import Foundation

/// What is kept about a scene between two visits.
public struct SceneSettings: Sendable, Equatable {
  public var pose: OrbitPose?
  public var display = DisplaySettings()
  public var playback = PlaybackSettings()
  public var visibility = ClusterVisibility.all
  public var search = SearchSettings()
  /// Speed and error of masking, as measured on this device.
  public var measurements: [VariantMeasurement] = []

  public init() {}
}

/// How a scene is drawn.
public struct DisplaySettings: Sendable, Equatable {
  public var mode = FrameRequest.Mode.color
  public var options = RendererOptions()
  /// Whether splats that hardly move hold still.
  public var masksStatic = false
  /// Share of the splats that hold still, in percent, 0 to 100.
  public var staticPercentile = 50.0 {
    didSet { staticPercentile = clamped(staticPercentile, 0...100) }
  }
  public var background = RGBColor(red: 0, green: 0, blue: 0)
  public var showsStats = false

  public init() {}
}

public struct PlaybackSettings: Sendable, Equatable, Codable {
  public var loopMode = PlaybackClock.LoopMode.loop
  public var speed = 1.0
  public var duration = 10.0

  public init() {}
}

public struct SearchSettings: Sendable, Equatable {
  /// Where to search.
  public enum Scope: String, Sendable, Codable, CaseIterable, Identifiable {
    case all, visible, chosen
    public var id: Self { self }
  }

  public static let thresholds = 0.0...1.0
  public static let counts = 1...100

  public var scope = Scope.all
  /// Lowest score that counts as a match; `nil` for the models' own.
  public var threshold: Double? {
    didSet { threshold = threshold.map { clamped($0, Self.thresholds) } }
  }
  /// Most results.
  public var topK = 5 {
    didSet { topK = min(max(topK, Self.counts.lowerBound), Self.counts.upperBound) }
  }

  public init() {}
}

// Files of earlier and later versions have other fields: what is missing or unreadable takes its default,
// so that one new setting does not cost a person all the others.

extension KeyedDecodingContainer {
  fileprivate func value<T: Decodable>(_ key: Key, else fallback: T) -> T {
    (try? decodeIfPresent(T.self, forKey: key)) ?? fallback
  }
}

extension SceneSettings: Codable {
  private enum CodingKeys: CodingKey {
    case pose, display, playback, visibility, search, measurements
  }

  public init(from decoder: any Decoder) throws {
    let fields = try decoder.container(keyedBy: CodingKeys.self)
    pose = fields.value(.pose, else: nil)
    display = fields.value(.display, else: display)
    playback = fields.value(.playback, else: playback)
    visibility = fields.value(.visibility, else: visibility)
    search = fields.value(.search, else: search)
    measurements = fields.value(.measurements, else: measurements)
  }
}

extension DisplaySettings: Codable {
  private enum CodingKeys: CodingKey {
    case mode, options, masksStatic, staticPercentile, background, showsStats
  }

  public init(from decoder: any Decoder) throws {
    let fields = try decoder.container(keyedBy: CodingKeys.self)
    mode = fields.value(.mode, else: mode)
    options = fields.value(.options, else: options)
    masksStatic = fields.value(.masksStatic, else: masksStatic)
    staticPercentile = clamped(fields.value(.staticPercentile, else: staticPercentile), 0...100)
    background = fields.value(.background, else: background)
    showsStats = fields.value(.showsStats, else: showsStats)
  }
}

extension SearchSettings: Codable {
  private enum CodingKeys: CodingKey { case scope, threshold, topK }

  public init(from decoder: any Decoder) throws {
    let fields = try decoder.container(keyedBy: CodingKeys.self)
    scope = fields.value(.scope, else: scope)
    threshold = fields.value(.threshold, else: threshold).map { clamped($0, Self.thresholds) }
    let count = fields.value(.topK, else: topK)
    topK = min(max(count, Self.counts.lowerBound), Self.counts.upperBound)
  }
}
