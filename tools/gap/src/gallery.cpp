#include "armcmc/gap/gallery.hpp"

#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "armcmc/plots/html.hpp"
#include "armcmc/plots/page.hpp"
#include "report_words.hpp"

namespace armcmc::gap {
namespace {

using nlohmann::json;
using plots::EscapeHtml;
using plots::NumberText;
using plots::PercentText;

/// The names on a rung, joined by "or".
std::string RungText(const json& names) {
  std::string text;
  for (const json& name : names)
    text += (text.empty() ? "" : " <span class=\"soft\">or</span> ") + EscapeHtml(EffectTitle(name.get<std::string>()));
  return text;
}

/// The named effects, one rung per line; without a ladder, the effects of the result or its verdict in words.
std::string NamedText(const json& result) {
  std::string text;
  for (const json& rung : result.value("ladder", json::array()))
    text += (text.empty() ? "" : "<br>") + RungText(rung.at("effects"));
  if (!text.empty()) return text;
  const auto verdict = result.at("verdict").get<std::string>();
  if (verdict == "named") {
    for (const json& effect : result.at("effects"))
      text += (text.empty() ? "" : "<br>") + EscapeHtml(EffectTitle(effect.at("name").get<std::string>()));
    return text;
  }
  if (verdict == "ambiguous") return "several effects explain it equally well";
  return verdict == "none" ? "nothing is missing" : "something is missing that no effect explains";
}

double Number(const json& value) { return value.is_number() ? value.get<double>() : std::nan(""); }

void AddRow(const GalleryEntry& entry, std::ostream& out) {
  const json& result = *entry.result;
  const json& gap = result.at("gap");
  const auto unit = gap.at("unit").get<std::string>();
  const auto error = [&](const char* key) { return NumberText(Number(gap.at(key)), 3) + ' ' + EscapeHtml(unit); };
  const bool changed = result.at("verdict") == "named" || result.at("verdict") == "ambiguous";
  out << "<tr><td><a href=\"" << EscapeHtml(entry.folder) << "/report.html\">"
      << EscapeHtml(result.at("data").at("file").get<std::string>()) << "</a><br><span class=\"soft mono\">"
      << EscapeHtml(result.at("model").get<std::string>()) << "</span></td><td>" << NamedText(result)
      << "</td><td class=\"num\">" << error("heldout_rmse_before") << "</td><td class=\"num\">"
      << (changed ? error("heldout_rmse_after") : "–") << "</td><td class=\"num\">"
      << (changed ? PercentText(Number(gap.at("closed_fraction"))) : "–") << "</td><td>"
      << (result.value("complete", false)  ? "nothing"
          : result.at("verdict") == "none" ? "–"
                                           : "something")
      << "</td></tr>\n";
}

}  // namespace

std::string GalleryHtml(const std::vector<GalleryEntry>& entries) {
  plots::Page page("Gap reports");
  std::ostringstream out;
  out << "<main>\n<section class=\"card\">\n<h1>Gap reports</h1>\n<p class=\"soft\">" << entries.size()
      << (entries.size() == 1 ? " recording" : " recordings")
      << ". Errors are root mean squares on held-out data. Effects are listed in the order in which they were "
         "added.</p>\n<div class=\"scroll\"><table>\n<tr><th>recording</th><th>missing</th><th class=\"num\">error of "
         "the base model</th><th class=\"num\">with the named effects</th><th class=\"num\">gap "
         "closed</th><th>remainder</th></tr>\n";
  for (const GalleryEntry& entry : entries) AddRow(entry, out);
  out << "</table></div>\n</section>\n</main>\n";
  page.Html(out.view());
  return page.ToString();
}

}  // namespace armcmc::gap
