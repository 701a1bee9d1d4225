#pragma once

#include <string>
#include <vector>

#include "armcmc/watch/sparkline.hpp"
#include "armcmc/watch/text_line.hpp"
#include "armcmc/watch/watch_state.hpp"

namespace armcmc::watch {

/// Silence after which what is shown is called old.
inline constexpr double kStale_s = 2.0;

/// The terminal.
struct View {
  int columns = 100;
  int rows = 40;
  Glyphs glyphs = Glyphs::kUnicode;
  bool colour = true;
};

/// What the state looks like on one screen. Depends on nothing else: no clock, no terminal.
[[nodiscard]] std::vector<TextLine> Lines(const WatchState& state, const View& view, double now_s);

/// The lines cut to the size of the terminal, joined by line ends; no line end after the last.
[[nodiscard]] std::string Render(const WatchState& state, const View& view, double now_s);

/// "waiting for EST_STATUS on udpm://...: is the estimator running? same URL and prefix?"
[[nodiscard]] std::string WaitingText(const WatchState& state);

}  // namespace armcmc::watch
