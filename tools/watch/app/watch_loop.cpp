#include "watch_loop.hpp"

#include <poll.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <iostream>
#include <memory>
#include <optional>

#include "armcmc/support/program.hpp"
#include "armcmc/watch/bus.hpp"
#include "armcmc/watch/screen.hpp"
#include "armcmc/watch/step_text.hpp"
#include "armcmc/watch/terminal.hpp"
#include "armcmc/watch/watch_state.hpp"
#include "signals.hpp"

namespace armcmc::watch {
namespace {

constexpr double kFrame_s = 0.1;   // of the screen, however fast messages come
constexpr double kRemind_s = 5.0;  // between two notes that nothing comes
constexpr int kMessagesAtOnce = 400;

double Now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

class Loop {
 public:
  explicit Loop(const WatchOptions& options)
      : options_(options),
        signals_{SIGINT, SIGTERM, SIGHUP, SIGTSTP, SIGWINCH},
        bus_(options.url, options.prefix,
             [this](const std::string& name, const void* bytes, int size) { OnMessage(name, bytes, size); }) {
    state_.url = options.url;
    state_.prefix = options.prefix;
    state_.started_s = last_note_s_ = Now();
    view_.glyphs = options.glyphs;
    view_.colour = options.colour;
    if (options.screen) {
      terminal_.emplace();
      Terminal::ReadSize(&view_);
    }
  }

  int Run() {
    while (!done_) {
      Wait();
      bus_.Drain(kMessagesAtOnce);
      ReadKeys();
      TakeSignals();
      const double now = Now();
      if (options_.duration_s > 0.0 && now - state_.started_s >= options_.duration_s) done_ = true;
      if (terminal_ && now >= next_frame_s_) {
        terminal_->Show(Render(state_, view_, now));
        next_frame_s_ = now + kFrame_s;
      }
      if (!terminal_) NoteSilence(now);
    }
    return Finish();
  }

 private:
  void Wait() {
    std::array<pollfd, 3> fds{
        {{bus_.fd(), POLLIN, 0}, {signals_.fd(), POLLIN, 0}, {terminal_ ? STDIN_FILENO : -1, POLLIN, 0}}};
    poll(fds.data(), fds.size(), static_cast<int>(1e3 * kFrame_s));
    keys_ = (fds[2].revents & (POLLIN | POLLHUP)) != 0;
  }

  void OnMessage(const std::string& name, const void* bytes, int size) {
    if (done_ || !state_.TakeBytes(name, bytes, size, Now())) return;
    if (!options_.screen) {
      std::cout << (options_.json ? StepJson(state_) : StepLine(state_)) << '\n' << std::flush;
      if (!std::cout) done_ = true;  // the reader is gone
    }
    if (options_.steps > 0 && state_.steps >= options_.steps) done_ = true;
  }

  void ReadKeys() {
    char key = 0;
    if (!keys_) return;
    if (read(STDIN_FILENO, &key, 1) != 1 || key == 'q' || key == 'Q') done_ = true;
  }

  void TakeSignals() {
    for (int signal = signals_.Next(); signal != 0; signal = signals_.Next()) {
      if (signal == SIGWINCH) {
        if (terminal_) Terminal::ReadSize(&view_);
        next_frame_s_ = 0.0;
      } else if (signal == SIGTSTP) {
        if (terminal_) terminal_->Leave();
        raise(SIGSTOP);
        if (terminal_) terminal_->Enter();
      } else {
        done_ = true;
      }
    }
  }

  /// Where lines are written there is no screen that says so.
  void NoteSilence(double now) {
    const double heard = state_.status ? std::max(state_.status_s, last_note_s_) : last_note_s_;
    const double patience = noted_ ? kRemind_s : kStale_s;
    if (now - heard < patience) return;
    if (state_.status && now - state_.status_s < kStale_s) return;
    std::cerr << "armcmc-watch: " << WaitingText(state_) << ForeignTrafficText() << '\n';
    last_note_s_ = now;
    noted_ = true;
  }

  [[nodiscard]] std::string ForeignTrafficText() const {
    if (state_.bus.foreign + state_.bus.undecodable == 0) return "";
    return " (" + std::to_string(state_.bus.foreign) + " messages of a foreign type, " +
           std::to_string(state_.bus.undecodable) + " undecodable)";
  }

  int Finish() {
    terminal_.reset();
    if (options_.duration_s > 0.0 && state_.steps == 0) {
      std::cerr << "armcmc-watch: no step in " << options_.duration_s << " s: " << WaitingText(state_)
                << ForeignTrafficText() << '\n';
      return support::kExitFailure;
    }
    return support::kExitOk;
  }

  const WatchOptions options_;
  Signals signals_;  // before the bus, whose thread must not take them
  Bus bus_;
  WatchState state_;
  View view_;
  std::optional<Terminal> terminal_;
  double next_frame_s_ = 0.0;
  double last_note_s_ = 0.0;
  bool noted_ = false;
  bool keys_ = false;
  bool done_ = false;
};

}  // namespace

int Watch(const WatchOptions& options) { return std::make_unique<Loop>(options)->Run(); }

}  // namespace armcmc::watch
