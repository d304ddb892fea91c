import Foundation

/// The head's place from a face in a camera's picture, where there is no depth.
public enum HeadEstimate {
  /// Horizontal opening of a laptop's camera, radians. Only the angles count, so another camera
  /// makes the effect a little stronger or weaker.
  static let fieldOfView = 60 * Double.pi / 180

  /// `x` and `y` are the middle of the face in 0–1 of the picture, from its lower left corner; the
  /// picture is not mirrored, so a head at the viewer's right is at its left.
  public static func position(x: Double, y: Double, aspect: Double) -> Vector3 {
    Vector3(0.5 - x, (y - 0.5) / max(aspect, 1e-3), 0.5 / tan(fieldOfView / 2))
  }
}
