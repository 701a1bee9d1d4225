#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "armcmc/plots/page.hpp"
#include "tools/plots/browser.hpp"

namespace armcmc::plots::page_browser_test {
namespace {

using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;

/// Every feature of a chart at once, with gaps, and curves that do not share their x.
XyChart FullChart() {
  XyChart chart;
  chart.x_title = "time, s";
  chart.y_title = "force </b>, N";
  Series band{"with a band", Role::kBefore, {}, {}, {}, {}};
  for (int i = 0; i < 20'000; ++i) {
    const double x = 1e-3 * i, y = i % 5'000 == 0 ? std::nan("") : std::sin(x);
    band.x.push_back(x), band.y.push_back(y), band.low.push_back(y - 0.1), band.high.push_back(y + 0.1);
  }
  chart.series = {band, {"another", Role::kAfter, {0.5, 11.3, 19.0}, {0.1, 0.2, 0.3}, {}, {}}};
  chart.shades = {{14.0, 20.0, "held out"}};
  chart.rules = {{0.5, "limit"}};
  chart.sync = "time";
  return chart;
}

TEST(PageInBrowser, DrawsEveryKindOfChart) {
  ARMCMC_REQUIRE_BROWSER();
  Page page("test");
  page.Html("<main>");
  page.Chart(FullChart(), "curves");
  XyChart spectrum;
  spectrum.log_x = spectrum.log_y = true;
  spectrum.series = {{"power", Role::kAfter, {0.0, 1.0, 10.0, 500.0}, {0.0, 30.0, 2.0, 1.0}, {}, {}}};
  page.Chart(spectrum, "logarithmic");
  page.Chart(HeatMap{"x", "y", "value", {0.0, 1.0, 2.0, 3.0}, {0.0, 1.0, 2.0}, {0.0, 1.0, 1e6, std::nan(""), 2.0, 3.0}},
             "map");
  page.Html("</main>");
  const test::BrowserView view = test::View(page.ToString());
  EXPECT_THAT(view.complaints, IsEmpty());
  ASSERT_THAT(view.figures, SizeIs(3));
  for (const test::DrawnFigure& figure : view.figures) EXPECT_TRUE(figure.drawn) << figure.kind;
  EXPECT_GT(view.figures[0].marks, 1'000);
  EXPECT_GT(view.figures[1].marks, 500);
  EXPECT_EQ(view.figures[2].marks, 5);
}

TEST(PageInBrowser, DrawsAFlatCurveAndASinglePoint) {
  ARMCMC_REQUIRE_BROWSER();
  Page page("test");
  XyChart flat, point;
  flat.series = {{"flat", Role::kBefore, {0.0, 1.0}, {3.0, 3.0}, {}, {}}};
  point.series = {{"point", Role::kBefore, {1.0}, {3.0}, {}, {}}};
  page.Chart(flat, "flat");
  page.Chart(point, "point");
  page.Chart(HeatMap{"x", "y", "value", {0.0, 1.0}, {0.0, 1.0}, {0.0}}, "one cell");
  const test::BrowserView view = test::View(page.ToString());
  EXPECT_THAT(view.complaints, IsEmpty());
  ASSERT_THAT(view.figures, SizeIs(3));
  EXPECT_GT(view.figures[0].marks, 500);
  EXPECT_GT(view.figures[1].marks, 10);
  EXPECT_EQ(view.figures[2].marks, 1);
}

// The eye must be able to see what it looks for.
TEST(PageInBrowser, AnErrorARequestAndAnEmptyPlotAreSeen) {
  ARMCMC_REQUIRE_BROWSER();
  Page error("test"), request("test"), empty("test");
  error.Html("<script>notThere();</script>");
  EXPECT_THAT(test::View(error.ToString()).complaints, Not(IsEmpty()));
  request.Html("<img src=\"https://example.org/x.png\" alt=\"\">");
  EXPECT_THAT(test::View(request.ToString()).complaints, Not(IsEmpty()));
  empty.Html(
      "<figure class=\"chart\" data-kind=\"xy\"><div class=\"plot\"></div><script type=\"application/json\">"
      R"({"x_title":"x","y_title":"y","height":100,"rules":[],"shades":[],)"
      R"("series":[{"label":"a","role":"before","x":[0,1],"y":[null,null]}]})"
      "</script></figure>"
      "<figure class=\"chart\" data-kind=\"xy\"><div class=\"plot\"></div><script type=\"application/json\">{"
      "</script></figure>");
  const test::BrowserView view = test::View(empty.ToString());
  ASSERT_THAT(view.figures, SizeIs(2));
  EXPECT_EQ(view.figures[0].marks, 0);
  EXPECT_FALSE(view.figures[1].drawn);
  EXPECT_THAT(view.complaints, Not(IsEmpty()));
}

}  // namespace
}  // namespace armcmc::plots::page_browser_test
