#include "armcmc/plots/page.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tools/file_text.hpp"

namespace armcmc::plots::page_test {
namespace {

using test::Holds;

XyChart OneCurve(const std::string& label) {
  XyChart chart;
  chart.series.push_back({label, Role::kBefore, {0.0, 1.0}, {0.0, 1.0}, {}, {}});
  return chart;
}

TEST(Page, AsksNobodyForAnything) {
  Page page("title");
  page.Chart(OneCurve("curve"), "caption");
  const std::string html = page.ToString();
  EXPECT_TRUE(Holds(html, "default-src 'none'"));
  for (const char* request : {"src=\"", "@import", "<link rel=\"stylesheet", "url(http"})
    EXPECT_FALSE(Holds(html, request)) << request;
}

TEST(Page, CarriesTheLicenceOfThePlotLibrary) {
  const std::string html = Page("title").ToString();
  EXPECT_TRUE(Holds(html, "Leon Sorokin"));
  EXPECT_TRUE(Holds(html, "THE SOFTWARE IS PROVIDED \"AS IS\""));
}

TEST(Page, EscapesTitleAndLabels) {
  Page page("</title><script>alert(1)</script>");
  page.Chart(OneCurve("</script><script>alert(2)</script>"), "caption");
  const std::string html = page.ToString();
  EXPECT_FALSE(Holds(html, "<script>alert"));
  EXPECT_TRUE(Holds(html, "&lt;/title&gt;"));
}

TEST(Page, SaysWhenThereIsNothingToDraw) {
  Page page("title");
  page.Chart(XyChart{}, "caption of curves");
  page.Chart(HeatMap{"", "", "", {0.0, 1.0}, {0.0, 1.0}, {std::nan("")}, 100}, "caption of map");
  const std::string html = page.ToString();
  EXPECT_FALSE(Holds(html, "<figure class=\"chart\""));
  EXPECT_TRUE(Holds(html, "There are no data for this figure."));
  EXPECT_TRUE(Holds(html, "caption of map"));
}

}  // namespace
}  // namespace armcmc::plots::page_test
