import SwiftUI
import TrapezeKit

/// How far a run is and how good.
struct TrainingFigures: View {
  let training: TrainingModel

  var body: some View {
    if let report = training.report {
      ProgressView(value: Double(report.step), total: Double(max(report.steps, 1))) {
        Text("Step \(report.step) of \(report.steps)")
      }
      LabeledContent("Quality of the last view") { Text(verbatim: Figures.decibels(report.psnr)) }
      LabeledContent("Splats") { Text(verbatim: Figures.count(report.splatCount)) }
      LabeledContent("Trains on") { Text(verbatim: training.deviceName) }
      LabeledContent("Steps a second") {
        Text(verbatim: Figures.decimal(report.stepsPerSecond, digits: 1))
      }
      if training.isRunning, let left = training.secondsLeft {
        LabeledContent("Time left") { Text(verbatim: Figures.duration(left)) }
      }
      LossGraph(reports: training.reports).frame(height: 80)
    }
    if let step = training.savedStep {
      LabeledContent("Saved") { Text("Step \(step)") }
    }
    if case .finished(let test?) = training.phase {
      LabeledContent("Unseen views") {
        Text(
          verbatim: "\(Figures.decibels(test.psnr)), SSIM \(Figures.decimal(test.ssim, digits: 3))")
      }
    }
  }
}

/// PSNR over the steps.
private struct LossGraph: View {
  let reports: [TrainReport]

  var body: some View {
    Canvas { context, size in
      let values = reports.map(\.psnr).filter(\.isFinite)
      guard values.count > 1, let low = values.min(), let high = values.max(), high > low else {
        return
      }
      var path = Path()
      for (index, value) in values.enumerated() {
        let x = Double(index) / Double(values.count - 1) * size.width
        let y = (1 - (value - low) / (high - low)) * (size.height - 2) + 1
        let point = CGPoint(x: x, y: y)
        if index == 0 { path.move(to: point) } else { path.addLine(to: point) }
      }
      context.stroke(path, with: .color(.accentColor), lineWidth: 1.5)
    }
    .accessibilityLabel(Text("Quality over time"))
  }
}
