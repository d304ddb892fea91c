import Foundation

/// Where the app keeps what is its own.
public enum StandardFolders {
  /// Settings, recent scenes, training runs, models.
  public static var data: URL { folder(.applicationSupportDirectory) }
  /// What can be made again.
  public static var caches: URL { folder(.cachesDirectory) }
  /// What a person sees as the app's files: captures.
  public static var documents: URL { folder(.documentDirectory, subfolder: nil) }

  private static func folder(
    _ directory: FileManager.SearchPathDirectory, subfolder: String? = "Trapeze"
  ) -> URL {
    // Without a home there is still the temporary folder.
    let base =
      FileManager.default.urls(for: directory, in: .userDomainMask).first
      ?? FileManager.default.temporaryDirectory
    return subfolder.map { base.appending(path: $0) } ?? base
  }
}
