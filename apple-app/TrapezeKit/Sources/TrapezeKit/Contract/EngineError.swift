/// What the core refused or could not do.
///
/// `message` is the core's own line (file, field, what was expected, what was found). What a person
/// can do about it depends on `code` alone: see ``Advice``.
public struct EngineError: Error, Sendable, Equatable {
  /// Kinds of failures; the raw values are those of the bridge.
  public enum Code: Int32, Sendable, CaseIterable {
    /// A file or folder that is not there or not readable.
    case unreadableFile = 1
    /// A file whose content is not what its format says.
    case malformedFile = 2
    /// A file that cannot be written; a full disk is the usual reason.
    case unwritableFile = 3
    /// An argument outside its range.
    case invalidArgument = 4
    /// More memory than there is.
    case outOfMemory = 5
    /// No usable graphics device.
    case noDevice = 6
    /// The graphics device was lost, or refused the work.
    case deviceFailed = 7
    /// The models for text search are not there.
    case modelsMissing = 8
    /// A dataset that cannot be trained on.
    case unusableDataset = 9
    /// Training went wrong in spite of lower rates; the last good state is kept.
    case trainingDiverged = 10
    /// An edit that would leave nothing, or names what is not there.
    case invalidEdit = 11
    /// A fault of the program: a panic that was caught at the border.
    case internalFault = 12
  }

  public var code: Code
  /// One line in English.
  public var message: String

  public init(_ code: Code, _ message: String) {
    self.code = code
    self.message = message
  }
}
