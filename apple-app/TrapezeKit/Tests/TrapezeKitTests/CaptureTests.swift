import Foundation
import Testing

@testable import TrapezeKit

@Suite struct KeyframePolicyTests {
  private func frame(_ x: Double, at seconds: Double, yaw: Double = 0, isGood: Bool = true)
    -> CapturedFrame
  {
    CapturedFrame(
      timestamp: seconds,
      cameraToWorld: Matrix4(
        rotationRows: (
          Vector3(cos(yaw), 0, sin(yaw)), Vector3(0, 1, 0), Vector3(-sin(yaw), 0, cos(yaw))
        ), translation: Vector3(x, 0, 0)),
      fx: 1, fy: 1, cx: 1, cy: 1, width: 2, height: 2, isTrackingNormal: isGood)
  }

  @Test func picturesAreKeptFromNewPlacesAndDirections() {
    var policy = KeyframePolicy()
    #expect(policy.consider(frame(0, at: 0)) == nil)
    #expect(policy.consider(frame(0.01, at: 1)) == .tooClose)
    #expect(policy.consider(frame(0.08, at: 2)) == nil)
    #expect(policy.consider(frame(0.08, at: 3, yaw: 0.2)) == nil)
    #expect(policy.keptCount == 3)
  }

  @Test func blurredAndLostPicturesAreNot() {
    var policy = KeyframePolicy()
    #expect(policy.consider(frame(0, at: 0, isGood: false)) == .poorTracking)
    #expect(policy.consider(frame(.nan, at: 1)) == .poorTracking)
    #expect(policy.consider(frame(0, at: 2)) == nil)
    #expect(policy.consider(frame(0.2, at: 2.1)) == .tooFast)
    #expect(policy.consider(frame(0.2, at: 2.2, yaw: 0.5)) == .tooFast)
    #expect(policy.consider(frame(0.2, at: 2.3, yaw: 0.5)) == nil)
  }

  @Test func thereIsAnEnd() {
    var policy = KeyframePolicy()
    policy.capacity = 2
    for place in 0..<2 {
      #expect(policy.consider(frame(Double(place), at: Double(place * 9))) == nil)
    }
    #expect(policy.consider(frame(5, at: 99)) == .full)
  }
}

@Suite struct CaptureFolderTests {
  /// Poses, intrinsics and points as a session delivers them, one frame a line.
  static func recording() throws -> [Recorded] {
    let url = try #require(
      Bundle.module.url(forResource: "capture", withExtension: "jsonl", subdirectory: "Fixtures"))
    return try String(contentsOf: url, encoding: .utf8).split(separator: "\n").map {
      try JSONDecoder().decode(Recorded.self, from: Data($0.utf8))
    }
  }

  struct Recorded: Codable {
    var frame: CapturedFrame
    var points: [FeaturePoint]
  }

  @Test func aRecordingBecomesTheCommittedDataset() async throws {
    let temporary = try TemporaryFolder()
    let place = temporary.url.appending(path: "capture")
    let folder = try CaptureFolder(creating: place)
    let recording = try Self.recording()
    for entry in recording {
      try await folder.append(entry.frame, jpeg: Data([0xff, 0xd8]), points: entry.points)
    }
    try await folder.finish()
    #expect(await folder.frameCount == recording.count)
    let fixtures = try #require(Bundle.module.resourceURL).appending(path: "Fixtures/capture")
    // The same files are read by the core's tests, whose dataset reader is what trains on them.
    func read(_ folder: URL) throws -> TransformsFile {
      let data = try Data(contentsOf: folder.appending(path: "transforms.json"))
      return try JSONDecoder().decode(TransformsFile.self, from: data)
    }
    #expect(try read(place) == read(fixtures))
    let points = try Data(contentsOf: place.appending(path: "points.ply"))
    #expect(try points == Data(contentsOf: fixtures.appending(path: "points.ply")))
    let image = place.appending(path: "images/00001.jpg")
    #expect(FileManager.default.fileExists(atPath: image.path))
  }

  @Test func pointsAreRefinedAndKeepTheirColour() async throws {
    let temporary = try TemporaryFolder()
    let folder = try CaptureFolder(creating: temporary.url.appending(path: "c"))
    let frame = try #require(try Self.recording().first).frame
    let red = SIMD3<UInt8>(255, 0, 0)
    try await folder.append(
      frame, jpeg: Data(),
      points: [FeaturePoint(id: 9, position: Vector3(1, 1, 1), color: red)])
    try await folder.append(
      frame, jpeg: Data(),
      points: [FeaturePoint(id: 9, position: Vector3(2, 1, 1), color: nil)])
    try await folder.finish()
    #expect(await folder.pointCount == 1)
    let ply = try Data(contentsOf: temporary.url.appending(path: "c/points.ply"))
    // x = 2 as a little-endian float, y and z = 1, then the colour.
    #expect(Array(ply.suffix(15)) == [0, 0, 0, 64, 0, 0, 128, 63, 0, 0, 128, 63, 255, 0, 0])
  }

  @Test func anExistingFolderIsNotOverwritten() throws {
    let temporary = try TemporaryFolder()
    #expect(throws: (any Error).self) { try CaptureFolder(creating: temporary.url) }
  }
}

@MainActor @Suite struct CaptureModelTests {
  @Test func aCaptureGoesFromTheFirstPictureToADataset() async throws {
    let temporary = try TemporaryFolder()
    let model = CaptureModel(root: temporary.url)
    let recording = try CaptureFolderTests.recording()
    model.start()
    #expect(model.phase == .recording && !model.canFinish)
    for entry in recording where model.wants(entry.frame) {
      model.keep(entry.frame, jpeg: Data([1]), points: entry.points)
    }
    await model.settle()
    #expect(model.keptCount == recording.count && model.pointCount > 0)
    await model.finish()
    guard case .finished(let place) = model.phase else { throw EngineError(.internalFault, "") }
    #expect(FileManager.default.fileExists(atPath: place.appending(path: "transforms.json").path))
  }

  @Test func hintsTellWhyNothingIsKept() throws {
    let temporary = try TemporaryFolder()
    let model = CaptureModel(root: temporary.url)
    var frame = try #require(try CaptureFolderTests.recording().first).frame
    #expect(!model.wants(frame))
    model.start()
    frame.isTrackingNormal = false
    #expect(!model.wants(frame) && model.hint == .poorTracking)
    frame.isTrackingNormal = true
    #expect(model.wants(frame) && model.hint == nil)
  }

  @Test func cancellingLeavesNothing() async throws {
    let temporary = try TemporaryFolder()
    let model = CaptureModel(root: temporary.url)
    model.start()
    await model.cancel()
    #expect(model.phase == .idle)
    #expect(try FileManager.default.contentsOfDirectory(atPath: temporary.url.path).isEmpty)
  }

  @Test func aFullDiskIsAnAlert() async throws {
    let model = CaptureModel(root: URL(filePath: "/proc/none"))
    model.start()
    #expect(model.phase == .idle && model.failure?.advice == .freeStorage)
  }

  @Test func namesSortByTime() {
    let early = CaptureModel.name(Date(timeIntervalSince1970: 1_000_000))
    let late = CaptureModel.name(Date(timeIntervalSince1970: 900_000_000))
    #expect(early < late && !early.contains(":") && !early.contains("/"))
  }
}
