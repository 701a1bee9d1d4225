#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "armcmc/compare/report.hpp"
#include "support/paths.hpp"
#include "tools/compare/traces.hpp"
#include "tools/plots/browser.hpp"

namespace armcmc::compare::compare_browser_test {
namespace {

using ::testing::IsEmpty;

TEST(ComparisonInBrowser, DrawsEveryPlotWithoutAComplaint) {
  ARMCMC_REQUIRE_BROWSER();
  const test::ScratchDir dir;
  EstimatorSettings with_effect = FastSettings();
  with_effect.effects[0] = Friction();
  with_effect.num_effects = 1;
  const RunTrace a = TraceOf(FastSettings(), dir / "a.csv", "plain");
  const RunTrace b = TraceOf(with_effect, dir / "b.csv", "with <friction>");
  const test::BrowserView view = test::View(ReportHtml(a, b, "run.csv"));
  EXPECT_THAT(view.complaints, IsEmpty());
  // Four parameters, residual, evidence, zeta, lambda, draws, times.
  ASSERT_EQ(view.figures.size(), 10u);
  for (std::size_t i = 0; i < view.figures.size(); ++i) {
    EXPECT_TRUE(view.figures[i].drawn) << "figure " << i;
    // The evidence is drawn in black.
    if (i != 5) {
      EXPECT_GT(view.figures[i].marks, 100) << "figure " << i << " is empty";
    }
  }
}

}  // namespace
}  // namespace armcmc::compare::compare_browser_test
