import Foundation

extension Camera {
  /// Where a point is seen, in pixels, and how deep; `nil` at and behind the near plane.
  public func project(_ point: Vector3) -> (x: Double, y: Double, depth: Double)? {
    let p = worldToCamera.transform(point)
    guard p.z > 0.01 else { return nil }
    return (fx * p.x / p.z + cx, fy * p.y / p.z + cy, p.z)
  }

  /// The point that is seen at a pixel, at a depth along the view axis. The transform is rigid.
  public func unproject(x: Double, y: Double, depth: Double) -> Vector3 {
    worldToCamera.rigidInverse.transform(
      Vector3((x - cx) / fx * depth, (y - cy) / fy * depth, depth))
  }
}

/// The edges of a box as lines on the screen: marks selected clusters and the crop box.
public struct BoxOutline: Sendable, Equatable {
  public struct Segment: Sendable, Equatable {
    public var start: SIMD2<Double>
    public var end: SIMD2<Double>
  }

  /// In pixels; edges are cut where they pass the near plane.
  public var segments: [Segment]

  public init(_ bounds: Bounds, camera: Camera) {
    let corners = bounds.corners.map(camera.worldToCamera.transform)
    segments = Self.edges.compactMap { Self.segment(corners[$0], corners[$1], camera) }
  }

  /// Pairs of corners that differ in one bit, which is one axis.
  private static let edges = (0..<8).flatMap { corner in
    [1, 2, 4].filter { corner & $0 == 0 }.map { (corner, corner | $0) }
  }

  private static let near = 0.01

  private static func segment(_ a: Vector3, _ b: Vector3, _ camera: Camera) -> Segment? {
    guard a.isFinite, b.isFinite, max(a.z, b.z) > near else { return nil }
    return Segment(start: image(cut(a, b), camera), end: image(cut(b, a), camera))
  }

  /// `a`, or where the edge to `b` passes the near plane when `a` is behind it.
  private static func cut(_ a: Vector3, _ b: Vector3) -> Vector3 {
    a.z >= near ? a : a + (b - a) * ((near - a.z) / (b.z - a.z))
  }

  private static func image(_ p: Vector3, _ camera: Camera) -> SIMD2<Double> {
    let z = max(p.z, near)
    return SIMD2(camera.fx * p.x / z + camera.cx, camera.fy * p.y / z + camera.cy)
  }
}
