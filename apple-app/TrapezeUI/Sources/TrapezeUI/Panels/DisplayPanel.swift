import SwiftUI
import TrapezeKit

/// What is drawn and how: mode, precision, masking with its price, view, fake depth.
struct DisplayPanel: View {
  @Bindable var viewer: ViewerModel
  let scene: SceneModel

  var body: some View {
    Form {
      Section("Show") {
        Picker("Mode", selection: $viewer.display.mode) {
          ForEach(modes) { Text($0.title).tag($0) }
        }
        Toggle("Statistics", isOn: $viewer.display.showsStats)
        ColorPicker("Background", selection: background, supportsOpacity: false)
      }
      if scene.summary?.isDeformable == true { MaskSection(viewer: viewer, scene: scene) }
      ViewSection(viewer: viewer)
      ParallaxSection(parallax: viewer.parallax)
    }
    .formStyle(.grouped)
  }

  private var modes: [FrameRequest.Mode] {
    FrameRequest.Mode.allCases.filter { mode in
      switch mode {
      case .clusters: !scene.selection.rows.isEmpty
      case .motion: scene.summary?.hasMotion == true
      case .color, .depth: true
      }
    }
  }

  private var background: Binding<Color> {
    Binding(
      get: { Color(viewer.display.background) },
      set: { viewer.display.background = $0.components })
  }
}

/// Precision and masking, with what they cost in time and in error.
private struct MaskSection: View {
  @Bindable var viewer: ViewerModel
  let scene: SceneModel

  var body: some View {
    Section {
      Picker("Precision", selection: precision) {
        ForEach(RendererOptions.Precision.allCases, id: \.self) { Text($0.title).tag($0) }
      }
      if scene.summary?.hasMotion == true {
        Toggle("Hold static splats still", isOn: $viewer.display.masksStatic)
        LabeledContent {
          Text(verbatim: Figures.percent(viewer.display.staticPercentile)).monospacedDigit()
        } label: {
          Slider(value: $viewer.display.staticPercentile, in: 0...100, step: 1) {
            Text("Share held still")
          }
          .disabled(!viewer.display.masksStatic)
        }
      }
      prediction
      measuring
    } header: {
      Text("Speed and error")
    } footer: {
      Text("Splats that hardly move keep their state at the start. Saved with the scene.")
    }
  }

  private var precision: Binding<RendererOptions.Precision> {
    Binding(
      get: { viewer.display.options.precision },
      set: { precision in
        var options = viewer.display.options
        options.precision = precision
        Task { await scene.setOptions(options) }
      })
  }

  @ViewBuilder private var prediction: some View {
    let share = viewer.display.masksStatic ? viewer.display.staticPercentile : 0
    if let prediction = scene.tuning.prediction(
      at: share, precision: viewer.display.options.precision)
    {
      LabeledContent("Predicted frame") {
        Text(verbatim: Figures.milliseconds(prediction.frameMilliseconds / 1_000))
      }
      LabeledContent("Speed-up") { Text(verbatim: Figures.factor(prediction.speedUp)) }
      LabeledContent("Predicted error") { Text(verbatim: Figures.decibels(prediction.psnr)) }
    }
  }

  @ViewBuilder private var measuring: some View {
    if let step = scene.tuning.progress {
      ProgressRow(step: step) { scene.tuning.cancel() }
    } else {
      Button("Measure on this device") {
        guard let camera = viewer.request?.camera else { return }
        scene.tuning.measure(from: camera, precision: viewer.display.options.precision)
      }
    }
  }
}

/// Where to look from and what is up.
private struct ViewSection: View {
  let viewer: ViewerModel

  var body: some View {
    Section("View") {
      Menu("Look from") {
        ForEach(ViewPreset.allCases) { preset in
          Button(preset.title) { viewer.look(from: preset) }
        }
      }
      Menu("Which way is up") {
        ForEach(UpAxis.allCases) { axis in
          Button(axis.title) { viewer.setUp(axis) }
        }
        Divider()
        Button("As in the picture now") { viewer.useImageUp() }
        Button("Turn left 5°") { viewer.roll(by: -5 * .pi / 180) }
        Button("Turn right 5°") { viewer.roll(by: 5 * .pi / 180) }
      }
      Button("Show the whole scene") { viewer.frameAll() }
    }
  }
}

/// Depth by moving the device or the head.
private struct ParallaxSection: View {
  @Bindable var parallax: ParallaxModel

  var body: some View {
    Section("Fake depth") {
      Picker("Follow", selection: $parallax.source) {
        ForEach(ParallaxModel.Source.available) { Text($0.title).tag($0) }
      }
      if parallax.source != .off {
        Button("Re-center") { parallax.recenter() }
      }
      if parallax.seesFace == false {
        Label("No face is seen", systemImage: "face.dashed")
      }
    }
  }
}

extension ParallaxModel.Source {
  /// A Mac does not move.
  static var available: [Self] {
    #if canImport(UIKit)
      allCases
    #else
      [.off, .head]
    #endif
  }
}
