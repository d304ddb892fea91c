/// A pinhole camera with OpenCV axes: x right, y down, z forward; pixel centres at +0.5.
public struct Camera: Sendable, Equatable, Codable {
  /// Size of the image in pixels.
  public var width: Int
  public var height: Int
  /// Focal lengths in pixels.
  public var fx: Double
  public var fy: Double
  /// Principal point in pixels.
  public var cx: Double
  public var cy: Double
  /// Rigid transform from world to camera space.
  public var worldToCamera: Matrix4

  public init(
    width: Int, height: Int, fx: Double, fy: Double, cx: Double, cy: Double,
    worldToCamera: Matrix4
  ) {
    self.width = width
    self.height = height
    self.fx = fx
    self.fy = fy
    self.cx = cx
    self.cy = cy
    self.worldToCamera = worldToCamera
  }

  enum CodingKeys: String, CodingKey {
    case width, height, fx, fy, cx, cy
    case worldToCamera = "world_to_camera"
  }
}
