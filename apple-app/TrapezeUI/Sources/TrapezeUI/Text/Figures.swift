import Foundation
import TrapezeKit

/// Numbers as they are shown. Figures have no words, so they are the same in every language but for
/// the decimal separator, which Foundation knows.
enum Figures {
  static func milliseconds(_ seconds: Double?) -> String {
    guard let seconds else { return "–" }
    return decimal(seconds * 1_000, digits: 2) + " ms"
  }

  static func decibels(_ psnr: Double?) -> String {
    guard let psnr, psnr.isFinite else { return "∞ dB" }
    return decimal(psnr, digits: 1) + " dB"
  }

  static func factor(_ value: Double) -> String { decimal(value, digits: 2) + "×" }

  static func percent(_ value: Double) -> String { decimal(value, digits: 0) + " %" }

  static func megabytes(_ bytes: UInt64) -> String {
    decimal(Double(bytes) / 1_048_576, digits: bytes < 104_857_600 ? 1 : 0) + " MiB"
  }

  static func count(_ value: Int) -> String { value.formatted() }

  static func decimal(_ value: Double, digits: Int) -> String {
    value.formatted(.number.precision(.fractionLength(digits)))
  }

  /// Minutes and seconds.
  static func duration(_ seconds: Double) -> String {
    guard seconds.isFinite, seconds >= 0 else { return "–" }
    let whole = Int(min(seconds, 1e9).rounded())
    let rest = whole % 60
    return "\(whole / 60):\(rest < 10 ? "0" : "")\(rest)"
  }
}
