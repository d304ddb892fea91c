import Foundation

@testable import TrapezeKit

/// The checkout that the tests run in.
enum Repository {
  static let root = URL(filePath: #filePath).deletingLastPathComponent()
    .appending(path: "../../../../..").standardizedFileURL
  static let sampleScene = root.appending(path: "assets/sample-scene")
  static let sampleDataset = root.appending(path: "assets/sample-dataset/transforms_static.json")
  static let searchModel = root.appending(path: "assets/search-model")
  static let goldens = root.appending(path: "tests/goldens/sample-scene")
}

/// A view of the sample scene, rendered by another program.
struct Golden: Decodable {
  let camera: Camera
  let time: Double
  let image: String

  static func all() throws -> [Golden] {
    let views = try Data(contentsOf: Repository.goldens.appending(path: "views.json"))
    return try JSONDecoder().decode([Golden].self, from: views)
  }

  /// Red, green and blue over black, in 8 bits.
  func pixels() throws -> [UInt8] {
    let file = try Data(contentsOf: Repository.goldens.appending(path: image))
    // 10 bytes, of which the last two are the length of the header that follows.
    let header = Int(file[8]) + 256 * Int(file[9])
    let values = file.dropFirst(10 + header)
    let expected = camera.width * camera.height * 4 * 2
    guard values.count == expected else { throw EngineError(.malformedFile, image) }
    var pixels: [UInt8] = []
    for pixel in stride(from: values.startIndex, to: values.endIndex, by: 8) {
      for channel in 0..<3 {
        let low = UInt16(values[pixel + 2 * channel])
        let high = UInt16(values[pixel + 2 * channel + 1])
        let value: Float = min(max(float(half: low + 256 * high), 0), 1)
        pixels.append(UInt8((value * 255).rounded()))
      }
    }
    return pixels
  }
}

/// IEEE half precision, without infinities and NaN. `Float16` is not on every Mac.
private func float(half: UInt16) -> Float {
  let exponent = Int((half >> 10) & 31)
  let fraction: Float = Float(half & 1023) / 1024
  let significand: Float = exponent == 0 ? fraction : 1 + fraction
  let magnitude = Float(sign: .plus, exponent: max(exponent, 1) - 15, significand: significand)
  return half >> 15 == 0 ? magnitude : -magnitude
}

/// Of 8-bit values, in dB.
func psnr(_ left: [UInt8], _ right: [UInt8]) -> Double {
  guard left.count == right.count, !left.isEmpty else { return .nan }
  var sum = 0.0
  for (a, b) in zip(left, right) {
    let difference = Double(a) - Double(b)
    sum += difference * difference
  }
  let meanSquare = sum / Double(left.count) / (255 * 255)
  return -10 * log10(meanSquare)
}

extension RenderedImage {
  /// Red, green and blue.
  var colors: [UInt8] {
    var colors: [UInt8] = []
    colors.reserveCapacity(3 * width * height)
    for pixel in stride(from: 0, to: rgba.count, by: 4) {
      colors.append(contentsOf: rgba[pixel..<pixel + 3])
    }
    return colors
  }

  /// Whether any colour at a pixel is not black.
  func isLit(_ x: Int, _ y: Int) -> Bool {
    let pixel = 4 * (y * width + x)
    return rgba[pixel..<pixel + 3].contains { $0 > 0 }
  }
}

/// The engines that there are here: the CPU always, a graphics device (Metal, or software Vulkan)
/// where one is installed.
enum Engines {
  static let cpu = SplatEngine(backend: .cpu)

  /// `nil`, loudly, without a device.
  static func gpu(for scene: any SceneEngine) async throws -> (any RenderEngine)? {
    do {
      return try await SplatEngine(backend: .gpu).makeRenderer(for: scene, options: .init())
        .result()
    } catch let error as EngineError where error.code == .noDevice {
      print("SKIPPED: rendering on a graphics device: \(error.message)")
      return nil
    }
  }

  static func sampleScene() async throws -> any SceneEngine {
    try await cpu.open(Repository.sampleScene).result()
  }
}
