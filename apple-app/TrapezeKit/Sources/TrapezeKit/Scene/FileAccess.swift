import Foundation

/// The right to read a file that a person chose, held for as long as this object lives.
///
/// Files from a picker lie outside the sandbox, and memory-mapped scenes are read long after they
/// were opened: giving the right back early is a crash that testing on a Mac does not show.
public final class FileAccess: Sendable {
  public let url: URL
  private let stop: @Sendable (URL) -> Void
  private let isScoped: Bool

  /// `start` and `stop` are the system's; tests count the calls.
  public init(
    _ url: URL,
    start: (URL) -> Bool = FileAccess.systemStart,
    stop: @escaping @Sendable (URL) -> Void = FileAccess.systemStop
  ) {
    self.url = url
    self.stop = stop
    // False for files of our own: they need no right, and giving back one that was not
    // given would unbalance the count of another holder.
    isScoped = start(url)
  }

  deinit {
    if isScoped { stop(url) }
  }

  public static func systemStart(_ url: URL) -> Bool {
    #if canImport(Darwin)
      url.startAccessingSecurityScopedResource()
    #else
      false
    #endif
  }

  @Sendable public static func systemStop(_ url: URL) {
    #if canImport(Darwin)
      url.stopAccessingSecurityScopedResource()
    #endif
  }
}
