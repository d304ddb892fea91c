@_exported import Foundation
@_exported import QuartzCore

@MainActor @preconcurrency public protocol View {
  associatedtype Body: View
  @ViewBuilder @MainActor var body: Body { get }
}

extension Never: View {
  public var body: Never { fatalError("stub") }
}

extension Optional: View where Wrapped: View {
  public var body: Never { return fatalError("stub") }
}

/// A view without a body of its own.
public protocol Leaf: View where Body == Never {}
extension Leaf {
  public var body: Never { fatalError("stub") }
}

/// What every modifier gives.
public struct Modified: Leaf {}
public struct EmptyView: Leaf { public init() {} }

@resultBuilder public enum ViewBuilder {
  public static func buildBlock<each Content: View>(_ content: repeat each Content) -> Modified {
    Modified()
  }
  public static func buildBlock<Content: View>(_ content: Content) -> Content { content }
  public static func buildIf<Content: View>(_ content: Content?) -> Content? { content }
  public static func buildEither<Content: View>(first: Content) -> Modified { Modified() }
  public static func buildEither<Content: View>(second: Content) -> Modified { Modified() }
}

@MainActor @preconcurrency public protocol ViewModifier {
  associatedtype Body: View
  typealias Content = Modified
  @ViewBuilder @MainActor func body(content: Content) -> Body
}

public struct LocalizedStringKey: ExpressibleByStringInterpolation, Equatable, Sendable {
  private let key: String
  public init(stringLiteral value: String) { key = value }
}

@propertyWrapper public struct State<Value> {
  public init(wrappedValue: Value) {}
  public var wrappedValue: Value {
    get { fatalError("stub") }
    nonmutating set {}
  }
  public var projectedValue: Binding<Value> { Binding(stub: ()) }
}

@propertyWrapper @dynamicMemberLookup public struct Binding<Value> {
  public init(
    get: @escaping @MainActor @Sendable () -> Value,
    set: @escaping @MainActor @Sendable (Value) -> Void
  ) {}
  init(stub: Void) {}
  public var wrappedValue: Value {
    get { fatalError("stub") }
    nonmutating set {}
  }
  public var projectedValue: Self { self }
  public subscript<T>(dynamicMember path: WritableKeyPath<Value, T>) -> Binding<T> {
    Binding<T>(stub: ())
  }
}

extension Binding: @unchecked Sendable where Value: Sendable {}

@propertyWrapper @dynamicMemberLookup public struct Bindable<Value> {
  public var wrappedValue: Value
  public init(wrappedValue: Value) { self.wrappedValue = wrappedValue }
  public init(_ value: Value) { wrappedValue = value }
  public var projectedValue: Self { self }
  public subscript<T>(dynamicMember path: ReferenceWritableKeyPath<Value, T>) -> Binding<T> {
    Binding<T>(stub: ())
  }
}

@propertyWrapper public struct Environment<Value> {
  private let path: KeyPath<EnvironmentValues, Value>
  public init(_ path: KeyPath<EnvironmentValues, Value>) { self.path = path }
  public var wrappedValue: Value { EnvironmentValues()[keyPath: path] }
}

public struct EnvironmentValues {
  public init() {}
  @MainActor public var dismiss: DismissAction { DismissAction() }
  public var scenePhase: ScenePhase { .active }
}

@MainActor public struct DismissAction {
  public func callAsFunction() {}
}

public enum ScenePhase: Sendable { case background, inactive, active }

public protocol FocusedValueKey {
  associatedtype Value
}

public struct FocusedValues {
  public subscript<Key: FocusedValueKey>(key: Key.Type) -> Key.Value? {
    get { nil }
    set {}
  }
}

@propertyWrapper public struct FocusedValue<Value> {
  public init(_ path: KeyPath<FocusedValues, Value?>) {}
  public var wrappedValue: Value? { nil }
}
