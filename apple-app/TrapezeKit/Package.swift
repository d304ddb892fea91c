// swift-tools-version: 6.0
import Foundation
import PackageDescription

// The core, as C functions. On Apple systems an xcframework of static libraries, which
// `scripts/build-xcframework` makes; on Linux the headers, and the static library that
// `scripts/build-bridge` makes.
#if os(Linux)
  let library =
    Context.environment["TRAPEZE_LIBRARY_DIR"] ?? "\(Context.packageDirectory)/../../target/swift"
  let core = Target.target(
    name: "CTrapeze",
    linkerSettings: [
      .unsafeFlags(["-L\(library)"]), .linkedLibrary("trapeze_bridge"), .linkedLibrary("m"),
      .linkedLibrary("dl"), .linkedLibrary("pthread"),
    ])
  let runtime: [Target] = []
  // Foundation on Linux refers to symbols of Observation that its shared library resolves at run time.
  let linkerSettings: [LinkerSetting] = [.unsafeFlags(["-Xlinker", "--allow-shlib-undefined"])]
#else
  let core = Target.binaryTarget(name: "CTrapeze", path: "Frameworks/CTrapeze.xcframework")
  // What text search runs on, in the Mac's app; the core finds it among the app's frameworks. Without
  // it the app says what is missing.
  let runtimePath = "Frameworks/ONNXRuntime.xcframework"
  let runtime: [Target] =
    FileManager.default.fileExists(atPath: "\(Context.packageDirectory)/\(runtimePath)")
    ? [.binaryTarget(name: "ONNXRuntime", path: runtimePath)] : []
  let linkerSettings: [LinkerSetting] = [
    .linkedFramework("Metal"), .linkedFramework("QuartzCore"), .linkedFramework("CoreGraphics"),
    .linkedFramework("IOKit", .when(platforms: [.macOS])), .linkedLibrary("c++"),
    .linkedLibrary("objc"), .linkedFramework("CoreML"),
  ]
#endif

let package = Package(
  name: "TrapezeKit",
  defaultLocalization: "en",
  platforms: [.iOS(.v17), .macOS(.v14)],
  products: [
    .library(name: "TrapezeKit", targets: ["TrapezeKit"])
  ],
  targets: [
    core,
    .target(
      name: "TrapezeBridge",
      dependencies: ["CTrapeze"]
        + runtime.map { .target(name: $0.name, condition: .when(platforms: [.macOS])) }),
    .target(
      name: "TrapezeKit", dependencies: ["TrapezeBridge"], linkerSettings: linkerSettings),
    .testTarget(
      name: "TrapezeKitTests", dependencies: ["TrapezeKit", "TrapezeBridge"],
      resources: [.copy("Fixtures")]),
  ] + runtime,
  swiftLanguageModes: [.v6]
)
