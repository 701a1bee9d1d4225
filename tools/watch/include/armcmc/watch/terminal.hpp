#pragma once

#include <termios.h>

#include <string>

#include "armcmc/watch/screen.hpp"

namespace armcmc::watch {

/// A terminal that shows one screen after the other instead of scrolling. Gives it back as it was at the end of its
/// life.
class Terminal {
 public:
  Terminal();
  ~Terminal();
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  /// Takes the terminal, or gives it back: around a stop of the program by Ctrl-Z.
  void Enter();
  void Leave();

  /// Puts a text over the last, in one write, so that nothing flickers.
  void Show(const std::string& text);

  /// Size as it is now; 80 x 24 where it is not known.
  static void ReadSize(View* view);

 private:
  termios before_{};
  bool raw_ = false;
  bool entered_ = false;
};

}  // namespace armcmc::watch
