/// What ARKit tells about one picture.
public struct CapturedFrame: Sendable, Equatable, Codable {
  /// Seconds of ARKit's clock.
  public var timestamp: Double
  /// Camera to world. ARKit's camera axes are those of `transforms.json` already: x right, y up,
  /// z backwards, for the picture as the sensor delivers it (landscape, home button right), however
  /// the phone is held.
  public var cameraToWorld: Matrix4
  /// Focal lengths and principal point in pixels of the picture, from its upper left corner.
  public var fx: Double
  public var fy: Double
  public var cx: Double
  public var cy: Double
  public var width: Int
  public var height: Int
  /// Whether the pose can be trusted.
  public var isTrackingNormal: Bool

  public init(
    timestamp: Double, cameraToWorld: Matrix4, fx: Double, fy: Double, cx: Double, cy: Double,
    width: Int, height: Int, isTrackingNormal: Bool
  ) {
    self.timestamp = timestamp
    self.cameraToWorld = cameraToWorld
    self.fx = fx
    self.fy = fy
    self.cx = cx
    self.cy = cy
    self.width = width
    self.height = height
    self.isTrackingNormal = isTrackingNormal
  }

  var position: Vector3 { cameraToWorld.translation }
  /// Where the camera looks: its z axis points backwards.
  var forward: Vector3 {
    let (x, y, z) = cameraToWorld.rotationRows
    return -Vector3(x.z, y.z, z.z)
  }

  var isFinite: Bool {
    let rows = [
      cameraToWorld.rows.0, cameraToWorld.rows.1, cameraToWorld.rows.2, cameraToWorld.rows.3,
    ]
    return rows.allSatisfy { $0.xyz.isFinite && $0.w.isFinite }
      && [fx, fy, cx, cy].allSatisfy(\.isFinite)
  }
}

/// A point that ARKit recognises from picture to picture.
public struct FeaturePoint: Sendable, Equatable, Codable {
  public var id: UInt64
  public var position: Vector3
  /// Colour in the picture, 0–255; `nil` where it was not looked up.
  public var color: SIMD3<UInt8>?

  public init(id: UInt64, position: Vector3, color: SIMD3<UInt8>?) {
    self.id = id
    self.position = position
    self.color = color
  }
}
