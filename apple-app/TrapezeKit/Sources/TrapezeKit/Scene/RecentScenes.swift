import Foundation
import Observation

/// Scenes that were opened lately, newest first.
@MainActor @Observable
public final class RecentScenes {
  public struct Entry: Sendable, Equatable, Codable, Identifiable {
    /// What the system needs to open the file again; names the entry as well.
    public let bookmark: Data
    public var name: String
    public var opened: Date

    public var id: Data { bookmark }
  }

  /// The system's bookmarks; tests use paths.
  public struct Bookmarks: Sendable {
    public var make: @Sendable (URL) throws -> Data
    public var resolve: @Sendable (Data) throws -> URL

    public init(
      make: @escaping @Sendable (URL) throws -> Data,
      resolve: @escaping @Sendable (Data) throws -> URL
    ) {
      self.make = make
      self.resolve = resolve
    }
  }

  public static let capacity = 20

  public private(set) var entries: [Entry]
  private let file: URL
  private let bookmarks: Bookmarks

  public init(file: URL, bookmarks: Bookmarks = .system) {
    self.file = file
    self.bookmarks = bookmarks
    let data = try? Data(contentsOf: file)
    entries = data.flatMap { try? JSONDecoder().decode([Entry].self, from: $0) } ?? []
  }

  /// Puts a scene in front. The right to read it has to be held at this moment.
  public func add(_ url: URL, at date: Date = Date()) {
    guard let bookmark = try? bookmarks.make(url) else { return }
    // Two bookmarks of one file differ in their bytes, so entries are compared by place.
    let place = url.standardizedFileURL
    entries.removeAll { entry in
      (try? bookmarks.resolve(entry.bookmark))?.standardizedFileURL == place
    }
    entries.insert(
      Entry(bookmark: bookmark, name: url.lastPathComponent, opened: date), at: 0)
    entries = Array(entries.prefix(Self.capacity))
    save()
  }

  /// Where the scene is now, which may not be where it was.
  public func resolve(_ entry: Entry) throws -> URL {
    do {
      return try bookmarks.resolve(entry.bookmark)
    } catch {
      throw EngineError(.unreadableFile, "\(entry.name): moved or deleted")
    }
  }

  public func remove(_ entry: Entry) {
    entries.removeAll { $0.id == entry.id }
    save()
  }

  public func clear() {
    entries = []
    save()
  }

  private func save() {
    // A list that cannot be saved is shorter next time; nothing to bother a person with.
    try? FileManager.default.createDirectory(
      at: file.deletingLastPathComponent(), withIntermediateDirectories: true)
    try? JSONEncoder().encode(entries).write(to: file, options: .atomic)
  }
}

extension RecentScenes.Bookmarks {
  public static var system: Self {
    #if os(macOS)
      Self(
        make: {
          try $0.bookmarkData(
            options: [.withSecurityScope, .securityScopeAllowOnlyReadAccess],
            includingResourceValuesForKeys: nil, relativeTo: nil)
        },
        resolve: { data in
          var isStale = false
          return try URL(
            resolvingBookmarkData: data, options: .withSecurityScope, relativeTo: nil,
            bookmarkDataIsStale: &isStale)
        })
    #elseif canImport(Darwin)
      Self(
        make: {
          try $0.bookmarkData(options: [], includingResourceValuesForKeys: nil, relativeTo: nil)
        },
        resolve: { data in
          var isStale = false
          return try URL(
            resolvingBookmarkData: data, options: [], relativeTo: nil,
            bookmarkDataIsStale: &isStale)
        })
    #else
      Self(
        make: { Data($0.path.utf8) },
        resolve: { URL(filePath: String(decoding: $0, as: UTF8.self)) })
    #endif
  }
}
