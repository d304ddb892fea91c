/// A 4 × 4 matrix, row by row. In JSON: four rows of four numbers.
public struct Matrix4: Sendable, Equatable {
  public var rows: (SIMD4<Double>, SIMD4<Double>, SIMD4<Double>, SIMD4<Double>)

  public init(
    _ first: SIMD4<Double>, _ second: SIMD4<Double>, _ third: SIMD4<Double>,
    _ fourth: SIMD4<Double>
  ) {
    rows = (first, second, third, fourth)
  }

  public static let identity = Matrix4(
    SIMD4(1, 0, 0, 0), SIMD4(0, 1, 0, 0), SIMD4(0, 0, 1, 0), SIMD4(0, 0, 0, 1))

  /// A rotation given by its rows, then a translation.
  public init(rotationRows: (Vector3, Vector3, Vector3), translation: Vector3) {
    self.init(
      SIMD4(rotationRows.0, translation.x),
      SIMD4(rotationRows.1, translation.y),
      SIMD4(rotationRows.2, translation.z),
      SIMD4(0, 0, 0, 1)
    )
  }

  public static func == (left: Self, right: Self) -> Bool { left.rows == right.rows }

  public static func * (left: Self, right: Self) -> Self {
    let columns = right.transposed.rows
    func row(_ r: SIMD4<Double>) -> SIMD4<Double> {
      SIMD4(
        (r * columns.0).sum(), (r * columns.1).sum(), (r * columns.2).sum(), (r * columns.3).sum())
    }
    let rows = left.rows
    return Matrix4(row(rows.0), row(rows.1), row(rows.2), row(rows.3))
  }

  public var transposed: Self {
    Matrix4(
      SIMD4(rows.0.x, rows.1.x, rows.2.x, rows.3.x),
      SIMD4(rows.0.y, rows.1.y, rows.2.y, rows.3.y),
      SIMD4(rows.0.z, rows.1.z, rows.2.z, rows.3.z),
      SIMD4(rows.0.w, rows.1.w, rows.2.w, rows.3.w)
    )
  }

  /// The point moved by an affine transform.
  public func transform(_ point: Vector3) -> Vector3 {
    let p = SIMD4(point, 1)
    return Vector3((rows.0 * p).sum(), (rows.1 * p).sum(), (rows.2 * p).sum())
  }

  /// The rows of the linear part.
  public var rotationRows: (Vector3, Vector3, Vector3) {
    (rows.0.xyz, rows.1.xyz, rows.2.xyz)
  }

  public var translation: Vector3 { Vector3(rows.0.w, rows.1.w, rows.2.w) }

  /// The inverse of a rotation and a translation: of a rigid transform only.
  public var rigidInverse: Self {
    let (x, y, z) = rotationRows
    let t = translation
    let columns = (
      Vector3(x.x, y.x, z.x), Vector3(x.y, y.y, z.y), Vector3(x.z, y.z, z.z)
    )
    return Matrix4(
      rotationRows: columns,
      translation: -Vector3(columns.0.dot(t), columns.1.dot(t), columns.2.dot(t)))
  }
}

extension SIMD4 {
  var xyz: SIMD3<Scalar> { SIMD3(x, y, z) }
}

extension Matrix4: Codable {
  public init(from decoder: any Decoder) throws {
    let rows = try decoder.singleValueContainer().decode([[Double]].self)
    guard rows.count == 4, rows.allSatisfy({ $0.count == 4 }) else {
      throw DecodingError.dataCorrupted(
        DecodingError.Context(
          codingPath: decoder.codingPath, debugDescription: "expected four rows of four numbers"))
    }
    let vectors = rows.map { SIMD4($0[0], $0[1], $0[2], $0[3]) }
    self.init(vectors[0], vectors[1], vectors[2], vectors[3])
  }

  public func encode(to encoder: any Encoder) throws {
    let vectors = [rows.0, rows.1, rows.2, rows.3]
    var container = encoder.singleValueContainer()
    try container.encode(vectors.map { [$0.x, $0.y, $0.z, $0.w] })
  }
}
