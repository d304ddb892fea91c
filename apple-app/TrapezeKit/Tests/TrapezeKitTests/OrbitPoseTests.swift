import Foundation
import Testing

@testable import TrapezeKit

@Suite struct OrbitPoseTests {
  private let viewport = Viewport(width: 400, height: 300, scale: 2)

  private func randomPose(_ random: inout RandomNumbers) -> OrbitPose {
    OrbitPose(
      target: Vector3(
        .random(in: -9...9, using: &random), .random(in: -9...9, using: &random),
        .random(in: -9...9, using: &random)),
      distance: .random(in: 0.1...100, using: &random),
      azimuth: .random(in: -10...10, using: &random),
      elevation: .random(in: -2...2, using: &random),
      up: UpAxis.allCases.randomElement(using: &random)?.direction ?? .zero)
  }

  @Test func axesAreARightHandedOrthonormalFrameInEveryPose() {
    var random = RandomNumbers(seed: 1)
    for _ in 0..<2_000 {
      let (right, down, forward) = randomPose(&random).axes
      // A dozen operations on numbers of size 1 each round at 1.1e-16.
      for (a, b) in [(right, down), (down, forward), (forward, right)] {
        #expect(abs(a.dot(b)) < 1e-14)
      }
      #expect(right.cross(down).distance(to: forward) < 1e-14)
      #expect(abs(right.length - 1) < 1e-14)
    }
  }

  @Test func theTargetIsInTheMiddleAtItsDistance() throws {
    var random = RandomNumbers(seed: 2)
    for _ in 0..<500 {
      let pose = randomPose(&random)
      let camera = pose.camera(in: viewport)
      let seen = try #require(camera.project(pose.target))
      // Positions up to 100 away lose 1e-14; a focal length of some hundred pixels makes 1e-10.
      #expect(abs(seen.x - 400) < 1e-9 && abs(seen.y - 300) < 1e-9)
      #expect(abs(seen.depth - pose.distance) < 1e-12 * 100)
      #expect(camera.worldToCamera.rigidInverse.translation.distance(to: pose.eye) < 1e-10)
    }
  }

  @Test func cameraAgreesWithTheCoresAutoFraming() throws {
    // Rust: Orbit { azimuth: 0, elevation: 0, up: Z } looks along +y from (0, -, 0) … to (0, +, 0):
    // front is y where up is z, so the eye is on the side of +y.
    let pose = OrbitPose(up: UpAxis.plusZ.direction)
    #expect(pose.eye.distance(to: Vector3(0, 1, 0)) < 1e-15)
    let right = OrbitPose(azimuth: .pi / 2, up: UpAxis.plusZ.direction)
    #expect(right.eye.distance(to: Vector3(-1, 0, 0)) < 1e-15)
  }

  @Test func framingShowsEveryCornerOfTheBox() throws {
    var random = RandomNumbers(seed: 3)
    for viewport in [viewport, Viewport(width: 100, height: 900)] {
      for _ in 0..<300 {
        let low = Vector3(
          .random(in: -5...5, using: &random), .random(in: -5...5, using: &random), 0)
        let bounds = Bounds(
          min: low,
          max: low
            + Vector3(
              .random(in: 0...4, using: &random), .random(in: 0...4, using: &random),
              .random(in: 0...4, using: &random)))
        let camera = randomPose(&random).framing(bounds, in: viewport).camera(in: viewport)
        for corner in bounds.corners {
          let seen = try #require(camera.project(corner))
          #expect((-1e-6...Double(camera.width) + 1e-6).contains(seen.x))
          #expect((-1e-6...Double(camera.height) + 1e-6).contains(seen.y))
        }
      }
    }
  }

  @Test func reorientingKeepsTheEye() {
    var random = RandomNumbers(seed: 4)
    for _ in 0..<500 {
      let pose = randomPose(&random)
      let axis = UpAxis.allCases.randomElement(using: &random)?.direction ?? .zero
      let turned = pose.reorienting(up: axis)
      // Near a pole asin loses half the digits.
      #expect(turned.eye.distance(to: pose.eye) < 1e-6 * pose.distance)
      #expect(turned.up == axis)
    }
  }

  @Test func reorientingAtAPoleKeepsTheImagesRight() {
    let pose = OrbitPose(azimuth: 0.4, elevation: 0, up: UpAxis.plusZ.direction)
    let pole = pose.reorienting(up: pose.direction)
    #expect(pole.elevation > .pi / 2 - 1e-6)
    #expect(pole.axes.right.distance(to: pose.axes.right) < 1e-9)
  }

  @Test func interpolationEndsWhereItShouldAndGoesTheShortWay() {
    let start = OrbitPose(distance: 1, azimuth: 3)
    let end = OrbitPose(distance: 100, azimuth: -3)
    #expect(start.interpolated(to: end, at: 1) == end)
    let middle = start.interpolated(to: end, at: 0.5)
    #expect(abs(middle.distance - 10) < 1e-12)
    // From 3 to −3 over π, not over 0.
    #expect(abs(abs(wrappedAngle(middle.azimuth)) - .pi) < 1e-12)
  }

  @Test func unprojectingUndoesProjecting() throws {
    var random = RandomNumbers(seed: 5)
    let camera = randomPose(&random).camera(in: viewport)
    let point = camera.unproject(x: 120, y: 410, depth: 3)
    let seen = try #require(camera.project(point))
    #expect(abs(seen.x - 120) < 1e-9 && abs(seen.y - 410) < 1e-9 && abs(seen.depth - 3) < 1e-12)
  }

  @Test func aPoseSurvivesJson() throws {
    var random = RandomNumbers(seed: 6)
    let pose = randomPose(&random)
    let data = try JSONEncoder().encode(pose)
    #expect(try JSONDecoder().decode(OrbitPose.self, from: data) == pose)
  }

  @Test func boxOutlinesAreCutAtTheNearPlane() {
    let camera = OrbitPose(distance: 1).camera(in: viewport)
    let around = Bounds(min: Vector3(-5, -5, -5), max: Vector3(5, 5, 5))
    let outline = BoxOutline(around, camera: camera)
    #expect(!outline.segments.isEmpty)
    #expect(outline.segments.allSatisfy { $0.start.x.isFinite && $0.end.y.isFinite })
    let front = Bounds(min: Vector3(-0.1, -0.1, -0.1), max: Vector3(0.1, 0.1, 0.1))
    #expect(BoxOutline(front, camera: camera).segments.count == 12)
    let behind = Bounds(min: Vector3(0, 0, 2), max: Vector3(1, 1, 3))
    #expect(BoxOutline(behind, camera: camera).segments.isEmpty)
  }
}
