@_exported import CoreGraphics

public final class CGImageDestination {}

public func CGImageDestinationCreateWithURL(
  _ url: CFURL, _ type: CFString, _ count: Int, _ options: [String: Any]?
) -> CGImageDestination? { nil }

public func CGImageDestinationAddImage(
  _ destination: CGImageDestination, _ image: CGImage, _ properties: [String: Any]?
) {}

public func CGImageDestinationFinalize(_ destination: CGImageDestination) -> Bool { false }
