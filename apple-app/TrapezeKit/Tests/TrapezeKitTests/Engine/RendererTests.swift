import Foundation
import Testing

@testable import TrapezeKit

@Suite struct SplatRendererTests {
  /// The renderers that there are here, with a scene.
  private func renderers(of scene: any SceneEngine) async throws -> [any RenderEngine] {
    let cpu = try await Engines.cpu.makeRenderer(for: scene, options: .init()).result()
    return try await [cpu] + [Engines.gpu(for: scene)].compactMap { $0 }
  }

  @Test func framesMatchTheGoldens() async throws {
    let scene = try await Engines.sampleScene()
    for renderer in try await renderers(of: scene) {
      for golden in try Golden.all() {
        let request = FrameRequest(camera: golden.camera, time: golden.time)
        let image = try await renderer.render(request)
        // Both in 8 bits: only values near the middle of a step differ.
        let quality = psnr(image.colors, try golden.pixels())
        print("\(renderer.deviceName), \(golden.image): \(quality) dB")
        #expect(quality >= 60, "\(renderer.deviceName), \(golden.image)")
      }
    }
  }

  @Test func timeMovesTheSceneAndAMaskHoldsIt() async throws {
    let scene = try await Engines.sampleScene()
    let camera = try Golden.all()[0].camera
    for renderer in try await renderers(of: scene) {
      let start = try await renderer.render(FrameRequest(camera: camera, time: 0))
      let later = try await renderer.render(FrameRequest(camera: camera, time: 0.5))
      #expect(psnr(start.colors, later.colors) < 40)
      let everything = try #require(scene.staticThreshold(percentile: 100))
      let held = try await renderer.render(
        FrameRequest(camera: camera, time: 0.5, staticThreshold: everything))
      #expect(held == start)
    }
  }

  @Test func clustersAreSelectedIsolatedAndHidden() async throws {
    let scene = try await Engines.sampleScene()
    let camera = try Golden.all()[0].camera
    for renderer in try await renderers(of: scene) {
      let everything = FrameRequest(camera: camera, time: 0.1)
      let (x, y, hit) = try #require(try await firstHit(renderer, everything))
      let cluster = try #require(hit.cluster)
      #expect(scene.clusters.contains { $0.id == cluster })
      #expect(hit.splat < scene.summary.splatCount && hit.depth > 0)

      var isolated = everything
      isolated.visibility = .isolate([cluster])
      #expect(try await renderer.pick(isolated, x: x, y: y)?.cluster == cluster)
      let alone = try await renderer.render(isolated)
      var hidden = everything
      hidden.visibility = .hide([cluster])
      #expect(try await renderer.pick(hidden, x: x, y: y)?.cluster != cluster)
      let without = try await renderer.render(hidden)
      let whole = try await renderer.render(everything)
      #expect(alone != whole && without != whole && alone != without)
      #expect(alone.isLit(x, y))

      var none = everything
      none.visibility = .isolate([])
      #expect(try await renderer.render(none).colors.allSatisfy { $0 == 0 })
      // A cluster that an edit has taken away selects nothing.
      none.visibility = .isolate([4_000_000_000])
      #expect(try await renderer.pick(none, x: x, y: y) == nil)
      #expect(try await renderer.pick(everything, x: -1, y: 0) == nil)
      #expect(try await renderer.pick(everything, x: camera.width, y: 0) == nil)
    }
  }

  /// A pixel near the middle that shows something.
  private func firstHit(
    _ renderer: any RenderEngine, _ request: FrameRequest
  ) async throws -> (Int, Int, PickResult)? {
    let middle = (request.camera.width / 2, request.camera.height / 2)
    for distance in stride(from: 0, to: 150, by: 10) {
      let (x, y) = (middle.0 + distance, middle.1)
      if let hit = try await renderer.pick(request, x: x, y: y) { return (x, y, hit) }
    }
    return nil
  }

  @Test func everyModeShowsSomethingElse() async throws {
    let scene = try await Engines.sampleScene()
    let camera = try Golden.all()[1].camera
    let background = RGBColor(red: 0, green: 0, blue: 1)
    for renderer in try await renderers(of: scene) {
      var images: [RenderedImage] = []
      for mode in FrameRequest.Mode.allCases {
        let request = FrameRequest(
          camera: camera, time: 0.5, mode: mode, background: background)
        images.append(try await renderer.render(request))
      }
      for (i, image) in images.enumerated() {
        #expect(!images[..<i].contains(image))
        // The corner shows what is behind the scene, opaque.
        #expect(Array(image.rgba[..<4]) == [0, 0, 255, 255])
      }
    }
  }

