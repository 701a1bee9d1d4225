#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <ostream>
#include <string>
#include <utility>

#include "armcmc/rt/event_log.hpp"

namespace armcmc::app {

/// Names the checks of the gap watch.
using GapCheckNames = std::function<std::string(int check)>;

/// One line for people. @param gap_check  Empty: the line of a suspected gap does not say where it is seen.
[[nodiscard]] std::string EventText(const rt::Event& event, const GapCheckNames& gap_check = {});

/// Prints events with the time since the start. At most kMaxPerSecond lines of a kind a second; what is held
/// back is counted and said, so that a storm of bad packs does not bury the rest.
class EventPrinter {
 public:
  static constexpr int kMaxPerSecond = 5;

  /// @param plant  Stands before every line; empty: nothing does.
  EventPrinter(std::ostream& out, Nanos start_ns, bool verbose, GapCheckNames gap_check = {}, std::string plant = "")
      : out_(out), start_ns_(start_ns), verbose_(verbose), gap_check_(std::move(gap_check)), plant_(std::move(plant)) {}

  void Print(const rt::Event& event);
  /// Says how many lines were held back since the last call. Call it about once a second and at the end.
  void PrintHeldBack(Nanos now_ns);

 private:
  void Line(Nanos t_ns, const std::string& text);

  std::ostream& out_;
  Nanos start_ns_;
  bool verbose_;
  GapCheckNames gap_check_;
  std::string plant_;
  std::array<int, rt::kNumEventKinds> printed_{}, held_back_{};
};

}  // namespace armcmc::app
