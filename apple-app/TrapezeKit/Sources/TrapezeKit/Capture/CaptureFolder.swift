import Foundation

/// Writes a capture as it is made: pictures at once, poses and points at the end.
///
/// An actor, because JPEGs arrive from a camera queue while the screen asks how many there are.
public actor CaptureFolder {
  public let url: URL
  private var frames: [TransformsFile.Frame] = []
  /// The newest place of each point: ARKit refines them.
  private var points: [UInt64: FeaturePoint] = [:]

  static let imageFolder = "images"
  static let pointFile = "points.ply"

  /// Makes the folder, which must not exist.
  public init(creating url: URL) throws {
    self.url = url
    try FileManager.default.createDirectory(
      at: url.deletingLastPathComponent(), withIntermediateDirectories: true)
    try FileManager.default.createDirectory(at: url, withIntermediateDirectories: false)
    try FileManager.default.createDirectory(
      at: url.appending(path: Self.imageFolder), withIntermediateDirectories: false)
  }

  public var frameCount: Int { frames.count }
  public var pointCount: Int { points.count }

  /// A picture (JPEG, in the sensor's orientation) and what ARKit saw in it.
  public func append(_ frame: CapturedFrame, jpeg: Data, points seen: [FeaturePoint]) throws {
    let digits = String(frames.count)
    let number = String(repeating: "0", count: max(0, 5 - digits.count)) + digits
    let path = "\(Self.imageFolder)/\(number).jpg"
    try jpeg.write(to: url.appending(path: path), options: .atomic)
    frames.append(TransformsFile.Frame(frame, filePath: path))
    for var point in seen {
      point.color = point.color ?? points[point.id]?.color
      points[point.id] = point
    }
  }

  /// Writes `transforms.json` and the points: the folder is a dataset from here on.
  public func finish() throws {
    let sorted = points.values.sorted { $0.id < $1.id }
    if !sorted.isEmpty {
      try PointCloudFile.ply(sorted).write(
        to: url.appending(path: Self.pointFile), options: .atomic)
    }
    let file = TransformsFile(frames: frames, pointFile: sorted.isEmpty ? nil : Self.pointFile)
    try file.json().write(to: url.appending(path: "transforms.json"), options: .atomic)
  }

  /// Removes everything.
  public func discard() throws {
    try FileManager.default.removeItem(at: url)
  }
}
