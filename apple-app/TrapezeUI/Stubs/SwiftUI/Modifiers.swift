import UniformTypeIdentifiers

public struct LabelStyle: Sendable { public static let iconOnly = LabelStyle() }
public struct ButtonStyle: Sendable {
  public static let borderless = ButtonStyle()
  public static let plain = ButtonStyle()
  public static let borderedProminent = ButtonStyle()
}
public struct FormStyle: Sendable { public static let grouped = FormStyle() }
public struct PickerStyle: Sendable { public static let segmented = PickerStyle() }
public struct TextSelection: Sendable { public static let enabled = TextSelection() }
public enum AccessibilityChildBehavior: Sendable { case contain, combine, ignore }
public struct AccessibilityTraits: OptionSet, Sendable {
  public static let isSelected = AccessibilityTraits(rawValue: 1)
  public static let updatesFrequently = AccessibilityTraits(rawValue: 2)
  public let rawValue: UInt64
  public init(rawValue: UInt64) { self.rawValue = rawValue }
}

extension View {
  public func accessibilityAddTraits(_ traits: AccessibilityTraits) -> some View { Modified() }
  public func accessibilityElement(children: AccessibilityChildBehavior) -> some View { Modified() }
  public func accessibilityHidden(_ isHidden: Bool) -> some View { Modified() }
  public func accessibilityLabel(_ label: Text) -> some View { Modified() }
  public func accessibilityValue(_ value: Text) -> some View { Modified() }
  public func allowsHitTesting(_ enabled: Bool) -> some View { Modified() }
  public func background<S: ShapeStyle, T: Shape>(_ style: S, in shape: T) -> some View {
    Modified()
  }
  public func buttonStyle(_ style: ButtonStyle) -> some View { Modified() }
  public func clipShape<S: Shape>(_ shape: S) -> some View { Modified() }
  public func contextMenu<M: View>(@ViewBuilder menuItems: () -> M) -> some View { Modified() }
  public func disabled(_ disabled: Bool) -> some View { Modified() }
  public func font(_ font: Font?) -> some View { Modified() }
  public func foregroundStyle(_ style: Color) -> some View { Modified() }
  public func formStyle(_ style: FormStyle) -> some View { Modified() }
  public func frame(width: CGFloat? = nil, height: CGFloat? = nil) -> some View { Modified() }
  public func frame(maxWidth: CGFloat?) -> some View { Modified() }
  public func gridColumnAlignment(_ guide: HorizontalAlignment) -> some View { Modified() }
  public func ignoresSafeArea() -> some View { Modified() }
  public func inspector<V: View>(
    isPresented: Binding<Bool>, @ViewBuilder content: () -> V
  ) -> some View { Modified() }
  public func inspectorColumnWidth(
    min: CGFloat? = nil, ideal: CGFloat, max: CGFloat? = nil
  ) -> some View { Modified() }
  public func keyboardShortcut(
    _ key: KeyEquivalent, modifiers: EventModifiers = .command
  ) -> some View { Modified() }
  public func labelsHidden() -> some View { Modified() }
  public func labelStyle(_ style: LabelStyle) -> some View { Modified() }
  public func modifier<M: ViewModifier>(_ modifier: M) -> some View { Modified() }
  public func monospacedDigit() -> some View { Modified() }
  public func navigationTitle(_ title: Text) -> some View { Modified() }
  public func navigationTitle(_ title: LocalizedStringKey) -> some View { Modified() }
  public func padding(_ length: CGFloat) -> some View { Modified() }
  public func padding(_ edges: Edge.Set = .all, _ length: CGFloat? = nil) -> some View {
    Modified()
  }
  public func pickerStyle(_ style: PickerStyle) -> some View { Modified() }
  public func scaledToFit() -> some View { Modified() }
  public func tag<V: Hashable>(_ tag: V) -> some View { Modified() }
  public func textSelection(_ selection: TextSelection) -> some View { Modified() }
}

extension View {
  public func alert<A: View, M: View, T>(
    _ title: Text, isPresented: Binding<Bool>, presenting data: T?,
    @ViewBuilder actions: (T) -> A, @ViewBuilder message: (T) -> M
  ) -> some View { Modified() }
  public func alert<A: View, T>(
    _ title: LocalizedStringKey, isPresented: Binding<Bool>, presenting data: T?,
    @ViewBuilder actions: (T) -> A
  ) -> some View { Modified() }
  public func fileImporter(
    isPresented: Binding<Bool>, allowedContentTypes: [UTType],
    onCompletion: @escaping (Result<URL, any Error>) -> Void
  ) -> some View { Modified() }
  public func fileMover(
    isPresented: Binding<Bool>, file: URL?,
    onCompletion: @escaping (Result<URL, any Error>) -> Void
  ) -> some View { Modified() }
  public func sheet<I: Identifiable, C: View>(
    item: Binding<I?>, onDismiss: (() -> Void)? = nil, @ViewBuilder content: @escaping (I) -> C
  ) -> some View { Modified() }
  public func toolbar<C: ToolbarContent>(@ToolbarContentBuilder content: () -> C) -> some View {
    Modified()
  }
  public func onAppear(perform action: (() -> Void)? = nil) -> some View { Modified() }
  public func onDisappear(perform action: (() -> Void)? = nil) -> some View { Modified() }
  public func onChange<V: Equatable>(
    of value: V, initial: Bool = false, _ action: @escaping () -> Void
  ) -> some View { Modified() }
  public func onOpenURL(perform action: @escaping (URL) -> Void) -> some View { Modified() }
  public func onReceive(
    _ publisher: NotificationCenter.Publisher, perform action: @escaping (Notification) -> Void
  ) -> some View { Modified() }
  public func onSubmit(_ action: @escaping () -> Void) -> some View { Modified() }
  public func task(_ action: @escaping @MainActor () async -> Void) -> some View { Modified() }
  public func focusedSceneValue<T>(
    _ path: WritableKeyPath<FocusedValues, T?>, _ value: T?
  ) -> some View { Modified() }
}

extension NotificationCenter {
  public struct Publisher {}
  public func publisher(for name: Notification.Name) -> Publisher { Publisher() }
}
