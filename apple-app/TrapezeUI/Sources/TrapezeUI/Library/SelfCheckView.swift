import Foundation
import SwiftUI
import TrapezeKit

/// Runs the renderer's check of itself and shows error and time of every part.
struct SelfCheckView: View {
  @Bindable var model: SelfCheckModel
  @State private var exported: URL?
  @Environment(\.dismiss) private var dismiss

  var body: some View {
    List {
      Section {
        if let step = model.progress {
          ProgressRow(step: step) { model.cancel() }
        } else {
          Button("Run the self-check", systemImage: "play") { model.run() }
        }
      } footer: {
        Text("Draws test scenes on this device and compares them with the reference renderer.")
      }
      if let report = model.report { result(report) }
      if let exported { FinishedFile(url: exported) }
    }
    .navigationTitle("Self-check")
    .toolbar {
      ToolbarItem(placement: .cancellationAction) { Button("Close") { dismiss() } }
    }
    .failureAlert($model.failure)
  }

  @ViewBuilder private func result(_ report: SelfCheckReport) -> some View {
    Section {
      Label(
        report.passed ? "Everything agrees" : "Something differs",
        systemImage: report.passed ? "checkmark.seal.fill" : "exclamationmark.triangle.fill")
      LabeledContent("Device") { Text(verbatim: report.device) }
      LabeledContent("Core") { Text(verbatim: report.coreVersion) }
      Button("Export as JSON", systemImage: "square.and.arrow.up", action: export)
    }
    Section("Checks") {
      ForEach(report.entries) { entry in
        LabeledContent {
          Text(verbatim: Figures.decibels(entry.psnr))
          Text(verbatim: Figures.milliseconds(entry.milliseconds.map { $0 / 1_000 }))
        } label: {
          Label {
            Text(verbatim: entry.name)
          } icon: {
            Image(systemName: entry.passed ? "checkmark.circle" : "xmark.circle")
          }
          if let note = entry.note { Text(verbatim: note) }
        }
        .accessibilityElement(children: .combine)
      }
    }
  }

  private func export() {
    guard let json = model.json() else { return }
    let place = OutgoingFiles.url("trapeze-self-check.json")
    OutgoingFiles.prepare(place)
    do {
      try json.write(to: place, options: .atomic)
      exported = place
    } catch {
      model.failure = Failure(.exporting, error)
    }
  }
}
