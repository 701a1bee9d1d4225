#include "armcmc/watch/terminal.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <cerrno>

namespace armcmc::watch {
namespace {

// Alternate screen, no cursor, no line wrap; and back.
constexpr char kEnter[] = "\x1b[?1049h\x1b[?25l\x1b[?7l\x1b[2J";
constexpr char kLeave[] = "\x1b[?7h\x1b[?25h\x1b[?1049l";

void WriteAll(const std::string& text) {
  std::size_t done = 0;
  while (done < text.size()) {
    const ssize_t n = write(STDOUT_FILENO, text.data() + done, text.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return;  // the terminal is gone; SIGHUP ends the program
    done += static_cast<std::size_t>(n);
  }
}

}  // namespace

Terminal::Terminal() { Enter(); }

Terminal::~Terminal() { Leave(); }

void Terminal::Enter() {
  if (entered_) return;
  entered_ = true;
  // Keys come at once and do not show; Ctrl-C still makes a signal.
  if (tcgetattr(STDIN_FILENO, &before_) == 0) {
    termios raw = before_;
    raw.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
    raw_ = tcsetattr(STDIN_FILENO, TCSANOW, &raw) == 0;
  }
  WriteAll(kEnter);
}

void Terminal::Leave() {
  if (!entered_) return;
  entered_ = false;
  WriteAll(kLeave);
  if (raw_) tcsetattr(STDIN_FILENO, TCSANOW, &before_);
  raw_ = false;
}

void Terminal::Show(const std::string& text) {
  std::string frame = "\x1b[H";
  for (const char c : text) {
    if (c == '\n') frame += "\x1b[K\r";
    frame += c;
  }
  WriteAll(frame + "\x1b[K\x1b[J");
}

void Terminal::ReadSize(View* view) {
  winsize size{};
  const bool known = ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 && size.ws_row > 0;
  view->columns = known ? size.ws_col : 80;
  view->rows = known ? size.ws_row : 24;
}

}  // namespace armcmc::watch
