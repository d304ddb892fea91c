import SwiftUI
import TrapezeKit

/// Play and pause, the time slider, speed and what happens at the end.
struct PlaybackBar: View {
  let playback: PlaybackModel

  static let speeds: [Double] = [0.1, 0.25, 0.5, 1, 2, 4]

  var body: some View {
    HStack(spacing: 12) {
      Button {
        playback.step(frames: -1)
      } label: {
        Label("Previous frame", systemImage: "backward.frame.fill")
      }
      Button {
        playback.toggle()
      } label: {
        playback.isPlaying
          ? Label("Pause", systemImage: "pause.fill") : Label("Play", systemImage: "play.fill")
      }
      Button {
        playback.step(frames: 1)
      } label: {
        Label("Next frame", systemImage: "forward.frame.fill")
      }
      Slider(
        value: Binding(get: { playback.time }, set: { playback.scrub(to: $0) }), in: 0...1
      ) {
        Text("Time")
      } onEditingChanged: { isEditing in
        if !isEditing { playback.endScrub() }
      }
      .accessibilityValue(Text(verbatim: Figures.percent(playback.time * 100)))
      Text(verbatim: Figures.decimal(playback.time, digits: 2)).monospacedDigit()
        .accessibilityHidden(true)
      options
    }
    .labelStyle(.iconOnly)
    .buttonStyle(.borderless)
    .padding(.horizontal, 16)
    .padding(.vertical, 8)
    .background(.regularMaterial, in: Capsule())
  }

  private var options: some View {
    Menu {
      Picker(
        "Speed", selection: Binding(get: { playback.speed }, set: { playback.speed = $0 })
      ) {
        ForEach(Self.speeds, id: \.self) { Text(verbatim: Figures.factor($0)).tag($0) }
      }
      Picker(
        "At the end",
        selection: Binding(get: { playback.loopMode }, set: { playback.loopMode = $0 })
      ) {
        ForEach(PlaybackClock.LoopMode.allCases) { Label($0.title, systemImage: $0.symbol).tag($0) }
      }
      Picker(
        "Length", selection: Binding(get: { playback.duration }, set: { playback.duration = $0 })
      ) {
        ForEach([2.0, 5, 10, 20, 60], id: \.self) { Text("\(Int($0)) seconds").tag($0) }
      }
    } label: {
      Label("Playback options", systemImage: playback.loopMode.symbol)
    }
  }
}
