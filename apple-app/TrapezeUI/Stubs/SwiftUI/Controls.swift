public enum ButtonRole: Sendable { case cancel, destructive }

public struct Button: Leaf {
  public init<L: View>(action: @escaping @MainActor () -> Void, @ViewBuilder label: () -> L) {}
  public init<L: View>(
    role: ButtonRole?, action: @escaping @MainActor () -> Void, @ViewBuilder label: () -> L
  ) {}
  public init(_ title: LocalizedStringKey, action: @escaping @MainActor () -> Void) {}
  public init(
    _ title: LocalizedStringKey, role: ButtonRole?, action: @escaping @MainActor () -> Void
  ) {}
  public init(
    _ title: LocalizedStringKey, systemImage: String, action: @escaping @MainActor () -> Void
  ) {}
  public init(
    _ title: LocalizedStringKey, systemImage: String, role: ButtonRole?,
    action: @escaping @MainActor () -> Void
  ) {}
}

public struct Text: Leaf {
  public enum DateStyle: Sendable { case date }
  public init(_ key: LocalizedStringKey) {}
  public init(verbatim text: String) {}
  public init(_ date: Date, style: DateStyle) {}
  public static func + (left: Text, right: Text) -> Text { left }
  public func font(_ font: Font?) -> Text { self }
  public func monospacedDigit() -> Text { self }
  public func foregroundStyle(_ style: Color) -> Text { self }
}

public struct Label: Leaf {
  public init(_ title: LocalizedStringKey, systemImage: String) {}
  public init<T: View, I: View>(@ViewBuilder title: () -> T, @ViewBuilder icon: () -> I) {}
}

public struct Image: Leaf {
  public init(systemName: String) {}
  public init(decorative image: CGImage, scale: CGFloat) {}
  public init(_ image: CGImage, scale: CGFloat, label: Text) {}
  public func resizable() -> Image { self }
}

public struct Toggle: Leaf {
  public init(_ title: LocalizedStringKey, isOn: Binding<Bool>) {}
}

public struct Slider: Leaf {
  public init<V: BinaryFloatingPoint, L: View>(
    value: Binding<V>, in bounds: ClosedRange<V>, @ViewBuilder label: () -> L,
    onEditingChanged: @escaping (Bool) -> Void = { _ in }
  ) {}
  public init<V: BinaryFloatingPoint, L: View>(
    value: Binding<V>, in bounds: ClosedRange<V>, step: V, @ViewBuilder label: () -> L,
    onEditingChanged: @escaping (Bool) -> Void = { _ in }
  ) {}
}

public struct Stepper: Leaf {
  public init<V: Strideable, L: View>(
    value: Binding<V>, in bounds: ClosedRange<V>, step: V.Stride = 1, @ViewBuilder label: () -> L,
    onEditingChanged: @escaping (Bool) -> Void = { _ in }
  ) {}
}

public struct Picker: Leaf {
  public init<V: Hashable, C: View>(
    _ title: LocalizedStringKey, selection: Binding<V>, @ViewBuilder content: () -> C
  ) {}
}

public struct ColorPicker: Leaf {
  public init(
    _ title: LocalizedStringKey, selection: Binding<Color>, supportsOpacity: Bool = true
  ) {}
}

public struct TextField: Leaf {
  public init(_ title: LocalizedStringKey, text: Binding<String>) {}
}

public struct ProgressView: Leaf {
  public init() {}
  public init<L: View>(@ViewBuilder label: () -> L) {}
  public init<V: BinaryFloatingPoint, L: View>(
    value: V?, total: V = 1, @ViewBuilder label: () -> L
  ) {}
}

public struct Menu: Leaf {
  public init<C: View>(_ title: LocalizedStringKey, @ViewBuilder content: () -> C) {}
  public init<C: View, L: View>(@ViewBuilder content: () -> C, @ViewBuilder label: () -> L) {}
}

public struct ShareLink: Leaf {
  public init(item: URL) {}
}

public struct ContentUnavailableView: Leaf {
  public init(_ title: LocalizedStringKey, systemImage: String, description: Text? = nil) {}
}

public struct LabeledContent: Leaf {
  public init<C: View>(_ title: LocalizedStringKey, @ViewBuilder content: () -> C) {}
  public init<C: View, L: View>(@ViewBuilder content: () -> C, @ViewBuilder label: () -> L) {}
}
