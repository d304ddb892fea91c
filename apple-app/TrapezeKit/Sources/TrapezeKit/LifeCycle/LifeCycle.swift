import Observation

/// Something that works on the device and has to stop when the app may not.
@MainActor
public protocol LifeCycleParticipant: AnyObject {
  /// Finishes what is on its way, saves what would be lost, starts nothing.
  func suspend() async
  /// Goes on as before.
  func resume() async
  /// Gives back what can be made again.
  func shedMemory() async
  /// Whether the device must not go to sleep by itself.
  var preventsSleep: Bool { get }
}

/// Keeps the app a good citizen: nothing on the graphics device in the background, where the system
/// would end the app for it, and nothing lost.
@MainActor @Observable
public final class LifeCycle {
  public enum State: Sendable, Equatable {
    case active, suspending, suspended
  }

  /// The system's side: asks for time to finish in the background, and gives it back.
  public struct System {
    public var beginBackgroundTask: @MainActor () -> Int
    public var endBackgroundTask: @MainActor (Int) -> Void
    public var setIdleSleep: @MainActor (_ isAllowed: Bool) -> Void

    public init(
      beginBackgroundTask: @escaping @MainActor () -> Int,
      endBackgroundTask: @escaping @MainActor (Int) -> Void,
      setIdleSleep: @escaping @MainActor (_ isAllowed: Bool) -> Void
    ) {
      self.beginBackgroundTask = beginBackgroundTask
      self.endBackgroundTask = endBackgroundTask
      self.setIdleSleep = setIdleSleep
    }
  }

  public private(set) var state = State.active
  @ObservationIgnored private let system: System
  @ObservationIgnored private var participants: [WeakParticipant] = []
  /// Those in the foreground.
  @ObservationIgnored private var windows: Set<ObjectIdentifier> = []
  @ObservationIgnored private var wantsToBeActive = true
  @ObservationIgnored private var transition: Task<Void, Never>?
  @ObservationIgnored private var allowsSleep = true

  private struct WeakParticipant {
    weak var value: (any LifeCycleParticipant)?
  }

  public init(system: System) {
    self.system = system
  }

  /// Participants are not kept alive, and are told in the order in which they came.
  public func add(_ participant: any LifeCycleParticipant) {
    participants.removeAll { $0.value == nil }
    participants.append(WeakParticipant(value: participant))
  }

  /// A window has left the screen. Work stops with the last one: an iPad shows several.
  public func enterBackground(window: ObjectIdentifier) {
    windows.remove(window)
    wantsToBeActive = !windows.isEmpty
    settleState()
  }

  public func enterForeground(window: ObjectIdentifier) {
    windows.insert(window)
    wantsToBeActive = true
    settleState()
  }

  public func memoryWarning() async {
    for participant in participants { await participant.value?.shedMemory() }
  }

  /// To be called when what ``LifeCycleParticipant/preventsSleep`` depends on has changed.
  public func refreshSleep() {
    let allowed = !participants.contains { $0.value?.preventsSleep == true }
    guard allowed != allowsSleep else { return }
    allowsSleep = allowed
    system.setIdleSleep(allowed)
  }

  /// Waits until the state is what was asked for.
  public func settle() async { await transition?.value }

  /// One change after the other: coming back while things are still being stopped resumes them once
  /// they have.
  private func settleState() {
    guard transition == nil else { return }
    transition = Task {
      while (state == .active) != wantsToBeActive {
        if wantsToBeActive { await resume() } else { await suspend() }
      }
      transition = nil
    }
  }

  private func suspend() async {
    state = .suspending
    let task = system.beginBackgroundTask()
    for participant in participants { await participant.value?.suspend() }
    state = .suspended
    refreshSleep()
    system.endBackgroundTask(task)
  }

  private func resume() async {
    for participant in participants { await participant.value?.resume() }
    state = .active
    refreshSleep()
  }
}

extension SceneModel: LifeCycleParticipant {
  public var preventsSleep: Bool { false }

  public func suspend() async {
    saveSettings()
    tuning.cancel()
    await tuning.settle()
    movie.cancel()
    await movie.settle()
    search.cancelEncoding()
    await search.settle()
    await viewer.loop.suspend()
  }

  public func resume() async { await viewer.loop.resume() }

  public func shedMemory() async { await viewer.renderer?.shedMemory() }
}

extension SelfCheckModel: LifeCycleParticipant {
  public var preventsSleep: Bool { isRunning }

  public func suspend() async {
    cancel()
    await settle()
  }

  /// A check that was interrupted measured nothing; whoever wants it runs it again.
  public func resume() async {}

  public func shedMemory() async {}
}

/// A run as the life cycle sees it: paused in the background, and going on afterwards if it was
/// going on before.
@MainActor
public final class TrainingLifeCycle: LifeCycleParticipant {
  private let training: TrainingModel
  private var resumes = false

  public init(_ training: TrainingModel) {
    self.training = training
  }

  public var preventsSleep: Bool { training.isRunning }

  public func suspend() async {
    resumes = training.canPause
    await training.pause()
    // A picture of it may be on its way still.
    await training.settle()
  }

  public func resume() async {
    if resumes { training.resume() }
    resumes = false
  }

  /// The run's own buffers are all in use; what it holds back is nothing.
  public func shedMemory() async {}
}
