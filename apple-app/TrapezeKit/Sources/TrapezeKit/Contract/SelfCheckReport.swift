import Foundation

/// What the renderer's check of itself found on this device.
public struct SelfCheckReport: Sendable, Equatable, Codable {
  public struct Entry: Sendable, Equatable, Codable, Identifiable {
    /// What was drawn, or which stage was run.
    public var name: String
    /// Against the f64 reference, in dB; `nil` when the images are equal.
    public var psnr: Double?
    /// Median time on the device.
    public var milliseconds: Double?
    public var passed: Bool
    /// Why it failed, or what was left out.
    public var note: String?

    public var id: String { name }

    public init(
      name: String, psnr: Double?, milliseconds: Double?, passed: Bool, note: String? = nil
    ) {
      self.name = name
      self.psnr = psnr
      self.milliseconds = milliseconds
      self.passed = passed
      self.note = note
    }
  }

  public var device: String
  public var coreVersion: String
  public var entries: [Entry]

  public var passed: Bool { !entries.isEmpty && entries.allSatisfy(\.passed) }

  public init(device: String, coreVersion: String, entries: [Entry]) {
    self.device = device
    self.coreVersion = coreVersion
    self.entries = entries
  }
}
