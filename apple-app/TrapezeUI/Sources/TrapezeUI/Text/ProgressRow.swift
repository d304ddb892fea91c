import SwiftUI
import TrapezeKit

/// What is being done, how far it is, and a way to stop it.
struct ProgressRow: View {
  let step: ProgressStep
  var cancel: (@MainActor () -> Void)?

  var body: some View {
    HStack {
      if let fraction = step.fraction {
        ProgressView(value: fraction) { Text(step.stage.title) }
      } else {
        ProgressView { Text(step.stage.title) }
      }
      if let cancel {
        Button(role: .cancel, action: cancel) {
          Label("Cancel", systemImage: "xmark.circle.fill").labelStyle(.iconOnly)
        }
        .buttonStyle(.borderless)
      }
    }
    .accessibilityElement(children: .contain)
  }
}
