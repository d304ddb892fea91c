import AVFoundation
import CoreVideo
import Foundation
import TrapezeKit

/// An MP4 with H.264, written frame by frame.
actor MovieFile: MovieWriter {
  private let writer: AVAssetWriter
  private let input: AVAssetWriterInput
  private let adaptor: AVAssetWriterInputPixelBufferAdaptor
  private let framesPerSecond: Int
  private var count = 0

  /// Sides have to be even.
  init(url: URL, width: Int, height: Int, framesPerSecond: Int) throws {
    self.framesPerSecond = framesPerSecond
    writer = try AVAssetWriter(outputURL: url, fileType: .mp4)
    input = AVAssetWriterInput(
      mediaType: .video,
      outputSettings: [
        AVVideoCodecKey: AVVideoCodecType.h264, AVVideoWidthKey: width, AVVideoHeightKey: height,
      ])
    input.expectsMediaDataInRealTime = false
    adaptor = AVAssetWriterInputPixelBufferAdaptor(
      assetWriterInput: input,
      sourcePixelBufferAttributes: [
        kCVPixelBufferPixelFormatTypeKey as String: kCVPixelFormatType_32BGRA,
        kCVPixelBufferWidthKey as String: width, kCVPixelBufferHeightKey as String: height,
      ])
    writer.add(input)
    guard writer.startWriting() else { throw Self.failure(writer, url) }
    writer.startSession(atSourceTime: .zero)
  }

  func append(_ image: RenderedImage) async throws {
    while !input.isReadyForMoreMediaData {
      if writer.status == .failed { throw Self.failure(writer, writer.outputURL) }
      try await Task.sleep(for: .milliseconds(5))
    }
    let time = CMTime(value: CMTimeValue(count), timescale: CMTimeScale(framesPerSecond))
    guard let buffer = pixelBuffer(image), adaptor.append(buffer, withPresentationTime: time) else {
      throw Self.failure(writer, writer.outputURL)
    }
    count += 1
  }

  func finish() async throws {
    input.markAsFinished()
    await withCheckedContinuation { continuation in
      writer.finishWriting { continuation.resume() }
    }
    if writer.status != .completed { throw Self.failure(writer, writer.outputURL) }
  }

  func discard() async {
    writer.cancelWriting()
    // There may be nothing to remove.
    try? FileManager.default.removeItem(at: writer.outputURL)
  }

  private static func failure(_ writer: AVAssetWriter, _ url: URL) -> EngineError {
    let reason = writer.error.map { $0.localizedDescription } ?? "cannot be written"
    return EngineError(.unwritableFile, "\(url.lastPathComponent): \(reason)")
  }

  private func pixelBuffer(_ image: RenderedImage) -> CVPixelBuffer? {
    guard let pool = adaptor.pixelBufferPool else { return nil }
    var buffer: CVPixelBuffer?
    CVPixelBufferPoolCreatePixelBuffer(nil, pool, &buffer)
    guard let buffer, image.copy(to: buffer) else { return nil }
    return buffer
  }
}

extension RenderedImage {
  /// Writes the pixels in the encoder's order of channels: blue, green, red. Returns whether the
  /// buffer has the image's size.
  fileprivate func copy(to buffer: CVPixelBuffer) -> Bool {
    guard CVPixelBufferGetWidth(buffer) == width, CVPixelBufferGetHeight(buffer) == height,
      CVPixelBufferLockBaseAddress(buffer, []) == 0
    else { return false }
    let base = CVPixelBufferGetBaseAddress(buffer)
    let stride = CVPixelBufferGetBytesPerRow(buffer)
    rgba.withUnsafeBytes { (pixels: UnsafeRawBufferPointer) in
      for y in 0..<height {
        guard let row = base?.advanced(by: y * stride) else { return }
        copyRow(from: pixels[(4 * width * y)...], to: row.assumingMemoryBound(to: UInt8.self))
      }
    }
    CVPixelBufferUnlockBaseAddress(buffer, [])
    return base != nil
  }

  private func copyRow(
    from pixels: Slice<UnsafeRawBufferPointer>, to row: UnsafeMutablePointer<UInt8>
  ) {
    let start = pixels.startIndex
    for x in 0..<width {
      row[4 * x] = pixels[start + 4 * x + 2]
      row[4 * x + 1] = pixels[start + 4 * x + 1]
      row[4 * x + 2] = pixels[start + 4 * x]
      row[4 * x + 3] = 255
    }
  }
}
