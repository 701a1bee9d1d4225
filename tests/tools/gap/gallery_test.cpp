#include "armcmc/gap/gallery.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "armcmc/gap/result_json.hpp"
#include "tools/gap/report_fixture.hpp"

namespace armcmc::gap::gallery_test {
namespace {

using testing::HasSubstr;
using testing::Not;

std::string PageOf(const Result& result, const std::string& folder = "axis") {
  const nlohmann::json json = ToJson(result);
  return GalleryHtml({{folder, &json}});
}

TEST(Gallery, LinksEveryReportAndSaysWhatWasNamedRungByRung) {
  Result result = test::ExampleResult(Verdict::kNamed);
  result.ladder = {{}, {}};
  result.ladder[0].effects = {"coulomb_friction"};
  result.ladder[1].effects = {"backlash", "presliding_friction"};
  const nlohmann::json first = ToJson(result);
  const nlohmann::json second = ToJson(test::ExampleResult(Verdict::kUnnamed));
  const std::string page = GalleryHtml({{"axis", &first}, {"valve", &second}});
  EXPECT_THAT(page, HasSubstr("href=\"axis/report.html\""));
  EXPECT_THAT(page, HasSubstr("href=\"valve/report.html\""));
  EXPECT_THAT(page, HasSubstr("Coulomb friction<br>Backlash <span class=\"soft\">or</span> Presliding friction"));
  EXPECT_THAT(page, HasSubstr("something is missing that no effect explains"));
  EXPECT_THAT(page, HasSubstr("2 recordings"));
}

TEST(Gallery, NamesTheEffectsOfAResultWithoutALadder) {
  Result result = test::ExampleResult(Verdict::kNamed);
  result.ladder.clear();
  ASSERT_FALSE(result.effects.empty());
  EXPECT_THAT(PageOf(result), Not(HasSubstr("no effect explains")));
  result = test::ExampleResult(Verdict::kNone);
  EXPECT_THAT(PageOf(result), HasSubstr("nothing is missing"));
}

TEST(Gallery, TextOfOthersIsEscaped) {
  Result result = test::ExampleResult(Verdict::kNamed);
  result.data_file = "<script>alert(1)</script>";
  const std::string page = PageOf(result, "a\"b<c");
  EXPECT_THAT(page, Not(HasSubstr("<script>alert")));
  EXPECT_THAT(page, Not(HasSubstr("a\"b<c")));
}

TEST(Gallery, AResultThatLacksSomethingIsAnError) {
  nlohmann::json json = ToJson(test::ExampleResult(Verdict::kNamed));
  json.erase("gap");
  EXPECT_THROW((void)GalleryHtml({{"axis", &json}}), nlohmann::json::exception);
}

}  // namespace
}  // namespace armcmc::gap::gallery_test
