#include "armcmc/plots/page.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace armcmc::plots {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

XyChart OneCurve(const std::string& label) {
  XyChart chart;
  chart.series.push_back({label, Role::kBefore, {0.0, 1.0}, {0.0, 1.0}, {}, {}});
  return chart;
}

TEST(Page, AsksNobodyForAnything) {
  Page page("title");
  page.Chart(OneCurve("curve"), "caption");
  const std::string html = page.ToString();
  EXPECT_THAT(html, HasSubstr("default-src 'none'"));
  for (const char* request : {"src=\"", "@import", "<link rel=\"stylesheet", "url(http"})
    EXPECT_THAT(html, Not(HasSubstr(request)));
}

TEST(Page, CarriesTheLicenceOfThePlotLibrary) {
  const std::string html = Page("title").ToString();
  EXPECT_THAT(html, HasSubstr("Leon Sorokin"));
  EXPECT_THAT(html, HasSubstr("THE SOFTWARE IS PROVIDED \"AS IS\""));
}

TEST(Page, EscapesTitleAndLabels) {
  Page page("</title><script>alert(1)</script>");
  page.Chart(OneCurve("</script><script>alert(2)</script>"), "caption");
  const std::string html = page.ToString();
  EXPECT_THAT(html, Not(HasSubstr("<script>alert")));
  EXPECT_THAT(html, HasSubstr("&lt;/title&gt;"));
}

TEST(Page, SaysWhenThereIsNothingToDraw) {
  Page page("title");
  page.Chart(XyChart{}, "caption of curves");
  page.Chart(HeatMap{"", "", "", {0.0, 1.0}, {0.0, 1.0}, {std::nan("")}, 100}, "caption of map");
  const std::string html = page.ToString();
  EXPECT_THAT(html, Not(HasSubstr("<figure class=\"chart\"")));
  EXPECT_THAT(html, HasSubstr("There are no data for this figure."));
  EXPECT_THAT(html, HasSubstr("caption of map"));
}

}  // namespace
}  // namespace armcmc::plots
