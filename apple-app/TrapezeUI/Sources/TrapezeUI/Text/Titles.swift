import SwiftUI
import TrapezeKit

// What choices are called. The words are looked up in the app's string catalog.

extension FrameRequest.Mode {
  var title: LocalizedStringKey {
    switch self {
    case .color: "Colour"
    case .clusters: "Objects"
    case .depth: "Depth"
    case .motion: "Motion"
    }
  }
}

extension PlaybackClock.LoopMode {
  var title: LocalizedStringKey {
    switch self {
    case .once: "Play once"
    case .loop: "Loop"
    case .pingPong: "Back and forth"
    }
  }

  var symbol: String {
    switch self {
    case .once: "arrow.right.to.line"
    case .loop: "repeat"
    case .pingPong: "arrow.left.and.right"
    }
  }
}

extension ViewPreset {
  var title: LocalizedStringKey {
    switch self {
    case .front: "Front"
    case .back: "Back"
    case .left: "Left"
    case .right: "Right"
    case .top: "Top"
    case .bottom: "Bottom"
    }
  }
}

extension UpAxis {
  var title: LocalizedStringKey {
    switch self {
    case .plusX: "+X is up"
    case .minusX: "−X is up"
    case .plusY: "+Y is up"
    case .minusY: "−Y is up"
    case .plusZ: "+Z is up"
    case .minusZ: "−Z is up"
    }
  }
}

extension ParallaxModel.Source {
  var title: LocalizedStringKey {
    switch self {
    case .off: "Off"
    case .device: "Device motion"
    case .head: "Head tracking"
    }
  }
}

extension RendererOptions.Precision {
  var title: LocalizedStringKey {
    switch self {
    case .single: "32-bit"
    case .half: "16-bit"
    }
  }
}

extension SearchSettings.Scope {
  var title: LocalizedStringKey {
    switch self {
    case .all: "All objects"
    case .visible: "Visible objects"
    case .chosen: "Selected objects"
    }
  }
}

extension ExportFormat {
  var title: LocalizedStringKey {
    switch self {
    case .ply: "PLY, full precision"
    case .spz: "SPZ, small file"
    case .folder: "Scene folder, with objects and motion"
    }
  }
}

extension CameraMove.Kind {
  var title: LocalizedStringKey {
    switch self {
    case .turntable: "Turntable"
    case .time: "Scene's time"
    case .turntableAndTime: "Turntable and time"
    }
  }
}

extension TrainingPreset {
  var title: LocalizedStringKey {
    switch self {
    case .draft: "Draft"
    case .standard: "Standard"
    case .fine: "Fine"
    }
  }
}

extension TrainingDevice {
  var title: LocalizedStringKey {
    switch self {
    case .automatic: "Whatever is faster"
    case .gpu: "Graphics processor"
    case .cpu: "Processor"
    }
  }
}

extension KeyframePolicy.Rejection {
  var hint: LocalizedStringKey {
    switch self {
    case .poorTracking: "Tracking is lost. Point at something with texture and move slowly."
    case .tooClose: "Move on: this place is already covered."
    case .tooFast: "Slower: the picture would be blurred."
    case .full: "That is all a capture can hold. Finish it now."
    }
  }
}

extension ProgressStep.Stage {
  var title: LocalizedStringKey {
    switch self {
    case .reading: "Reading…"
    case .uploading: "Sending to the GPU…"
    case .compiling: "Preparing the renderer…"
    case .encoding: "Looking at objects…"
    case .rendering: "Rendering…"
    case .measuring: "Measuring…"
    case .writing: "Writing…"
    case .preparing: "Preparing…"
    }
  }
}

extension FailedTask {
  var title: LocalizedStringKey {
    switch self {
    case .opening: "The scene could not be opened"
    case .drawing: "The scene could not be drawn"
    case .editing: "The edit could not be made"
    case .exporting: "The file could not be written"
    case .searching: "The search failed"
    case .training: "Training stopped"
    case .capturing: "The capture could not be saved"
    case .checking: "The self-check could not run"
    }
  }
}

extension Advice {
  var text: LocalizedStringKey {
    switch self {
    case .chooseAnotherFile: "Check that the file is still there, or choose another one."
    case .checkFormat:
      "The file is damaged or not of a kind that Trapeze reads: PLY, SPZ, SPLAT, SOG or a scene folder."
    case .freeStorage: "Free some storage or choose another place, then try again."
    case .reportFault:
      "This is a fault in Trapeze. Run the self-check in the library and send its report with this message."
    case .closeOtherScenes: "Close other scenes and apps, or open a smaller scene."
    case .useAnotherDevice: "This device's graphics processor cannot run the renderer."
    case .tryAgain: "Try again. If it happens again, close the scene and open it anew."
    case .addModels: "Add the search models; the search panel says how."
    case .checkDataset:
      "Choose a folder with photographs and their poses: transforms.json, COLMAP, Polycam, Record3D or NeRFCapture."
    case .lowerQuality: "Choose a lower quality and try again."
    case .changeEdit: "Change the selection or the box so that something is left."
    }
  }
}
