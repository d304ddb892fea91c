import SwiftUI
import TrapezeKit

/// Training from photographs: choose, watch, pause, look at the result.
struct TrainingView: View {
  let app: AppModel
  let scene: SceneModel
  @State private var isChoosing = false
  @Environment(\.dismiss) private var dismiss

  private var training: TrainingModel { app.training }

  var body: some View {
    @Bindable var training = app.training
    List {
      switch training.phase {
      case .choosing, .inspecting: chooser
      case .ready(let dataset):
        summary(dataset)
        quality($training.preset, $training.device)
      case .preparing(let step):
        Section { ProgressRow(step: step) { training.discard() } }
      case .running, .paused, .finished: run
      }
    }
    .navigationTitle("Training")
    .toolbar {
      ToolbarItem(placement: .cancellationAction) { Button("Close") { dismiss() } }
    }
    .fileImporter(isPresented: $isChoosing, allowedContentTypes: [.folder]) { result in
      switch result {
      case .success(let url): training.choose(url)
      case .failure(let error): training.failure = Failure(.training, error)
      }
    }
    .failureAlert($training.failure)
    .onChange(of: training.isRunning) { app.lifeCycle.refreshSleep() }
  }

  private var chooser: some View {
    Section {
      if training.phase == .inspecting {
        ProgressView { Text("Reading the dataset…") }
      } else {
        Button("Choose a dataset…", systemImage: "folder") { isChoosing = true }
      }
    } footer: {
      Text(
        "A folder with photographs and poses: a capture of this app, transforms.json, COLMAP, Polycam, Record3D or NeRFCapture."
      )
    }
  }

  @ViewBuilder private func summary(_ dataset: DatasetSummary) -> some View {
    Section("Dataset") {
      LabeledContent("Name") { Text(verbatim: training.datasetName) }
      LabeledContent("Format") { Text(verbatim: dataset.format) }
      LabeledContent("Photographs") { Text(verbatim: Figures.count(dataset.viewCount)) }
      LabeledContent("Size") { Text(verbatim: "\(dataset.width) × \(dataset.height)") }
      LabeledContent("Points") { Text(verbatim: Figures.count(dataset.pointCount)) }
      ForEach(dataset.warnings, id: \.self) { Text(verbatim: $0).font(.caption) }
    }
  }

  private func quality(
    _ preset: Binding<TrainingPreset>, _ device: Binding<TrainingDevice>
  ) -> some View {
    Section {
      Picker("Quality", selection: preset) {
        ForEach(TrainingPreset.allCases) { Text($0.title).tag($0) }
      }
      Picker("Train on", selection: device) {
        ForEach(TrainingDevice.allCases) { Text($0.title).tag($0) }
      }
      Button("Start", systemImage: "play.fill") { training.start() }
      Button("Choose another dataset", role: .cancel) { training.discard() }
    } footer: {
      Text("A run that was started before goes on where it stopped.")
    }
  }

  @ViewBuilder private var run: some View {
    if let image = training.preview?.cgImage {
      Section {
        Image(image, scale: 1, label: Text("The scene as it is now")).resizable().scaledToFit()
        if training.viewCount > 1 {
          Stepper(
            value: Binding(get: { training.previewView }, set: { training.previewView = $0 }),
            in: 0...training.viewCount - 1
          ) {
            Text("View \(training.previewView + 1) of \(training.viewCount)")
          }
        }
      }
    }
    Section { TrainingFigures(training: training) }
    Section { controls }
    ForEach(training.notes, id: \.self) { Text(verbatim: $0).font(.caption) }
  }

  @ViewBuilder private var controls: some View {
    if training.canPause {
      Button("Pause", systemImage: "pause.fill") { Task { await training.pause() } }
    }
    if training.canResume {
      Button("Resume", systemImage: "play.fill") { training.resume() }
    }
    Button("Open the scene", systemImage: "eye") { Task { await open() } }
    Button("Give up", role: .destructive) { training.discard() }
  }

  /// The scene as it is now, in the window: to be looked at, exported and shared from there.
  private func open() async {
    guard let result = await training.scene() else { return }
    scene.open(result, name: training.datasetName)
    dismiss()
  }
}
