import Foundation

/// A training run. It goes on while somebody reads ``run()``, and has a state to return to always.
public protocol TrainEngine: AnyObject, Sendable {
  /// Steps taken, those of earlier processes of the same run included.
  var step: Int { get }

  /// Takes steps and tells about them until the last one, or until the reader stops: then the
  /// state is saved as by ``checkpoint()``. One reader at a time.
  func run() -> AsyncThrowingStream<TrainEvent, any Error>

  /// Saves the state on disk, so that another process can go on with the same bits.
  func checkpoint() async throws

  /// The splats as they are now, as a photograph's camera sees them at its time.
  func preview(_ photograph: Photograph) async throws -> RenderedImage

  /// The scene as it is now.
  func scene() async throws -> any SceneEngine

  /// Name of what it trains on: the graphics device, or the CPU.
  var deviceName: String { get }

  /// Where and when the dataset's views were taken, for the live view.
  var photographs: [Photograph] { get }
}

/// Where and when a view of a dataset was taken.
public struct Photograph: Sendable, Equatable {
  public var camera: Camera
  /// Of the scene, 0 to 1; 0 in a dataset without times.
  public var time: Float

  public init(camera: Camera, time: Float) {
    self.camera = camera
    self.time = time
  }
}

/// What a run is asked for.
public struct TrainingConfiguration: Sendable, Equatable, Codable {
  public var steps: Int
  /// Most splats; `nil` lets the run find how many the scene needs.
  public var maxSplats: Int?
  public var harmonicsDegree: Int
  /// Whole factor by which photographs are made smaller, at least 1.
  public var downscale: Int
  /// Every how many-th view is held out to measure the result; `nil` trains on all.
  public var holdout: Int?
  /// Where checkpoints and the result are kept.
  public var folder: URL
  /// Bytes that the run may take; `nil` asks the system.
  public var memoryLimit: UInt64?
  /// What it trains on.
  public var device: TrainingDevice

  public init(
    steps: Int, maxSplats: Int?, harmonicsDegree: Int, downscale: Int, holdout: Int?,
    folder: URL, memoryLimit: UInt64? = nil, device: TrainingDevice = .automatic
  ) {
    self.steps = steps
    self.maxSplats = maxSplats
    self.harmonicsDegree = harmonicsDegree
    self.downscale = downscale
    self.holdout = holdout
    self.folder = folder
    self.memoryLimit = memoryLimit
    self.device = device
  }
}

/// What a run may train on.
public enum TrainingDevice: String, Sendable, Codable, CaseIterable, Identifiable {
  /// The graphics device where there is one that is faster, else the CPU.
  case automatic
  case gpu
  case cpu

  public var id: Self { self }
}

/// A dataset in numbers.
public struct DatasetSummary: Sendable, Equatable {
  /// The layout that was recognised, e.g. `transforms.json`.
  public var format: String
  public var viewCount: Int
  /// Size of the first photograph in pixels.
  public var width: Int
  public var height: Int
  /// Sparse points to start from; 0 where there are none.
  public var pointCount: Int
  /// What was guessed while reading, one line each.
  public var warnings: [String]

  public init(
    format: String, viewCount: Int, width: Int, height: Int, pointCount: Int, warnings: [String]
  ) {
    self.format = format
    self.viewCount = viewCount
    self.width = width
    self.height = height
    self.pointCount = pointCount
    self.warnings = warnings
  }
}

/// News of a run.
public enum TrainEvent: Sendable, Equatable {
  /// Figures, at regular steps.
  case report(TrainReport)
  /// A state that a killed run goes on from is on disk.
  case saved(step: Int)
  /// The run went back to its last good state.
  case rolledBack(from: Int, to: Int, reason: String)
  /// Every step was taken.
  case finished(TrainReport, test: TestFigures?)
}

/// The state of a run in figures.
public struct TrainReport: Sendable, Equatable {
  public var step: Int
  public var steps: Int
  public var seconds: Double
  public var stepsPerSecond: Double
  public var loss: Double
  /// Of the view that was trained on last, dB.
  public var psnr: Double
  public var splatCount: Int

  public init(
    step: Int, steps: Int, seconds: Double, stepsPerSecond: Double, loss: Double, psnr: Double,
    splatCount: Int
  ) {
    self.step = step
    self.steps = steps
    self.seconds = seconds
    self.stepsPerSecond = stepsPerSecond
    self.loss = loss
    self.psnr = psnr
    self.splatCount = splatCount
  }
}

/// How good the result is on views it has not seen.
public struct TestFigures: Sendable, Equatable {
  public var psnr: Double
  public var ssim: Double

  public init(psnr: Double, ssim: Double) {
    self.psnr = psnr
    self.ssim = ssim
  }
}
