#if canImport(UIKit)
  import SwiftUI
  import TrapezeKit

  /// A capture with the camera: the picture, how many are kept, what to do better.
  struct CaptureView: View {
    let app: AppModel
    @State private var session = CaptureSession()
    @Environment(\.dismiss) private var dismiss

    private var capture: CaptureModel { app.capture }

    var body: some View {
      @Bindable var capture = app.capture
      ZStack(alignment: .bottom) {
        if CaptureSession.isSupported {
          CameraPreview(session: session).ignoresSafeArea()
          controls.padding()
        } else {
          ContentUnavailableView(
            "No capture on this device", systemImage: "camera.metering.unknown",
            description: Text("Capturing needs ARKit world tracking."))
        }
      }
      .navigationTitle("Capture")
      .toolbar {
        ToolbarItem(placement: .cancellationAction) {
          Button("Close") {
            Task {
              await capture.cancel()
              dismiss()
            }
          }
        }
      }
      .failureAlert($capture.failure)
      .onAppear { session.start(for: capture) }
      .onDisappear { session.stop() }
    }

    @ViewBuilder private var controls: some View {
      VStack(spacing: 12) {
        if let hint = capture.hint, hint != .tooClose {
          Text(hint.hint).accessibilityAddTraits(.updatesFrequently)
        }
        switch capture.phase {
        case .idle:
          Button("Start", systemImage: "record.circle") { capture.start() }
        case .recording:
          Text("\(capture.keptCount) pictures, \(capture.pointCount) points").monospacedDigit()
          Button("Finish", systemImage: "checkmark.circle.fill") {
            Task { await capture.finish() }
          }
          .disabled(!capture.canFinish)
        case .finishing: ProgressView()
        case .finished(let dataset):
          Button("Train a scene", systemImage: "photo.stack") {
            app.training.choose(dataset)
            dismiss()
          }
          ShareLink(item: dataset)
        }
      }
      .buttonStyle(.borderedProminent)
      .padding()
      .background(.regularMaterial, in: RoundedRectangle(cornerRadius: 16))
    }
  }
#endif
