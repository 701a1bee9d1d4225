#include "report_words.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "armcmc/models/registry.hpp"

namespace armcmc::gap::report_words_test {
namespace {

TEST(EffectTitle, ReadsAsAPersonWouldSayIt) {
  EXPECT_EQ(EffectTitle("coulomb_friction from 4.25 s"), "Coulomb friction from 4.25 s");
  EXPECT_EQ(EffectTitles({"sensor_lag", "force_bias", "coulomb_friction"}),
            "Sensor lag + force bias + Coulomb friction");
  EXPECT_EQ(EffectTitles({}), "nothing");
  EXPECT_EQ(EffectTitle(""), "");
  EXPECT_EQ(EffectInSentence("coulomb_friction"), "Coulomb friction");
  EXPECT_EQ(EffectInSentence("sensor_lag"), "sensor lag");
  EXPECT_EQ(InSentence("viscous_friction + coulomb_friction"), "viscous friction + Coulomb friction");
}

TEST(WordsOf, KnowsEveryEffectOfTheCatalogues) {
  for (const ModelInfo* model : CompiledModels())
    for (const EffectInfo* info : model->compiled->effects)
      EXPECT_FALSE(WordsOf(info->name).formula.empty()) << info->name;
  EXPECT_TRUE(WordsOf("not_there").formula.empty());
}

TEST(MeanText, HasTheDigitsThatTheSdJustifies) {
  EXPECT_EQ(MeanText({"force", "N", 0.080101, 0.0007}), "0.08010&nbsp;N");
  EXPECT_EQ(IntervalText({"force", "N", 0.080101, 0.0007}), "0.07873 to 0.08147");
  EXPECT_EQ(MeanText({"K", "", 4212.3, 210.0}), "4212");
  EXPECT_EQ(IntervalText({"speed", "m/s", 0.02, 0.0}), "held fixed");
  EXPECT_EQ(IntervalText({"speed", "m/s", 0.02, std::nan("")}), "not known");
  EXPECT_EQ(MeanText({"leak", "kg/(s Pa)", 2.5e-9, 1e-11}), "2.500 × 10⁻⁹&nbsp;kg/(s Pa)");
  EXPECT_EQ(MeanText({"odd", "<unit>", 1.0, 0.1}), "1.00&nbsp;&lt;unit&gt;");
}

TEST(Readings, FollowTheNumbers) {
  EXPECT_NE(CoverageReading(0.95).find("correct"), std::string::npos);
  EXPECT_NE(CoverageReading(0.43).find("57.0 % of the samples are outside"), std::string::npos);
  EXPECT_NE(CoverageReading(0.999).find("too wide"), std::string::npos);
  EXPECT_NE(WhitenessReading(1.1).find("white: "), std::string::npos);
  EXPECT_NE(WhitenessReading(212.0).find("not white"), std::string::npos);
  EXPECT_EQ(WhitenessReading(std::nan("")), "not known");
}

}  // namespace
}  // namespace armcmc::gap::report_words_test
