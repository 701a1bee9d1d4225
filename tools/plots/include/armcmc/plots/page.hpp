#pragma once

#include <sstream>
#include <string>
#include <string_view>

#include "armcmc/plots/chart.hpp"

namespace armcmc::plots {

/// One HTML page that opens offline: style, script, plotting library and data stand in it, and its content security
/// policy forbids every request.
///
/// The style has a class for what reports are made of: `card`, `grid`, `tile`, `chip`, `bar`, `interval`, `note`.
class Page {
 public:
  /// @param title  Plain text.
  explicit Page(std::string_view title);

  /// Appends HTML as it is: text of others goes through EscapeHtml first.
  void Html(std::string_view html);

  /// Appends a figure with a caption (HTML) that says how to read it. A chart without data is replaced by a sentence.
  /// @throws std::invalid_argument as ToJson.
  void Chart(const XyChart& chart, std::string_view caption);
  void Chart(const HeatMap& map, std::string_view caption);

  [[nodiscard]] std::string ToString() const;

 private:
  void Figure(std::string_view kind, int height, const nlohmann::json& spec, std::string_view caption);
  void EmptyFigure(std::string_view caption);

  std::string title_;
  std::ostringstream body_;
};

}  // namespace armcmc::plots
