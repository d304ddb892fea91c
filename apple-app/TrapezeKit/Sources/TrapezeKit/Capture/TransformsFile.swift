import Foundation

/// `transforms.json` of a capture, as Nerfstudio defines it: pinhole intrinsics with every frame,
/// since autofocus changes them, and the sparse points beside it.
public struct TransformsFile: Sendable, Equatable, Codable {
  public struct Frame: Sendable, Equatable, Codable {
    /// Relative to the file.
    public var filePath: String
    /// Camera to world, OpenGL axes.
    public var transformMatrix: Matrix4
    public var fx: Double
    public var fy: Double
    public var cx: Double
    public var cy: Double
    public var width: Int
    public var height: Int

    enum CodingKeys: String, CodingKey {
      case filePath = "file_path"
      case transformMatrix = "transform_matrix"
      case fx = "fl_x"
      case fy = "fl_y"
      case cx, cy
      case width = "w"
      case height = "h"
    }

    public init(_ frame: CapturedFrame, filePath: String) {
      self.filePath = filePath
      transformMatrix = frame.cameraToWorld
      (fx, fy, cx, cy) = (frame.fx, frame.fy, frame.cx, frame.cy)
      (width, height) = (frame.width, frame.height)
    }
  }

  public var cameraModel = "PINHOLE"
  public var pointFile: String?
  public var frames: [Frame]

  enum CodingKeys: String, CodingKey {
    case cameraModel = "camera_model"
    case pointFile = "ply_file_path"
    case frames
  }

  public init(frames: [Frame], pointFile: String?) {
    self.frames = frames
    self.pointFile = pointFile
  }

  public func json() throws -> Data {
    let encoder = JSONEncoder()
    encoder.outputFormatting = [.prettyPrinted, .sortedKeys, .withoutEscapingSlashes]
    return try encoder.encode(self)
  }
}

/// Sparse points as binary PLY: x y z as floats, red green blue as bytes.
enum PointCloudFile {
  /// What a point without a colour gets.
  static let grey = SIMD3<UInt8>(repeating: 128)

  static func ply(_ points: [FeaturePoint]) -> Data {
    let points = points.filter(\.position.isFinite)
    let header = """
      ply
      format binary_little_endian 1.0
      element vertex \(points.count)
      property float x
      property float y
      property float z
      property uchar red
      property uchar green
      property uchar blue
      end_header

      """
    var data = Data(header.utf8)
    data.reserveCapacity(data.count + 15 * points.count)
    for point in points {
      for axis in 0..<3 {
        let bits = Float(point.position[axis]).bitPattern.littleEndian
        withUnsafeBytes(of: bits) { data.append(contentsOf: $0) }
      }
      let color = point.color ?? grey
      data.append(contentsOf: [color.x, color.y, color.z])
    }
    return data
  }
}
