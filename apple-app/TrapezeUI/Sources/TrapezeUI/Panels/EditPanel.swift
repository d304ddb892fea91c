import SwiftUI
import TrapezeKit

/// Crop, delete, floaters, undo, redo.
struct EditPanel: View {
  let scene: SceneModel
  @State private var faintest = 0.05
  @State private var sigmas = 3.0

  var body: some View {
    Form {
      Section {
        if let step = scene.edits.progress { ProgressRow(step: step) }
        Button("Undo", systemImage: "arrow.uturn.backward") { Task { await scene.edits.undo() } }
          .disabled(!scene.edits.canUndo)
        Button("Redo", systemImage: "arrow.uturn.forward") { Task { await scene.edits.redo() } }
          .disabled(!scene.edits.canRedo)
        if let summary = scene.summary {
          LabeledContent("Splats") { Text(verbatim: Figures.count(summary.splatCount)) }
        }
      }
      Section("Objects") {
        Button("Delete selected", role: .destructive) { Task { await scene.deleteChosen() } }
        Button("Keep only selected") { Task { await scene.keepChosen() } }
      }
      .disabled(!scene.selection.hasChosen)
      CropSection(scene: scene)
      Section("Clean up") {
        Stepper(value: $sigmas, in: 1...6, step: 0.5) {
          Text("Beyond \(Figures.decimal(sigmas, digits: 1)) σ")
        }
        Button("Remove floaters") { Task { await scene.removeFloaters(sigmas: sigmas) } }
        LabeledContent {
          Text(verbatim: Figures.percent(faintest * 100)).monospacedDigit()
        } label: {
          Slider(value: $faintest, in: 0...0.5) { Text("Opacity") }
        }
        Button("Delete fainter splats") { Task { await scene.deleteFaint(below: faintest) } }
      }
    }
    .formStyle(.grouped)
    .disabled(scene.edits.isEditing)
  }
}

/// A box by its six faces.
private struct CropSection: View {
  let scene: SceneModel

  var body: some View {
    Section("Crop box") {
      if let box = scene.viewer.cropBox, let whole = scene.summary?.framingBounds {
        ForEach(0..<3, id: \.self) { axis in
          face("Lower \(Self.names[axis])", axis, whole, value: box.min[axis]) {
            scene.viewer.cropBox?.min[axis] = Swift.min($0, box.max[axis])
          }
          face("Upper \(Self.names[axis])", axis, whole, value: box.max[axis]) {
            scene.viewer.cropBox?.max[axis] = Swift.max($0, box.min[axis])
          }
        }
        Button("Crop") { Task { await scene.applyCrop() } }
        Button("Cancel", role: .cancel) { scene.cancelCrop() }
      } else {
        Button("Draw a crop box") { scene.beginCrop() }
      }
    }
  }

  private static let names = ["X", "Y", "Z"]

  private func face(
    _ title: LocalizedStringKey, _ axis: Int, _ whole: Bounds, value: Double,
    set: @escaping @MainActor (Double) -> Void
  ) -> some View {
    // A little room beyond the box that frames the scene, for what lies outside it.
    let margin = max(whole.max[axis] - whole.min[axis], 1e-3) * 0.25
    return LabeledContent {
      Slider(
        value: Binding(get: { value }, set: set),
        in: whole.min[axis] - margin...whole.max[axis] + margin
      ) { Text(title) }
    } label: {
      Text(title)
    }
  }
}
