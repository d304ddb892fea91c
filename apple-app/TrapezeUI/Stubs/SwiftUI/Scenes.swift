#if canImport(UIKit)
  import UIKit
#else
  import AppKit
#endif

public struct ToolbarItemPlacement: Sendable {
  public static let cancellationAction = ToolbarItemPlacement()
  public static let primaryAction = ToolbarItemPlacement()
}

@MainActor public protocol ToolbarContent {}
public struct AnyToolbarContent: ToolbarContent {}
public struct ToolbarItem: ToolbarContent {
  public init<C: View>(placement: ToolbarItemPlacement, @ViewBuilder content: () -> C) {}
}
public struct ToolbarItemGroup: ToolbarContent {
  public init<C: View>(placement: ToolbarItemPlacement, @ViewBuilder content: () -> C) {}
}

@resultBuilder public enum ToolbarContentBuilder {
  public static func buildBlock<each C: ToolbarContent>(
    _ content: repeat each C
  ) -> AnyToolbarContent { AnyToolbarContent() }
}

@MainActor @preconcurrency public protocol Commands {
  associatedtype Body: Commands
  @CommandsBuilder @MainActor var body: Body { get }
}
extension Never: Commands {}

public struct AnyCommands: Commands {
  public var body: Never { return fatalError("stub") }
}
public struct CommandMenu: Commands {
  public init<C: View>(_ name: LocalizedStringKey, @ViewBuilder content: () -> C) {}
  public var body: Never { return fatalError("stub") }
}
public struct CommandGroupPlacement: Sendable {
  public static let undoRedo = CommandGroupPlacement()
  public static let saveItem = CommandGroupPlacement()
}
public struct CommandGroup: Commands {
  public init<C: View>(replacing group: CommandGroupPlacement, @ViewBuilder addition: () -> C) {}
  public init<C: View>(after group: CommandGroupPlacement, @ViewBuilder addition: () -> C) {}
  public var body: Never { return fatalError("stub") }
}

@resultBuilder public enum CommandsBuilder {
  public static func buildBlock<each C: Commands>(_ commands: repeat each C) -> AnyCommands {
    AnyCommands()
  }
}

public struct KeyEquivalent: Sendable, ExpressibleByExtendedGraphemeClusterLiteral {
  public static let leftArrow: KeyEquivalent = "l"
  public static let rightArrow: KeyEquivalent = "r"
  public static let delete: KeyEquivalent = "d"
  public init(_ character: Character) {}
  public init(extendedGraphemeClusterLiteral: Character) {}
}

public struct EventModifiers: OptionSet, Sendable {
  public static let command = EventModifiers(rawValue: 1)
  public static let shift = EventModifiers(rawValue: 2)
  public let rawValue: Int
  public init(rawValue: Int) { self.rawValue = rawValue }
}

@MainActor public struct RepresentableContext {}

#if canImport(UIKit)
  @MainActor @preconcurrency public protocol UIViewRepresentable: Leaf {
    associatedtype UIViewType: UIView
    typealias Context = RepresentableContext
    func makeUIView(context: Context) -> UIViewType
    func updateUIView(_ view: UIViewType, context: Context)
    static func dismantleUIView(_ view: UIViewType, coordinator: Void)
  }
  extension UIViewRepresentable {
    public static func dismantleUIView(_ view: UIViewType, coordinator: Void) {}
  }
#else
  @MainActor @preconcurrency public protocol NSViewRepresentable: Leaf {
    associatedtype NSViewType: NSView
    typealias Context = RepresentableContext
    func makeNSView(context: Context) -> NSViewType
    func updateNSView(_ view: NSViewType, context: Context)
    static func dismantleNSView(_ view: NSViewType, coordinator: Void)
  }
  extension NSViewRepresentable {
    public static func dismantleNSView(_ view: NSViewType, coordinator: Void) {}
  }
#endif
