import Foundation
import SwiftUI
import TrapezeKit

/// Files out of the scene: what is left of it, a screenshot, a video.
struct ExportPanel: View {
  let scene: SceneModel
  @State private var format = ExportFormat.ply
  @State private var finished: URL?

  private var movie: MovieModel { scene.movie }

  var body: some View {
    Form {
      Section {
        Picker("Format", selection: $format) {
          ForEach(ExportFormat.allCases) { Text($0.title).tag($0) }
        }
        if let step = scene.export.progress {
          ProgressRow(step: step) { scene.export.cancel() }
        } else {
          Button("Export what is left", systemImage: "square.and.arrow.up", action: export)
        }
        ForEach(scene.export.result?.warnings ?? [], id: \.self) { warning in
          Label {
            Text(verbatim: warning)
          } icon: {
            Image(systemName: "exclamationmark.triangle")
          }
        }
      } header: {
        Text("Scene")
      }
      Section("Picture") {
        Button("Take a screenshot", systemImage: "camera", action: screenshot)
      }
      MovieSection(movie: movie, start: record)
      if let finished { FinishedFile(url: finished) }
    }
    .formStyle(.grouped)
    .onChange(of: scene.export.result) { if scene.export.result != nil { finished = exported } }
  }

  private var exported: URL {
    OutgoingFiles.url(ExportModel.fileName(scene.name, format))
  }

  private func export() {
    guard let current = scene.scene else { return }
    finished = nil
    OutgoingFiles.prepare(exported)
    scene.export.export(current, to: exported, as: format)
  }

  private func screenshot() {
    guard let request = scene.viewer.request, let renderer = scene.viewer.renderer else { return }
    let place = OutgoingFiles.url("\(scene.name).png")
    Task {
      do {
        let image = try await renderer.render(request)
        OutgoingFiles.prepare(place)
        try ImageFile.writePNG(image, to: place)
        finished = place
      } catch {
        scene.failure = Failure(.exporting, error)
      }
    }
  }

  private func record() {
    guard let request = scene.viewer.request, let renderer = scene.viewer.renderer else { return }
    let place = OutgoingFiles.url("\(scene.name).mp4")
    // Video encoders want even sides.
    let viewport = Viewport(width: 1920, height: 1080)
    finished = nil
    do {
      OutgoingFiles.prepare(place)
      let writer = try MovieFile(
        url: place, width: 1920, height: 1080, framesPerSecond: movie.move.framesPerSecond)
      movie.record(
        request, pose: scene.viewer.camera.pose, viewport: viewport, with: renderer, to: writer
      ) { scene.failure = Failure(.exporting, $0) }
    } catch {
      scene.failure = Failure(.exporting, error)
      return
    }
    Task {
      await movie.settle()
      if FileManager.default.fileExists(atPath: place.path) { finished = place }
    }
  }
}

/// What moves in a video and for how long.
private struct MovieSection: View {
  @Bindable var movie: MovieModel
  let start: @MainActor () -> Void

  var body: some View {
    Section("Video") {
      Picker("Moves", selection: $movie.move.kind) {
        ForEach(CameraMove.Kind.allCases) { Text($0.title).tag($0) }
      }
      Stepper(value: $movie.move.seconds, in: 1...60, step: 1) {
        Text("\(Int(movie.move.seconds)) seconds")
      }
      if let step = movie.progress {
        ProgressRow(step: step) { movie.cancel() }
      } else {
        Button("Record a video", systemImage: "film", action: start)
      }
    }
  }
}

/// A file that was written: share it, or move it to a place of one's own.
struct FinishedFile: View {
  let url: URL
  @State private var isMoving = false

  var body: some View {
    Section("Ready") {
      Text(verbatim: url.lastPathComponent)
      ShareLink(item: url)
      Button("Save to…", systemImage: "folder") { isMoving = true }
    }
    .fileMover(isPresented: $isMoving, file: url) { _ in }
  }
}

/// Files on their way to somebody else.
enum OutgoingFiles {
  static func url(_ name: String) -> URL {
    FileManager.default.temporaryDirectory.appending(path: "Outgoing").appending(path: name)
  }

  /// Makes the folder, and room for the file.
  static func prepare(_ url: URL) {
    // What cannot be made or removed is told by whoever writes the file.
    try? FileManager.default.createDirectory(
      at: url.deletingLastPathComponent(), withIntermediateDirectories: true)
    try? FileManager.default.removeItem(at: url)
  }
}
