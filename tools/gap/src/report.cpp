#include "armcmc/gap/report.hpp"

#include <filesystem>

#include "armcmc/plots/page.hpp"
#include "report_sections.hpp"

namespace armcmc::gap {

bool HasAfter(const Result& result) { return !result.effects.empty(); }

std::string ReportHtml(const Result& result) {
  plots::Page page("Gap report: " + std::filesystem::path(result.data_file).filename().string());
  page.Html("<main>\n");
  AddHeadline(result, &page);
  AddLadder(result, &page);
  AddGapAndEffects(result, &page);
  AddOpenQuestions(result, &page);
  AddTimeFigures(result, &page);
  AddRunAlong(result, &page);
  AddWhere(result, &page);
  AddFeatureFigures(result, &page);
  AddCandidates(result, &page);
  AddParameters(result, &page);
  AddQuality(result, &page);
  AddSpectrum(result, &page);
  AddLimits(result, &page);
  AddProvenance(result, &page);
  page.Html("</main>\n");
  return page.ToString();
}

}  // namespace armcmc::gap
