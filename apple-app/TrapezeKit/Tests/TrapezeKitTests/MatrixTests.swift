import Foundation
import Testing

@testable import TrapezeKit

@Suite struct MatrixTests {
  /// A quarter turn about z, then a translation.
  private let rigid = Matrix4(
    rotationRows: (Vector3(0, -1, 0), Vector3(1, 0, 0), Vector3(0, 0, 1)),
    translation: Vector3(1, 2, 3))

  @Test func theRigidInverseUndoesTheTransform() {
    #expect(rigid * rigid.rigidInverse == .identity)
    #expect(rigid.rigidInverse.transform(rigid.transform(Vector3(4, 5, 6))) == Vector3(4, 5, 6))
  }

  @Test func jsonIsFourRowsOfFourNumbers() throws {
    let data = try JSONEncoder().encode(rigid)
    let rows = try JSONDecoder().decode([[Double]].self, from: data)
    #expect(rows[0] == [0, -1, 0, 1])
    #expect(try JSONDecoder().decode(Matrix4.self, from: data) == rigid)
  }

  @Test func aMatrixOfAnotherShapeIsRefused() {
    #expect(throws: DecodingError.self) {
      try JSONDecoder().decode(Matrix4.self, from: Data("[[1,2],[3,4]]".utf8))
    }
  }
}
