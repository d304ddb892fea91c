import Foundation
import Testing
import TrapezeKit

@testable import TrapezeUI

@Suite struct FiguresTests {
  @Test func whatIsNotKnownIsADash() {
    #expect(Figures.milliseconds(nil) == "–")
    #expect(Figures.duration(.nan) == "–")
  }

  @Test func equalImagesHaveNoError() {
    #expect(Figures.decibels(nil) == "∞ dB")
    #expect(Figures.decibels(.infinity) == "∞ dB")
  }

  @Test func durationsAreMinutesAndSeconds() {
    #expect(Figures.duration(0) == "0:00")
    #expect(Figures.duration(59.6) == "1:00")
    #expect(Figures.duration(3_605) == "60:05")
    #expect(Figures.duration(.greatestFiniteMagnitude).isEmpty == false)
  }

  @Test func bytesAreMebibytes() {
    #expect(Figures.megabytes(0).hasSuffix(" MiB"))
    #expect(Figures.megabytes(200 * 1_048_576) == "200 MiB")
  }
}

@Suite struct TitleTests {
  /// Two choices with one word would be one button for two things.
  @Test func choicesOfOnePickerAreCalledDifferently() {
    func areDistinct<T: CaseIterable>(_ type: T.Type, _ title: (T) -> some Equatable) -> Bool {
      let titles = T.allCases.map(title)
      return titles.indices.allSatisfy { index in
        titles[..<index].allSatisfy { $0 != titles[index] }
      }
    }
    #expect(areDistinct(FrameRequest.Mode.self) { $0.title })
    #expect(areDistinct(PlaybackClock.LoopMode.self) { $0.title })
    #expect(areDistinct(ViewPreset.self) { $0.title })
    #expect(areDistinct(UpAxis.self) { $0.title })
    #expect(areDistinct(ExportFormat.self) { $0.title })
    #expect(areDistinct(TrainingPreset.self) { $0.title })
    #expect(areDistinct(Advice.self) { $0.text })
    #expect(areDistinct(FailedTask.self) { $0.title })
    #expect(areDistinct(SceneView.Panel.self) { $0.title })
  }
}
