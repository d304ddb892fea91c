@_exported import Foundation

public struct UTType: Sendable, Hashable {
  public static let folder = UTType("public.folder")
  public static let png = UTType("public.png")
  public let identifier: String
  private init(_ identifier: String) { self.identifier = identifier }
  public init?(filenameExtension: String) { identifier = filenameExtension }
}
