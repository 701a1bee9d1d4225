#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <string>
#include <vector>

#include "armcmc/compare/report.hpp"
#include "armcmc/compare/trace.hpp"
#include "armcmc/estimate_t.hpp"
#include "support/paths.hpp"
#include "support/process.hpp"
#include "tools/compare/traces.hpp"
#include "tools/file_text.hpp"

namespace armcmc::compare::compare_test {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

TEST(Differences, EveryKindOfSettingIsSeenAndEqualOnesAreNot) {
  const EstimatorSettings a = FastSettings();
  EXPECT_THAT(DifferencesOf(a, a), IsEmpty());
  const auto one = [&a](const auto& change) -> std::string {
    EstimatorSettings b = a;
    change(&b);
    const auto found = DifferencesOf(a, b);
    return found.size() == 1 ? found[0].key + ": " + found[0].a + " -> " + found[0].b
                             : std::to_string(found.size()) + " differences";
  };
  EXPECT_EQ(one([](auto* s) { s->noise[0].kind = NoiseKind::kLaplace; }),
            "noise (mode 0): gaussian, 0.1 -> laplace, 0.1");
  EXPECT_EQ(one([](auto* s) { s->forgetting.threshold = 0.5; }), "forgetting.threshold: 1 -> 0.5");
  EXPECT_EQ(one([](auto* s) { s->forgetting.drift_share = 0.0; }), "forgetting.drift_share: 0.04 -> 0");
  EXPECT_EQ(one([](auto* s) { s->forgetting.partial_change = false; }), "forgetting.partial_change: true -> false");
  EXPECT_EQ(one([](auto* s) { s->sampler.rule = DrawRule::kKMin; }), "sampler.draws: 800 -> k_min");
  EXPECT_EQ(one([](auto* s) { s->method = Method::kParticleFilter; }), "method: armcmc -> pf");
  EXPECT_EQ(one([](auto* s) { s->baseline.rls_reset = false; }), "baseline.rls_reset: true -> false");
  EXPECT_EQ(one([](auto* s) { s->sampler.seed = 7; }), "sampler.seed: 24301 -> 7");
  EXPECT_EQ(one([](auto* s) { s->parameters[0].upper = 9.0; }),
            "model.parameters.K: 2.5 ± 2 in [0, 8] -> 2.5 ± 2 in [0, 9]");
  EXPECT_EQ(one([](auto* s) { s->regress_rate = true; }), "model.regress_rate: false -> true");
  EXPECT_EQ(one([](auto* s) { s->effects[0] = Friction(), s->num_effects = 1; }), "effects: none -> coulomb_friction");
}

TEST(Trace, HoldsWhatTheRunSaid) {
  const test::ScratchDir dir;
  const RunTrace trace = TraceOf(FastSettings(), dir / "a.csv", "A");
  EXPECT_EQ(trace.summary.packs, 20);
  ASSERT_EQ(trace.quantities.size(), 3u);
  const QuantityTrace& k = trace.quantities[0];
  EXPECT_EQ(k.name, "K");
  EXPECT_EQ(k.mode, "contact");
  EXPECT_NEAR(k.last, 4.0, 0.3);
  EXPECT_LT(k.last_q025, k.last);
  EXPECT_EQ(k.ar_map.back(), k.last);
  EXPECT_EQ(trace.t.size(), 20u);
  EXPECT_EQ(trace.compute_ms.size(), 20u);
  EXPECT_EQ(trace.sample_t.size(), 2000u);
  EXPECT_EQ(trace.draws.back(), 800.0);
  // The deterministic error of the recording has an rms of 0.1 / sqrt 2; the first estimates are worse.
  EXPECT_GT(trace.residual_rms(), 0.06);
  EXPECT_LT(trace.residual_rms(), 0.5);
  EXPECT_TRUE(std::isfinite(trace.residual.front())) << "before anything is known the force is the prior's";
}

class CompareProgram : public ::testing::Test {
 protected:
  CompareProgram() {
    Config("a.toml", "draws = 700\n", "");
    Config("b.toml", "draws = 900\n", "[forgetting]\nrho = 0.02\n");
    replay::LogWriter log(dir_ / "run.lcm");
    for (int k = 1; k <= 12; ++k) {
      log.Write("PLANT_PACK", replay::ContactPack(k));
      estimate_t live{};
      live.seq = k, live.run_id = 77, live.n_modes = 1;
      live.draws_by_mode[0] = 300;
      log.Write("EST_ESTIMATE", live);
    }
  }
  void Config(const std::string& name, const std::string& sampler, const std::string& more) {
    std::ofstream(dir_ / name) << "schema = 1\n[model]\nname = \"hunt_crossley\"\n[sampler]\n" << sampler << more;
  }
  test::Outcome Run(std::vector<std::string> more) {
    more.insert(more.begin(), {"--data", dir_ / "run.lcm", "--config", dir_ / "a.toml", "--out", dir_ / "r.html"});
    return test::RunProgram(test::Program("armcmc-replay"), more);
  }
  std::string Page() { return test::TextOf(dir_ / "r.html"); }
  test::ScratchDir dir_;
};

TEST_F(CompareProgram, ReportsBothRunsAndWhatWasSetDifferently) {
  const test::Outcome o = Run({"--compare", dir_ / "b.toml"});
  ASSERT_EQ(o.code, 0) << o.err;
  EXPECT_EQ(o.err, "");
  EXPECT_THAT(o.out, HasSubstr("contact K, N/m^p"));
  EXPECT_THAT(o.out, HasSubstr("draws a pack, median"));
  EXPECT_THAT(Page(), HasSubstr("<td class=\"mono\">forgetting.rho</td><td>0</td><td>0.02</td>"));
  // The live run had made 300 draws; these are other runs.
  EXPECT_THAT(Page(), HasSubstr("<td class=\"num\">700</td><td class=\"num\">900</td>"));
}

TEST_F(CompareProgram, AnotherMethodIsComparedToo) {
  std::ofstream(dir_ / "rls.toml") << "schema = 1\nmethod = \"rls\"\n[model]\nname = \"hunt_crossley\"\n";
  const test::Outcome outcome = Run({"--compare", dir_ / "rls.toml"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(Page(), HasSubstr("<td class=\"mono\">method</td><td>armcmc</td><td>rls</td>"));
}

TEST_F(CompareProgram, TheSameConfigurationGivesTheSameRun) {
  const test::Outcome o = Run({"--compare", dir_ / "a.toml"});
  ASSERT_EQ(o.code, 0) << o.err;
  EXPECT_THAT(Page(), HasSubstr("None that changes an estimate."));
  const std::string line = o.out.substr(o.out.find("log evidence"), 120);
  EXPECT_EQ(line.substr(0, line.find('\n')).back(), '0') << line;
}

TEST_F(CompareProgram, AModelIsComparedWithTheBuiltInOne) {
  std::ofstream(dir_ / "m.toml") << "schema = 1\nbase = \"hunt_crossley\"\n[[effect]]\nname = \"coulomb_friction\"\n"
                                    "speed = 0.05\nforce = { mean = 0.1, sd = 0.2 }\n";
  const test::Outcome o = Run({"--compare-model", dir_ / "m.toml"});
  ASSERT_EQ(o.code, 0) << o.err;
  EXPECT_THAT(o.out, HasSubstr("coulomb_friction_force, N"));
  EXPECT_THAT(Page(), HasSubstr("<td class=\"mono\">effects</td><td>none</td><td>coulomb_friction</td>"));
}

TEST_F(CompareProgram, BadUsageIsOneLine) {
  test::Outcome o = Run({"--compare", dir_ / "b.toml", "--verify"});
  EXPECT_EQ(o.code, 2);
  EXPECT_THAT(o.err, HasSubstr("exclude each other"));
  o = Run({"--compare", dir_ / "none.toml"});
  EXPECT_EQ(o.code, 2);
  EXPECT_THAT(o.err, HasSubstr("none.toml"));
  o = test::RunProgram(test::Program("armcmc-replay"),
                       {"--data", dir_ / "run.lcm", "--config", dir_ / "a.toml", "--compare", dir_ / "b.toml"});
  EXPECT_EQ(o.code, 2);
  EXPECT_THAT(o.err, HasSubstr("--out is required"));
}

}  // namespace
}  // namespace armcmc::compare::compare_test
