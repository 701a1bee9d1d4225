#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "support/process.hpp"

namespace armcmc::test {

struct Rgb {
  int r = 0, g = 0, b = 0;
};

/// A part of a picture, as shares of its width and height.
struct Region {
  double x0 = 0.0, y0 = 0.0, x1 = 1.0, y1 = 1.0;
};

/// What was on a screen.
struct Picture {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;

  /// Pixels of a colour, or nearly: the edge of a line is mixed with what it lies on.
  [[nodiscard]] int Count(const Rgb& colour, const Region& region = {}) const;
  /// How many different colours there are, of 12 bits.
  [[nodiscard]] int Colours(const Region& region = {}) const;
};

/// A screen without a monitor, with hands: Xvfb, xdotool, and import of ImageMagick.
class SpyScreen {
 public:
  /// Why it cannot be had on this machine; empty when it can.
  [[nodiscard]] static std::string MissingTools();

  SpyScreen();

  /// Starts armcmc-spy on it.
  std::unique_ptr<Process> StartSpy(const std::vector<std::string>& arguments) const;
  /// Waits for a window with that title. @return its number, nothing after 20 s.
  [[nodiscard]] std::optional<std::string> Window(const std::string& title) const;
  void Place(const std::string& window, int x, int y, int width, int height) const;
  void DoubleClick(int x, int y) const;
  /// Takes a picture of a window, and keeps it in the build tree.
  [[nodiscard]] Picture Shoot(const std::string& window, const std::string& name) const;

 private:
  [[nodiscard]] Outcome Run(std::vector<std::string> command) const;
  void Do(const std::vector<std::string>& command) const;

  std::unique_ptr<Process> server_;
  std::string display_;
};

}  // namespace armcmc::test
