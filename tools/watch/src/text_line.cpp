#include "armcmc/watch/text_line.hpp"

#include <algorithm>

namespace armcmc::watch {
namespace {

bool StartsCharacter(char c) noexcept { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }

/// The first characters of UTF-8.
std::string Head(const std::string& text, int characters) {
  std::size_t end = 0;
  for (; end < text.size(); ++end) {
    if (StartsCharacter(text[end]) && characters-- == 0) break;
  }
  return text.substr(0, end);
}

const char* Escape(Ink ink) noexcept {
  switch (ink) {
    case Ink::kBold: return "\x1b[1m";
    case Ink::kDim: return "\x1b[2m";
    case Ink::kGood: return "\x1b[36m";
    case Ink::kWarning: return "\x1b[1;33m";
    case Ink::kBad: return "\x1b[1;31m";
    case Ink::kAlarm: return "\x1b[1;97;41m";
    case Ink::kPlain: break;
  }
  return "";
}

}  // namespace

int Columns(const std::string& text) noexcept {
  return static_cast<int>(std::count_if(text.begin(), text.end(), StartsCharacter));
}

TextLine& TextLine::Add(const std::string& text, Ink ink) {
  pieces_.push_back({text, ink});
  columns_ += Columns(text);
  return *this;
}

TextLine& TextLine::AddRight(const std::string& text, int columns, Ink ink) {
  return To(columns_ + std::max(0, columns - Columns(text))).Add(text, ink);
}

TextLine& TextLine::AddLeft(const std::string& text, int columns, Ink ink) {
  const int end = columns_ + columns;
  return Add(Head(text, columns), ink).To(end);
}

TextLine& TextLine::To(int column) {
  if (column > columns_) Add(std::string(static_cast<std::size_t>(column - columns_), ' '));
  return *this;
}

std::string TextLine::Text(int columns, bool colour) const {
  std::string text;
  int left = columns;
  for (const Piece& piece : pieces_) {
    if (left <= 0) break;
    const std::string shown = Head(piece.text, left);
    left -= Columns(shown);
    const bool coloured = colour && piece.ink != Ink::kPlain && !shown.empty();
    if (coloured) text += Escape(piece.ink);
    text += shown;
    if (coloured) text += "\x1b[0m";
  }
  return text;
}

}  // namespace armcmc::watch