  @Test func drawingTellsWhatItCosts() async throws {
    let scene = try await Engines.sampleScene()
    let camera = try Golden.all()[0].camera
    for renderer in try await renderers(of: scene) {
      var request = FrameRequest(camera: camera, time: 0.2)
      var report = try await renderer.draw(request)
      while report.needsRedraw { report = try await renderer.draw(request) }
      #expect(report.stats.totalSplats == scene.summary.splatCount)
      #expect(report.stats.deformedSplats == scene.summary.splatCount)
      #expect(report.stats.visibleSplats > 1_000)
      #expect(try #require(report.stats.frameSeconds) > 0)
      request.staticThreshold = scene.staticThreshold(percentile: 50)
      let masked = try await renderer.draw(request).stats.deformedSplats
      #expect(masked > 0 && masked <= scene.summary.splatCount / 2 + 1)

      await renderer.suspend()
      #expect(try await renderer.draw(request).needsRedraw, "nothing is submitted")
      await #expect(throws: EngineError.self) { try await renderer.render(request) }
      await renderer.resume()
      await renderer.shedMemory()
      #expect(try await renderer.render(request).width == camera.width)
    }
  }

  @Test func aRendererShowsAnotherScene() async throws {
    let scene = try await Engines.sampleScene()
    let part = try await scene.applying([.keep([3])]).result()
    let request = FrameRequest(camera: try Golden.all()[0].camera)
    for renderer in try await renderers(of: scene) {
      var isolated = request
      isolated.visibility = .isolate([3])
      let expected = try await renderer.render(isolated)
      try await renderer.show(part, options: .init()).result()
      #expect(psnr(try await renderer.render(request).colors, expected.colors) > 60)
    }
  }

  @Test func speedAndErrorComeTogether() async throws {
    let scene = try await Engines.sampleScene()
    var camera = try Golden.all()[0].camera
    camera = Camera(
      width: 100, height: 100, fx: camera.fx / 4, fy: camera.fy / 4, cx: 50, cy: 50,
      worldToCamera: camera.worldToCamera)
    let renderer = try await Engines.cpu.makeRenderer(for: scene, options: .init()).result()
    let variants = [
      FrameVariant(precision: .single, staticPercentile: nil),
      FrameVariant(precision: .single, staticPercentile: 100),
    ]
    var fractions: [Double] = []
    let measured = try await renderer.measure(variants, camera: camera, times: [0.3, 0.7])
      .result { if $0.stage == .measuring, let f = $0.fraction { fractions.append(f) } }
    #expect(measured.map(\.variant) == variants)
    #expect(measured[0].psnr == nil, "the same frames")
    #expect(try #require(measured[1].psnr) < 40)
    #expect(measured.allSatisfy { $0.frameMilliseconds > 0 })
    #expect(fractions == fractions.sorted())
  }

  @Test func twoScenesAreDrawnAtOnceFromDifferentThreads() async throws {
    let whole = try await Engines.sampleScene()
    let part = try await whole.applying([.keep([2, 3])]).result()
    let request = FrameRequest(camera: try Golden.all()[2].camera, time: 0.9)
    let engine = SplatEngine()
    func draw(_ scene: any SceneEngine) async throws -> [RenderedImage] {
      let renderer = try await engine.makeRenderer(for: scene, options: .init()).result()
      var images: [RenderedImage] = []
      for _ in 0..<4 { images.append(try await renderer.render(request)) }
      return images
    }
    async let first = draw(whole)
    async let second = draw(part)
    let (a, b) = try await (first, second)
    let alone = try await draw(whole)
    #expect(a == alone, "a neighbour changes no bit")
    #expect(b.allSatisfy { $0 == b[0] } && a[0] != b[0])
  }

  #if !canImport(Darwin)
    @Test func aLayerIsRefusedWhereThereAreNone() async throws {
      let scene = try await Engines.sampleScene()
      let renderer = try await Engines.cpu.makeRenderer(for: scene, options: .init()).result()
      let memory = UnsafeMutableRawPointer.allocate(byteCount: 16, alignment: 16)
      defer { memory.deallocate() }
      let address = LayerPointer(memory)
      await #expect(throws: EngineError.self) {
        try await renderer.attach(address, width: 10, height: 10)
      }
      try await renderer.attach(nil, width: 0, height: 0)
    }
  #endif
}
