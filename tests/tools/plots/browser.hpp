#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace armcmc::test {

/// What a browser made of one figure.
struct DrawnFigure {
  std::string kind;  ///< "xy", "heat-map"
  bool drawn = false;
  long marks = 0;  ///< Coloured pixels of the canvas, or cells of the map: 0 is an empty plot.
};

/// What a browser made of a page.
struct BrowserView {
  std::vector<std::string> complaints;  ///< Errors and messages of its console, and uncaught errors.
  std::vector<DrawnFigure> figures;
  std::string dom;
};

/// $ARMCMC_BROWSER, or a Chromium on the path.
[[nodiscard]] std::optional<std::filesystem::path> FindBrowser();
inline constexpr const char* kBrowserSkipReason =
    "needs Chromium: tools/install-dependencies --with browser, or set ARMCMC_BROWSER to one";

/// Opens a page without a screen and without a network, prints it (on nothing), and looks at what was drawn.
/// @throws std::runtime_error when the browser fails or does not come back.
[[nodiscard]] BrowserView View(const std::string& html);

}  // namespace armcmc::test

/// Skips the running test where there is no browser.
#define ARMCMC_REQUIRE_BROWSER() \
  if (!::armcmc::test::FindBrowser()) GTEST_SKIP() << ::armcmc::test::kBrowserSkipReason
