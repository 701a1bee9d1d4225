// armcmc-tables on the authors' recordings: every method of the paper, on the same data.

#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>

#include "support/json.hpp"
#include "support/paths.hpp"
#include "support/process.hpp"
#include "tools/file_text.hpp"
#include "tools/plots/browser.hpp"

namespace armcmc::tables::paper_test {
namespace {

using test::Json;

// One test, since it is one run: half a minute of computing.
TEST(PaperTables, PutsArmcmcAheadOnTheAuthorsRecordingsAndDrawsEveryFigure) {
  ARMCMC_REQUIRE_DATA("paper/hunt_crossley.csv");
  const test::ScratchDir folder;
  const test::Outcome outcome =
      test::RunProgram(test::Program("armcmc-tables"),
                       {"--data", test::FindData("paper/hunt_crossley.csv")->parent_path().string(), "--paper-only",
                        "--out", folder.path().string()},
                       std::chrono::minutes(5));
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const Json tables = test::Json::Parse(test::TextOf(folder / "tables.json"));
  const Json contact = tables.at("hunt_crossley").at("methods");
  const Json ours = contact.at("armcmc_map");
  EXPECT_LE(ours.at("mae_active_contact").at("K"), 0.055);
  EXPECT_LE(ours.at("mae_active_contact").at("B"), 0.04);
  EXPECT_LE(ours.at("mae_active_contact").at("p"), 0.005);
  EXPECT_LE(ours.at("clean_force_mae_mN").at("contact"), 5.5);
  EXPECT_LE(ours.at("clean_force_mae_mN").at("overall"), 4.0);
  EXPECT_EQ(ours.at("modifications_after_first_pack"), 0);
  for (const char* other : {"mcmc_1", "mcmc_2", "rls", "rls_no_forgetting", "rls_no_reset", "rls_keeps_all", "pf"}) {
    const Json theirs = contact.at(other);
    for (const char* q : {"K", "B", "p"})
      EXPECT_LT(ours.at("mae_active_contact").at(q), theirs.at("mae_active_contact").at(q)) << other << " " << q;
    for (const char* q : {"contact", "overall"})
      EXPECT_LT(ours.at("clean_force_mae_mN").at(q), theirs.at("clean_force_mae_mN").at(q)) << other << " " << q;
  }
  const Json valves = tables.at("soft_actuator").at("methods");
  for (const char* other : {"rls", "pf"})
    for (const char* q : {"alpha_l2", "flow_rel_error"})  // theta1 and theta2 apart cannot be identified here
      EXPECT_LT(valves.at("armcmc_map").at(q), valves.at(other).at(q)) << other << " " << q;
  for (const char* block : {"published", "authors_stored"}) {
    EXPECT_TRUE(tables.at("hunt_crossley").contains(block));
    EXPECT_TRUE(tables.at("soft_actuator").contains(block));
  }

  if (!test::FindBrowser()) GTEST_SKIP() << test::kBrowserSkipReason;
  const test::BrowserView view = test::View(test::TextOf(folder / "report.html"));
  EXPECT_TRUE(view.complaints.empty());
  // Three maps, three point estimates, force; four gains, angle; k_min.
  ASSERT_EQ(view.figures.size(), 13u);
  for (std::size_t i = 0; i < view.figures.size(); ++i) {
    EXPECT_TRUE(view.figures[i].drawn) << "figure " << i;
    EXPECT_GT(view.figures[i].marks, 100) << "figure " << i << " is empty";
  }
}

}  // namespace
}  // namespace armcmc::tables::paper_test
