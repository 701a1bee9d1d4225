#include "armcmc/support/progress.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "armcmc/support/printable.hpp"

namespace armcmc::support {
namespace {

int TerminalWidth() {
  winsize size{};
  return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

}  // namespace

Progress::Progress(const std::string& title)
    : title_(Printable(title)),
      on_terminal_(isatty(STDERR_FILENO) == 1),
      start_(std::chrono::steady_clock::now()),
      last_drawn_(start_) {}

Progress::~Progress() { Wipe(); }

void Progress::Wipe() {
  if (drawn_) std::fputs("\r\x1b[K", stderr);
  drawn_ = false;
}

void Progress::Note(const std::string& line) {
  Wipe();
  std::fprintf(stderr, "%s: %s\n", title_.c_str(), ErrorLine(line).c_str());
}

std::string Progress::Line(const std::string& title, double share, double remaining_s, int width) {
  share = std::clamp(share, 0.0, 1.0);
  std::string tail(" ");
  tail.append(std::to_string(static_cast<int>(share * 100.0))).append(" %");
  if (remaining_s >= 0.0) tail += ", " + std::to_string(static_cast<long>(std::ceil(remaining_s))) + " s left";
  const int room = width - 1 - static_cast<int>(title.size() + tail.size()) - 3;
  if (room < 4) return title + tail;
  const int cells = std::min(room, 40), full = static_cast<int>(share * cells);
  std::string line = title + " [";
  line.append(static_cast<std::size_t>(full), '#').append(static_cast<std::size_t>(cells - full), '.');
  return line.append("]").append(tail);
}

void Progress::Update(double share) {
  if (!on_terminal_) return;
  const auto now = std::chrono::steady_clock::now();
  if (now - last_drawn_ < std::chrono::milliseconds(100)) return;
  last_drawn_ = now;
  drawn_ = true;
  const double elapsed_s = std::chrono::duration<double>(now - start_).count();
  const double remaining_s = share > 0.01 ? elapsed_s * (1.0 - share) / share : -1.0;
  std::fprintf(stderr, "\r%s\x1b[K", Line(title_, share, remaining_s, TerminalWidth()).c_str());
  std::fflush(stderr);
}

}  // namespace armcmc::support
