@_exported import Foundation

public struct CMQuaternion: Sendable {
  public var x = 0.0
  public var y = 0.0
  public var z = 0.0
  public var w = 1.0
}

public final class CMAttitude: NSObject {
  public var quaternion: CMQuaternion { CMQuaternion() }
}

public final class CMDeviceMotion: NSObject {
  public var attitude: CMAttitude { CMAttitude() }
}

public final class CMMotionManager: NSObject {
  public var isDeviceMotionAvailable: Bool { false }
  public var deviceMotionUpdateInterval = 0.0
  public func startDeviceMotionUpdates(
    to queue: OperationQueue,
    withHandler handler: @escaping @Sendable (CMDeviceMotion?, (any Error)?) -> Void
  ) {}
  public func stopDeviceMotionUpdates() {}
}
