import SwiftUI
import TrapezeKit

/// Search by text.
struct SearchPanel: View {
  @Bindable var search: SearchModel
  let scene: SceneModel
  let modelFolder: URL

  var body: some View {
    List {
      Section {
        TextField("Search for an object", text: $search.text)
          .onSubmit { search.search() }
          .disabled(!search.isEncoded)
        Picker("Search in", selection: $search.settings.scope) {
          ForEach(SearchSettings.Scope.allCases) { Text($0.title).tag($0) }
        }
        LabeledContent {
          Text(verbatim: Figures.decimal(search.lowestScore, digits: 2)).monospacedDigit()
        } label: {
          Slider(value: $search.lowestScore, in: SearchSettings.thresholds, step: 0.01) {
            Text("Lowest score")
          }
        }
        Stepper(value: $search.settings.topK, in: SearchSettings.counts) {
          Text("At most \(search.settings.topK) results")
        }
      }
      Section { state }
      results
    }
    .onChange(of: scene.selection.state) { search.refresh() }
  }

  @ViewBuilder private var state: some View {
    if let step = search.encoding {
      ProgressRow(step: step) { search.cancelEncoding() }
    } else {
      Button(search.isEncoded ? "Encode again" : "Encode the scene") { search.encode() }
        .disabled(!search.canEncode)
    }
    switch search.models {
    case .missing(let reason): MissingModels(reason: reason, folder: modelFolder)
    case .ready(let name): LabeledContent("Model") { Text(verbatim: name) }
    case .loading(let step): ProgressRow(step: step)
    case .notLoaded: EmptyView()
    }
  }

  @ViewBuilder private var results: some View {
    Section("Results") {
      if search.isSearching { ProgressView() }
      ForEach(search.results) { result in
        ResultRow(result: result) {
          scene.selection.choose([result.id])
          Task { await scene.viewer.focus(on: [result.id]) }
        }
      }
      if !search.results.isEmpty {
        Button("Select all results") { search.chooseResults() }
      } else if search.isEncoded, !search.text.isEmpty, !search.isSearching {
        Text("Nothing scores high enough. Lower the score or try other words.")
          .foregroundStyle(.secondary)
      }
    }
  }
}

/// A match with its picture and score.
private struct ResultRow: View {
  let result: SearchModel.Result
  let choose: @MainActor () -> Void

  var body: some View {
    Button(action: choose) {
      HStack {
        if let image = result.thumbnail?.cgImage {
          Image(decorative: image, scale: 1).resizable().scaledToFit()
            .frame(width: 48, height: 48)
            .clipShape(RoundedRectangle(cornerRadius: 6))
        }
        ObjectName(row: result.row)
        Spacer()
        Text(verbatim: Figures.decimal(result.score, digits: 3))
          .monospacedDigit().foregroundStyle(.secondary)
      }
    }
    .buttonStyle(.plain)
    .accessibilityElement(children: .combine)
  }
}

/// How to get the models.
private struct MissingModels: View {
  let reason: String
  let folder: URL

  var body: some View {
    VStack(alignment: .leading, spacing: 8) {
      Label("The search models are missing", systemImage: "exclamationmark.triangle")
        .font(.headline)
      Text("Export MobileCLIP with scripts/export-mobileclip.py and copy the folder's files to:")
      Text(verbatim: folder.path).font(.caption.monospaced()).textSelection(.enabled)
      Text(verbatim: reason).font(.caption).foregroundStyle(.secondary)
    }
  }
}
