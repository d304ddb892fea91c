public enum HorizontalAlignment: Sendable { case leading, center, trailing }
public enum VerticalAlignment: Sendable { case top, center, bottom }

public struct Alignment: Sendable {
  public static let leading = Alignment()
  public static let bottom = Alignment()
  public static let center = Alignment()
}

public enum Edge: Sendable {
  public struct Set: OptionSet, Sendable {
    public static let all = Set(rawValue: 15)
    public static let horizontal = Set(rawValue: 3)
    public static let vertical = Set(rawValue: 12)
    public let rawValue: Int8
    public init(rawValue: Int8) { self.rawValue = rawValue }
  }
}

public struct HStack: Leaf {
  public init<C: View>(
    alignment: VerticalAlignment = .center, spacing: CGFloat? = nil, @ViewBuilder content: () -> C
  ) {}
}
public struct VStack: Leaf {
  public init<C: View>(
    alignment: HorizontalAlignment = .center, spacing: CGFloat? = nil,
    @ViewBuilder content: () -> C
  ) {}
}
public struct ZStack: Leaf {
  public init<C: View>(alignment: Alignment = .center, @ViewBuilder content: () -> C) {}
}
public struct Grid: Leaf {
  public init<C: View>(
    alignment: Alignment = .center, horizontalSpacing: CGFloat? = nil,
    verticalSpacing: CGFloat? = nil, @ViewBuilder content: () -> C
  ) {}
}
public struct GridRow: Leaf { public init<C: View>(@ViewBuilder content: () -> C) {} }
public struct Group: Leaf { public init<C: View>(@ViewBuilder content: () -> C) {} }
public struct Spacer: Leaf { public init() {} }
public struct Divider: Leaf { public init() {} }
public struct List: Leaf { public init<C: View>(@ViewBuilder content: () -> C) {} }
public struct Form: Leaf { public init<C: View>(@ViewBuilder content: () -> C) {} }
public struct NavigationStack: Leaf { public init<C: View>(@ViewBuilder root: () -> C) {} }

public struct Section: Leaf {
  public init<C: View>(@ViewBuilder content: () -> C) {}
  public init<C: View>(_ title: LocalizedStringKey, @ViewBuilder content: () -> C) {}
  public init<C: View, H: View>(@ViewBuilder content: () -> C, @ViewBuilder header: () -> H) {}
  public init<C: View, F: View>(@ViewBuilder content: () -> C, @ViewBuilder footer: () -> F) {}
  public init<C: View, H: View, F: View>(
    @ViewBuilder content: () -> C, @ViewBuilder header: () -> H, @ViewBuilder footer: () -> F
  ) {}
}

public struct ForEach: Leaf {
  public init<D: RandomAccessCollection, C: View>(
    _ data: D, @ViewBuilder content: @escaping (D.Element) -> C
  ) where D.Element: Identifiable {}
  public init<D: RandomAccessCollection, ID: Hashable, C: View>(
    _ data: D, id: KeyPath<D.Element, ID>, @ViewBuilder content: @escaping (D.Element) -> C
  ) {}
}

public struct Canvas: Leaf {
  public init(renderer: @escaping (inout GraphicsContext, CGSize) -> Void) {}
}

public struct GraphicsContext {
  public struct Shading { public static func color(_ color: Color) -> Shading { Shading() } }
  public func stroke(_ path: Path, with shading: Shading, lineWidth: CGFloat = 1) {}
}

public struct Path {
  public init() {}
  public mutating func move(to point: CGPoint) {}
  public mutating func addLine(to point: CGPoint) {}
}

public protocol ShapeStyle {}
public protocol Shape: View {}

public struct Material: ShapeStyle, Sendable {}
extension ShapeStyle where Self == Material {
  public static var regularMaterial: Material { Material() }
}

public struct Capsule: Shape, Leaf { public init() {} }
public struct RoundedRectangle: Shape, Leaf { public init(cornerRadius: CGFloat) {} }

public struct Color: ShapeStyle, Equatable, Sendable {
  public enum RGBColorSpace: Sendable { case sRGB }
  public struct Resolved: Sendable {
    public var red: Float = 0
    public var green: Float = 0
    public var blue: Float = 0
  }
  public static let accentColor = Color()
  public static let yellow = Color()
  public static let secondary = Color()
  private init() {}
  public init(
    _ space: RGBColorSpace = .sRGB, red: Double, green: Double, blue: Double, opacity: Double = 1
  ) {}
  public func resolve(in environment: EnvironmentValues) -> Resolved { Resolved() }
}

public struct Font: Sendable {
  public static let caption = Font()
  public static let headline = Font()
  public func monospacedDigit() -> Font { self }
  public func monospaced() -> Font { self }
}
