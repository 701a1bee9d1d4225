// What the result says of an effect that has more than one rung.
#include "repeated.hpp"

#include <gtest/gtest.h>

#include <map>
#include <string>
#include <utility>

#include "armcmc/ladder/climb.hpp"

namespace armcmc::test::repeated_test {
namespace {

using ladder::Ladder;

class WhyRepeated : public ::testing::Test {
 protected:
  void Add(const EffectEntry& entry, std::size_t form, std::map<std::string, std::string> symbols) {
    ladder::Contender contender{};
    contender.candidate.entry = &entry;
    contender.candidate.binding = {form, std::move(symbols)};
    ladder::Rung rung;
    rung.contenders.push_back(std::move(contender));
    rung.named = {0};
    ladder_.rungs.push_back(std::move(rung));
  }
  [[nodiscard]] std::string Words() {
    ladder_.rungs.emplace_back();  // the last one, in which nothing is named
    return ladder::WhyRepeated(ladder_);
  }
  static EffectEntry Named(const std::string& name) {
    EffectEntry entry;
    entry.name = name;
    return entry;
  }

  const EffectEntry overflow_ = Named("overflow"), friction_ = Named("coulomb_friction");
  Ladder ladder_;
};

TEST_F(WhyRepeated, NamesThatDifferNeedNoWord) {
  Add(overflow_, 0, {{"x", "h1"}});
  Add(friction_, 0, {{"v", "v"}});
  EXPECT_EQ(Words(), "");
}

TEST_F(WhyRepeated, CopiesMayActOnOtherQuantities) {
  Add(overflow_, 0, {{"x", "h1"}, {"y", "h2"}});
  Add(friction_, 0, {{"v", "v"}});
  Add(overflow_, 1, {{"x", "h2"}});
  EXPECT_EQ(
      Words(),
      " The effect overflow appears twice because it was added twice, each time with its own parameters: it acts on "
      "h1 and h2, then on h2.");
}

TEST_F(WhyRepeated, CopiesMayHaveOtherFormulas) {
  Add(friction_, 0, {{"v", "v"}});
  Add(friction_, 1, {{"v", "v"}});
  EXPECT_EQ(Words(),
            " The effect Coulomb friction appears twice because it was added twice, each time with its own parameters: "
            "each has another formula of it, since one alone leaves a part unexplained.");
}

TEST_F(WhyRepeated, CopiesMayBeAlike) {
  for (int copy = 0; copy < 3; ++copy) Add(friction_, 0, {});
  EXPECT_EQ(Words(),
            " The effect Coulomb friction appears 3 times because it was added 3 times, each time with its own "
            "parameters: the formula fitted once leaves a part that the same formula with other values explains.");
}

}  // namespace
}  // namespace armcmc::test::repeated_test
