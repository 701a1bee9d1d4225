#include "armcmc/gap_bench/strata.hpp"

#include <gtest/gtest.h>

#include <set>
#include <stdexcept>

#include "support/paths.hpp"

namespace armcmc::gap_bench {
namespace {

TEST(Strata, LargerRunsRepeatTheCasesOfSmallerOnes) {
  const test::ScratchDir folder;
  for (const std::string& stratum : StratumNames()) {
    std::set<std::string> small, large;
    for (const Case& one : CasesOf(stratum, 1, 5, folder.path())) small.insert(one.Name());
    const std::vector<Case> more = CasesOf(stratum, 3, 5, folder.path());
    for (const Case& one : more) large.insert(one.Name());
    EXPECT_EQ(large.size(), more.size()) << stratum << ": two cases of one name";
    EXPECT_EQ(large.size(), 3 * small.size()) << stratum;
    for (const std::string& name : small) EXPECT_TRUE(large.contains(name)) << name;
  }
}

TEST(Strata, AnotherSeedMakesOtherCases) {
  const test::ScratchDir folder;
  EXPECT_NE(CasesOf("singles", 1, 5, folder.path()).front().seed, CasesOf("singles", 1, 6, folder.path()).front().seed);
}

TEST(Strata, AnUnknownStratumIsAnError) {
  EXPECT_THROW(static_cast<void>(CasesOf("gremlins", 1, 1, "")), std::invalid_argument);
}

}  // namespace
}  // namespace armcmc::gap_bench
