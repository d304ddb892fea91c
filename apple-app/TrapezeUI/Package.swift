// swift-tools-version: 6.0
import PackageDescription

// On Linux there is no SwiftUI. Stubs of Apple's modules, one set for UIKit and one for AppKit, let the
// compiler check everything that is ours; they prove nothing about Apple's side (docs/apple.md says
// what was compared with Apple's documentation). TRAPEZE_STUBS chooses the set.
#if os(Linux)
  /// Each stub and what it imports of the others.
  let shared: [String: [String]] = [
    "CoreGraphics": [], "CoreVideo": [], "UniformTypeIdentifiers": [],
    "QuartzCore": ["CoreGraphics"], "ImageIO": ["CoreGraphics"], "AVFoundation": ["CoreVideo"],
  ]
  let uiKit: [String: [String]] = [
    "UIKit": ["QuartzCore"], "ARKit": ["UIKit", "AVFoundation"], "CoreMotion": [],
    "CoreImage": ["CoreGraphics", "CoreVideo"],
    "SwiftUI": ["UIKit", "QuartzCore", "UniformTypeIdentifiers"],
  ]
  let appKit: [String: [String]] = [
    "AppKit": ["QuartzCore"], "Vision": ["AVFoundation"],
    "SwiftUI": ["AppKit", "QuartzCore", "UniformTypeIdentifiers"],
  ]
  let own = Context.environment["TRAPEZE_STUBS"] == "appkit" ? appKit : uiKit
  let stubTargets: [Target] = shared.merging(own) { $1 }.sorted { $0.key < $1.key }.map {
    .target(
      name: $0.key, dependencies: $0.value.map { .target(name: $0) }, path: "Stubs/\($0.key)")
  }
  let stubDependencies: [Target.Dependency] = stubTargets.map { .target(name: $0.name) }
  let linkerSettings: [LinkerSetting] = [.unsafeFlags(["-Xlinker", "--allow-shlib-undefined"])]
#else
  let stubTargets: [Target] = []
  let stubDependencies: [Target.Dependency] = []
  let linkerSettings: [LinkerSetting] = []
#endif

let package = Package(
  name: "TrapezeUI",
  defaultLocalization: "en",
  platforms: [.iOS(.v17), .macOS(.v14)],
  products: [
    .library(name: "TrapezeUI", targets: ["TrapezeUI"])
  ],
  dependencies: [
    .package(path: "../TrapezeKit")
  ],
  targets: [
    .target(
      name: "TrapezeUI",
      dependencies: [.product(name: "TrapezeKit", package: "TrapezeKit")] + stubDependencies,
      linkerSettings: linkerSettings),
    .testTarget(name: "TrapezeViewTests", dependencies: ["TrapezeUI"]),
  ] + stubTargets,
  swiftLanguageModes: [.v6]
)
