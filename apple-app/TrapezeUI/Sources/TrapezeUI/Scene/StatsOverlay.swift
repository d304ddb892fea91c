import SwiftUI
import TrapezeKit

/// What a frame costs, on top of the picture.
struct StatsOverlay: View {
  let viewer: ViewerModel

  var body: some View {
    let stats = viewer.stats
    Grid(alignment: .leading, horizontalSpacing: 12, verticalSpacing: 2) {
      row("Frames a second", stats.framesPerSecond.map { Figures.decimal($0, digits: 0) } ?? "–")
      row("Frame", Figures.milliseconds(stats.frame.frameSeconds))
      row("Deformation", Figures.milliseconds(stats.frame.deformSeconds))
      row("Sorting", Figures.milliseconds(stats.frame.sortSeconds))
      row("Blending", Figures.milliseconds(stats.frame.rasterizeSeconds))
      row(
        "Deformed",
        "\(Figures.count(stats.frame.deformedSplats)) / \(Figures.count(stats.frame.totalSplats))")
      row("Visible", Figures.count(stats.frame.visibleSplats))
      row("GPU memory", Figures.megabytes(stats.frame.deviceBytes))
    }
    .font(.caption.monospacedDigit())
    .padding(10)
    .background(.regularMaterial, in: RoundedRectangle(cornerRadius: 10))
    .accessibilityElement(children: .combine)
    .accessibilityLabel(Text("Frame statistics"))
  }

  private func row(_ title: LocalizedStringKey, _ value: String) -> some View {
    GridRow {
      Text(title)
      Text(verbatim: value).gridColumnAlignment(.trailing)
    }
  }
}
