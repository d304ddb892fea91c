import XCTest

/// Starts the app and goes through what somebody new sees.
final class SmokeTests: XCTestCase {
  @MainActor
  func testTheSampleSceneOpensPlaysAndCloses() throws {
    let app = XCUIApplication()
    app.launch()
    if !app.buttons["Close scene"].waitForExistence(timeout: 60) {
      app.buttons["Sample scene"].firstMatch.tap()
    }
    XCTAssertTrue(app.buttons["Close scene"].waitForExistence(timeout: 60))
    let pause = app.buttons["Pause"].firstMatch
    XCTAssertTrue(pause.waitForExistence(timeout: 10), "the sample scene moves")
    pause.tap()
    XCTAssertTrue(app.buttons["Play"].firstMatch.waitForExistence(timeout: 10))

    let picture = XCTAttachment(screenshot: app.screenshot())
    picture.name = "sample scene"
    picture.lifetime = .keepAlways
    add(picture)

    app.buttons["Close scene"].firstMatch.tap()
    XCTAssertTrue(app.buttons["Self-check"].firstMatch.waitForExistence(timeout: 10))
  }

  @MainActor
  func testTheSelfCheckPassesOnThisDevice() throws {
    let app = XCUIApplication()
    app.launch()
    let close = app.buttons["Close scene"].firstMatch
    if close.waitForExistence(timeout: 60) { close.tap() }
    app.buttons["Self-check"].firstMatch.tap()
    app.buttons["Run the self-check"].firstMatch.tap()
    XCTAssertTrue(app.staticTexts["Everything agrees"].waitForExistence(timeout: 180))
  }
}
