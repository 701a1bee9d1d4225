#include "armcmc/plots/page.hpp"

#include "armcmc/plots/html.hpp"

namespace armcmc::embedded {
std::string_view PageScript() noexcept;
std::string_view HeatMapScript() noexcept;
std::string_view XyScript() noexcept;
std::string_view PageStyle() noexcept;
std::string_view PlotLibrary() noexcept;
std::string_view PlotLibraryStyle() noexcept;
std::string_view PlotLibraryLicence() noexcept;
}  // namespace armcmc::embedded

namespace armcmc::plots {
namespace {

// Counts what goes wrong, for whoever looks at the page without its console.
constexpr std::string_view kErrorCounter =
    "addEventListener('error',function(e){var d=document.documentElement.dataset;"
    "d.errors=(d.errors?d.errors+' | ':'')+(e.message||'error')})";

}  // namespace

Page::Page(std::string_view title) : title_(title) {}

void Page::Html(std::string_view html) { body_ << html; }

void Page::Chart(const XyChart& chart, std::string_view caption) {
  if (HasData(chart))
    Figure("xy", chart.height, ToJson(chart), caption);
  else
    EmptyFigure(caption);
}

void Page::Chart(const HeatMap& map, std::string_view caption) {
  if (HasData(map))
    Figure("heat-map", map.height, ToJson(map), caption);
  else
    EmptyFigure(caption);
}

void Page::Figure(std::string_view kind, int height, const nlohmann::json& spec, std::string_view caption) {
  body_ << "<figure class=\"chart\" data-kind=\"" << kind << "\">\n<div class=\"plot\" style=\"min-height:" << height
        << "px\"><noscript>The plots of this page need JavaScript.</noscript></div>\n<script type=\"application/json\">"
        << ScriptJson(spec) << "</script>\n<figcaption>" << caption << "</figcaption>\n</figure>\n";
}

void Page::EmptyFigure(std::string_view caption) {
  body_ << "<figure class=\"empty\"><p>There are no data for this figure.</p>\n<figcaption>" << caption
        << "</figcaption>\n</figure>\n";
}

std::string Page::ToString() const {
  std::ostringstream out;
  out << "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      << "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src 'unsafe-inline'; "
         "script-src 'unsafe-inline'; img-src data:\">\n"
      << "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<link rel=\"icon\" "
         "href=\"data:,\">\n"
      << "<title>" << EscapeHtml(title_) << "</title>\n<script>" << kErrorCounter << "</script>\n<style>\n"
      << embedded::PlotLibraryStyle() << '\n'
      << embedded::PageStyle() << "</style>\n</head>\n<body>\n"
      << body_.view();
  out << "<script>\n/* uPlot\n"
      << embedded::PlotLibraryLicence()
      << "*/\n"
      // The library draws at the resolution of the screen; at least double, so that paper is sharp too.
      << "var uPlot = (function (devicePixelRatio) {\n"
      << embedded::PlotLibrary() << "\nreturn uPlot;\n})(Math.max(2, window.devicePixelRatio || 1));\n</script>\n"
      << "<script>\n'use strict';\n(function () {\n"
      << embedded::XyScript() << embedded::HeatMapScript() << embedded::PageScript()
      << "})();\n</script>\n</body>\n</html>\n";
  return std::move(out).str();
}

}  // namespace armcmc::plots
