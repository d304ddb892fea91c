import Foundation
import Testing
import TrapezeBridge

@testable import TrapezeKit

@Suite struct EngineErrorTests {
  private func failure(_ body: () async throws -> Void) async -> EngineError? {
    do {
      try await body()
      return nil
    } catch {
      return error as? EngineError
    }
  }

  private func openFailure(_ location: URL) async -> EngineError? {
    await failure { _ = try await Engines.cpu.open(location).result() }
  }

  @Test func filesThatAreNotThereOrBrokenAreToldByName() async throws {
    let folder = try TemporaryFolder()
    let missing = await openFailure(folder.url.appending(path: "missing.ply"))
    #expect(missing?.code == .unreadableFile)
    #expect(missing?.message.contains("missing.ply") == true)

    let broken = folder.url.appending(path: "broken.ply")
    try Data("ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\n".utf8)
      .write(to: broken)
    let malformed = await openFailure(broken)
    #expect(malformed?.code == .malformedFile)
    #expect(malformed?.message.contains("broken.ply") == true)
    #expect(malformed?.message.contains("\n") == false)

    let sample = Repository.sampleScene.appending(path: "point_cloud.ply")
    let short = folder.url.appending(path: "short.ply")
    try Data(contentsOf: sample).prefix(100_000).write(to: short)
    #expect(await openFailure(short)?.code == .malformedFile)

    let empty = folder.url.appending(path: "empty")
    try FileManager.default.createDirectory(at: empty, withIntermediateDirectories: true)
    #expect(await openFailure(empty)?.code == .malformedFile)
  }

  @Test func aPanicOfTheCoreIsAnErrorLikeAnyOther() async throws {
    let fault = await failure { try callingCore { try provoke_panic("forced\nfault") } }
    #expect(fault == EngineError(.internalFault, "forced fault"))
    // And nothing is broken by it.
    _ = try await Engines.sampleScene()
  }

  @Test func argumentsOutsideTheirRangeAreRefused() async throws {
    let scene = try await Engines.sampleScene()
    let renderer = try await Engines.cpu.makeRenderer(for: scene, options: .init()).result()
    var camera = try Golden.all()[0].camera
    camera.width = -1
    let sizeless = await failure { _ = try await renderer.render(FrameRequest(camera: camera)) }
    #expect(sizeless?.code == .invalidArgument)
    #expect(sizeless?.message.contains("width") == true)

    let nothingLeft = await failure {
      _ = try await scene.applying([.delete([1, 2, 3, 4, 5])]).result()
    }
    #expect(nothingLeft?.code == .invalidEdit)
    let unknown = await failure { _ = try await scene.applying([.delete([77])]).result() }
    #expect(unknown?.code == .invalidEdit)
  }

  @Test func whatCannotBeWrittenIsToldByName() async throws {
    let scene = try await Engines.sampleScene()
    let nowhere = URL(filePath: "/proc/nowhere/scene.ply")
    let refused = await failure { _ = try await scene.export(to: nowhere, as: .ply).result() }
    #expect(refused?.code == .unwritableFile)
  }

  @Test func missingModelsAreToldAsSuch() async throws {
    let folder = try TemporaryFolder()
    let missing = await failure {
      _ = try await Engines.cpu.makeSearcher(models: folder.url).result()
    }
    #expect(missing?.code == .modelsMissing)
    #expect(missing?.message.contains("model.json") == true)
  }

  @Test func theCpuHasNoKernelsToCheck() async throws {
    let refused = await failure { _ = try await Engines.cpu.selfCheck().result() }
    #expect(refused?.code == .noDevice)
  }

  @Test func everyCodeOfTheContractIsOneOfTheCore() {
    #expect(EngineError.Code.allCases.map(\.rawValue) == Array(1...12))
  }
}
