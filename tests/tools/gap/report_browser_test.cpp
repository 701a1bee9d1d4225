#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "armcmc/gap/report.hpp"
#include "armcmc/gap/result_json.hpp"
#include "tools/gap/report_fixture.hpp"
#include "tools/plots/browser.hpp"

namespace armcmc::gap::report_browser_test {
namespace {

using ::testing::IsEmpty;
using ::testing::SizeIs;

class ReportInBrowser : public ::testing::TestWithParam<Verdict> {};

TEST_P(ReportInBrowser, DrawsEveryPlotWithoutAComplaint) {
  ARMCMC_REQUIRE_BROWSER();
  const armcmc::test::BrowserView view = armcmc::test::View(ReportHtml(test::ExampleResult(GetParam())));
  EXPECT_THAT(view.complaints, IsEmpty());
  // Residual and output over time, the map, four features, the spectrum.
  ASSERT_THAT(view.figures, SizeIs(8));
  for (std::size_t i = 0; i < view.figures.size(); ++i) {
    EXPECT_TRUE(view.figures[i].drawn) << "figure " << i;
    EXPECT_GT(view.figures[i].marks, 100) << "figure " << i << " is empty";
  }
}

INSTANTIATE_TEST_SUITE_P(Verdicts, ReportInBrowser, ::testing::Values(Verdict::kNamed, Verdict::kUnnamed),
                         [](const auto& verdict) { return std::string(Name(verdict.param)); });

}  // namespace
}  // namespace armcmc::gap::report_browser_test
