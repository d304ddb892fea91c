import SwiftUI
import TrapezeKit

extension Color {
  init(_ color: RGBColor) {
    self.init(
      .sRGB, red: Double(color.red), green: Double(color.green), blue: Double(color.blue),
      opacity: 1)
  }

  /// Red, green and blue in sRGB.
  var components: RGBColor {
    let resolved = resolve(in: EnvironmentValues())
    return RGBColor(red: resolved.red, green: resolved.green, blue: resolved.blue)
  }
}
