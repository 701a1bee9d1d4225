#pragma once

#include <string>
#include <vector>

namespace armcmc::watch {

/// How a piece of text stands out. Never the only sign of anything: a word says the same.
enum class Ink { kPlain, kBold, kDim, kGood, kWarning, kBad, kAlarm };

/// One line of a terminal, of pieces in different inks; knows how many columns it takes.
class TextLine {
 public:
  /// @param text  UTF-8 whose characters take one column each, without control characters.
  TextLine& Add(const std::string& text, Ink ink = Ink::kPlain);
  /// Adds it at the right end of a field of so many columns, or at the left end of it.
  TextLine& AddRight(const std::string& text, int columns, Ink ink = Ink::kPlain);
  TextLine& AddLeft(const std::string& text, int columns, Ink ink = Ink::kPlain);
  /// Fills up with spaces so that the next piece starts at a column, counted from 0.
  TextLine& To(int column);

  [[nodiscard]] int columns() const noexcept { return columns_; }
  /// The line, cut to so many columns. @param colour  With ANSI escape sequences.
  [[nodiscard]] std::string Text(int columns, bool colour) const;

 private:
  struct Piece {
    std::string text;
    Ink ink;
  };
  std::vector<Piece> pieces_;
  int columns_ = 0;
};

/// Columns of UTF-8 whose characters take one column each.
[[nodiscard]] int Columns(const std::string& text) noexcept;

}  // namespace armcmc::watch
