// swift-tools-version: 6.0
import PackageDescription

#if os(Linux)
  // Foundation on Linux refers to symbols of Observation that its shared library resolves at run time.
  let linkerSettings: [LinkerSetting] = [.unsafeFlags(["-Xlinker", "--allow-shlib-undefined"])]
#else
  let linkerSettings: [LinkerSetting] = []
#endif

let package = Package(
  name: "TrapezeKit",
  defaultLocalization: "en",
  platforms: [.iOS(.v17), .macOS(.v14)],
  products: [
    .library(name: "TrapezeKit", targets: ["TrapezeKit"])
  ],
  targets: [
    .target(name: "TrapezeKit", linkerSettings: linkerSettings),
    .testTarget(
      name: "TrapezeKitTests", dependencies: ["TrapezeKit"], resources: [.copy("Fixtures")]),
  ],
  swiftLanguageModes: [.v6]
)
