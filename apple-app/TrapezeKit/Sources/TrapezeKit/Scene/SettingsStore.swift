import Foundation

/// Keeps the settings of scenes, one small JSON file for each.
public struct SettingsStore: Sendable {
  public let folder: URL

  public init(folder: URL) {
    self.folder = folder
  }

  /// Beside the app's other data.
  public static var standard: SettingsStore {
    SettingsStore(folder: StandardFolders.data.appending(path: "Scenes"))
  }

  /// Settings of a scene; the defaults when there are none or they cannot be read.
  public func load(_ key: SceneKey) -> SceneSettings {
    guard let data = try? Data(contentsOf: file(key)),
      let settings = try? JSONDecoder().decode(SceneSettings.self, from: data)
    else { return SceneSettings() }
    return settings
  }

  /// Replaces the file only when the new one is whole.
  public func save(_ settings: SceneSettings, for key: SceneKey) throws {
    try FileManager.default.createDirectory(at: folder, withIntermediateDirectories: true)
    let encoder = JSONEncoder()
    encoder.outputFormatting = [.prettyPrinted, .sortedKeys]
    try encoder.encode(settings).write(to: file(key), options: .atomic)
  }

  private func file(_ key: SceneKey) -> URL {
    folder.appending(path: "\(key.fingerprint).json")
  }
}

/// Recognises a scene: by its name and its numbers, not its path. A sandboxed app sees another path
/// after every update, and a scene that was moved is still the same.
public struct SceneKey: Sendable, Equatable {
  public let fingerprint: String

  public init(name: String, summary: SceneSummary) {
    let text =
      "\(name)|\(summary.splatCount)|\(summary.harmonicsDegree)|\(summary.memoryBytes)"
    fingerprint = String(Self.fnv1a(text.utf8), radix: 16)
  }

  /// FNV-1a, 64 bits: Swift's own hashes differ from launch to launch.
  private static func fnv1a(_ bytes: some Sequence<UInt8>) -> UInt64 {
    bytes.reduce(0xcbf2_9ce4_8422_2325) { ($0 ^ UInt64($1)) &* 0x100_0000_01b3 }
  }
}
