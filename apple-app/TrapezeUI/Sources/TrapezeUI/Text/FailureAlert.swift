import SwiftUI
import TrapezeKit

extension View {
  /// Shows a failure as an alert: what happened, the core's own line, and what to do.
  func failureAlert(_ failure: Binding<Failure?>) -> some View {
    alert(
      Text(failure.wrappedValue?.task.title ?? ""),
      isPresented: Binding(
        get: { failure.wrappedValue != nil },
        set: { if !$0 { failure.wrappedValue = nil } }),
      presenting: failure.wrappedValue
    ) { _ in
      Button("OK", role: .cancel) {}
    } message: { failure in
      Text(failure.advice.text) + Text(verbatim: "\n\n" + failure.reason)
    }
  }
}
