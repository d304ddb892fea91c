import Foundation
import TrapezeKit

#if canImport(UIKit)
  import UIKit

  extension LifeCycle.System {
    /// UIKit's.
    public static var device: Self {
      Self(
        beginBackgroundTask: {
          let task = BackgroundTask()
          // When the time runs out everything is stopped already or never will be; the task ends so
          // that the system does not end the app.
          task.id = UIApplication.shared.beginBackgroundTask {
            UIApplication.shared.endBackgroundTask(task.id)
          }
          return task.id.rawValue
        },
        endBackgroundTask: {
          UIApplication.shared.endBackgroundTask(UIBackgroundTaskIdentifier(rawValue: $0))
        },
        setIdleSleep: { UIApplication.shared.isIdleTimerDisabled = !$0 })
    }
  }

  /// A task whose end is described before it has a number.
  @MainActor
  private final class BackgroundTask {
    var id = UIBackgroundTaskIdentifier.invalid
  }
#elseif canImport(AppKit)
  extension LifeCycle.System {
    /// A Mac's app goes on in the background; only sleep has to be held off.
    @MainActor public static var device: Self {
      let activity = Activity()
      return Self(
        beginBackgroundTask: { 0 }, endBackgroundTask: { _ in },
        setIdleSleep: { activity.setSleepAllowed($0) })
    }
  }

  /// Keeps a Mac awake while there is a token.
  @MainActor
  private final class Activity {
    private var token: (any NSObjectProtocol)?

    func setSleepAllowed(_ isAllowed: Bool) {
      if let token { ProcessInfo.processInfo.endActivity(token) }
      token =
        isAllowed
        ? nil
        : ProcessInfo.processInfo.beginActivity(
          options: [.userInitiated, .idleSystemSleepDisabled], reason: "training a scene")
    }
  }
#endif
