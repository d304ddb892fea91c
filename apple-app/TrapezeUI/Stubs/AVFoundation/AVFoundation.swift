@_exported import CoreVideo

public typealias CMTimeValue = Int64
public typealias CMTimeScale = Int32

public struct CMTime: Sendable {
  public static let zero = CMTime(value: 0, timescale: 1)
  public init(value: CMTimeValue, timescale: CMTimeScale) {}
}

public final class CMSampleBuffer {}
public struct AVFileType: Sendable { public static let mp4 = AVFileType() }
public struct AVMediaType: Sendable { public static let video = AVMediaType() }
public struct AVVideoCodecType: Sendable { public static let h264 = AVVideoCodecType() }
public let AVVideoCodecKey = "codec"
public let AVVideoWidthKey = "width"
public let AVVideoHeightKey = "height"

public final class AVAssetWriterInput: NSObject {
  public init(mediaType: AVMediaType, outputSettings: [String: Any]?) {}
  public var expectsMediaDataInRealTime = false
  public var isReadyForMoreMediaData: Bool { true }
  public func markAsFinished() {}
}

public final class AVAssetWriterInputPixelBufferAdaptor: NSObject {
  public init(assetWriterInput: AVAssetWriterInput, sourcePixelBufferAttributes: [String: Any]?) {}
  public var pixelBufferPool: CVPixelBufferPool? { nil }
  public func append(_ buffer: CVPixelBuffer, withPresentationTime time: CMTime) -> Bool { false }
}

public final class AVAssetWriter: NSObject {
  public enum Status: Int { case unknown, writing, completed, failed, cancelled }
  public let outputURL: URL
  public init(outputURL: URL, fileType: AVFileType) throws { self.outputURL = outputURL }
  public var status: Status { .unknown }
  public var error: (any Error)? { nil }
  public func add(_ input: AVAssetWriterInput) {}
  public func startWriting() -> Bool { false }
  public func startSession(atSourceTime time: CMTime) {}
  public func finishWriting(completionHandler handler: @escaping @Sendable () -> Void) {}
  public func cancelWriting() {}
}

open class AVCaptureInput: NSObject {}
open class AVCaptureOutput: NSObject {}
public final class AVCaptureConnection: NSObject {}

public final class AVCaptureDevice: NSObject {
  public static func `default`(for type: AVMediaType) -> AVCaptureDevice? { nil }
  public static func requestAccess(for type: AVMediaType) async -> Bool { false }
}

public final class AVCaptureDeviceInput: AVCaptureInput {
  public init(device: AVCaptureDevice) throws {}
}

public protocol AVCaptureVideoDataOutputSampleBufferDelegate: NSObjectProtocol {
  func captureOutput(
    _ output: AVCaptureOutput, didOutput sampleBuffer: CMSampleBuffer,
    from connection: AVCaptureConnection)
}

public final class AVCaptureVideoDataOutput: AVCaptureOutput {
  public var alwaysDiscardsLateVideoFrames = false
  public func setSampleBufferDelegate(
    _ delegate: (any AVCaptureVideoDataOutputSampleBufferDelegate)?, queue: DispatchQueue?
  ) {}
}

public final class AVCaptureSession: NSObject {
  public struct Preset: Sendable { public static let vga640x480 = Preset() }
  public var sessionPreset = Preset.vga640x480
  public var inputs: [AVCaptureInput] { [] }
  public func canAddInput(_ input: AVCaptureInput) -> Bool { false }
  public func canAddOutput(_ output: AVCaptureOutput) -> Bool { false }
  public func addInput(_ input: AVCaptureInput) {}
  public func addOutput(_ output: AVCaptureOutput) {}
  public func startRunning() {}
  public func stopRunning() {}
}
