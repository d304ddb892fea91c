import Foundation

/// The core, as the rest of the app sees it: everything that opens a file or touches a device.
///
/// View models know this protocol and the four below it, and nothing of how they are made. The app
/// ships one engine, the Rust core; tests drive the view models with engines of their own.
///
/// ### Rules for an engine
/// - Every type is `Sendable`; two scenes may be used from different threads at once.
/// - What takes longer than a frame is a ``ProgressStream`` or an `async` function. Both are cancelled
///   by cancelling the task that waits: the stream then ends, the function throws `CancellationError`,
///   and the work has stopped soon after.
/// - Everything else that goes wrong is an ``EngineError``; an engine never traps on its input.
public protocol Engine: Sendable {
  /// Version of the core, e.g. `0.1.0`.
  var version: String { get }

  /// Reads a scene: a splat file or a folder. The caller keeps access to the URL until the scene is
  /// closed (see ``FileAccess``).
  func open(_ location: URL) -> ProgressStream<any SceneEngine>

  /// A renderer that shows `scene`. Compiles the pipelines on first use, with progress.
  func makeRenderer(
    for scene: any SceneEngine, options: RendererOptions
  ) -> ProgressStream<any RenderEngine>

  /// Looks at a folder of posed photographs, without decoding them.
  func inspectDataset(at location: URL) async throws -> DatasetSummary

  /// Prepares a run, or goes on with the one whose checkpoints are in `configuration.folder`.
  /// Throws ``EngineError`` with ``EngineError/Code/outOfMemory`` before anything is allocated when
  /// the run cannot fit.
  func makeTrainer(
    dataset: URL, configuration: TrainingConfiguration
  ) -> ProgressStream<any TrainEngine>

  /// Loads the text and image models in `models`. Throws ``EngineError/Code/modelsMissing`` and
  /// names the files when they are not there.
  func makeSearcher(models: URL) -> ProgressStream<any SearchEngine>

  /// Renders the built-in check scenes on this device and holds them to the f64 reference.
  func selfCheck() -> ProgressStream<SelfCheckReport>
}
