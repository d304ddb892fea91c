/// Which way is up in a scene. Files do not say: COLMAP's worlds usually have y down, Blender's z up.
public enum UpAxis: String, Sendable, Codable, CaseIterable, Identifiable {
  case minusY, plusY, plusZ, minusZ, plusX, minusX

  public var id: Self { self }

  public var direction: Vector3 {
    switch self {
    case .plusX: Vector3(1, 0, 0)
    case .minusX: Vector3(-1, 0, 0)
    case .plusY: Vector3(0, 1, 0)
    case .minusY: Vector3(0, -1, 0)
    case .plusZ: Vector3(0, 0, 1)
    case .minusZ: Vector3(0, 0, -1)
    }
  }
}

extension UpAxis {
  /// What is up in a scene that nobody has corrected yet. Deformable scenes come from Blender's and
  /// D-NeRF's worlds, the others mostly from COLMAP's, whose cameras were held upright with y down.
  static func guess(for summary: SceneSummary) -> Self {
    summary.isDeformable ? .plusZ : .minusY
  }
}

/// A side to look from.
public enum ViewPreset: String, Sendable, CaseIterable, Identifiable {
  case front, back, left, right, top, bottom

  public var id: Self { self }

  /// Azimuth and elevation in radians.
  var angles: (azimuth: Double, elevation: Double) {
    switch self {
    case .front: (0, 0)
    case .right: (.pi / 2, 0)
    case .back: (.pi, 0)
    case .left: (-.pi / 2, 0)
    case .top: (0, .pi / 2)
    case .bottom: (0, -.pi / 2)
    }
  }
}
