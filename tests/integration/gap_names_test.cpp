// armcmc-plant hides, armcmc-gap finds: every effect of the catalogue, and logs in which nothing is hidden.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <string>
#include <vector>

#include "support/json.hpp"
#include "support/paths.hpp"
#include "support/process.hpp"

namespace armcmc::test::gap_names_test {
namespace {

/// Sets of effect names that the verdict holds possible.
std::vector<std::vector<std::string>> Reported(const Json& result) {
  if (result.at("verdict") == "ambiguous") {
    std::vector<std::vector<std::string>> sets;
    for (const Json& set : result.at("ambiguous_set")) {
      sets.emplace_back();
      for (const Json& name : set) sets.back().push_back(name);
    }
    return sets;
  }
  std::vector<std::string> names;
  for (const Json& effect : result.at("effects")) names.push_back(effect.at("name"));
  if (names.empty()) return {};
  return {names};
}

class Names : public ::testing::Test {
 protected:
  Json Diagnose(const std::string& seed, const std::vector<std::string>& more,
                const std::vector<std::string>& of_the_workflow = {}) {
    return DiagnoseScenario(SourceDir() / "plant_sim/scenarios/contact_rich.toml", seed, more, of_the_workflow);
  }
  struct Hidden {
    std::string name, formula;
  };
  /// Two effects of unequal size.
  Json DiagnosePair(const std::string& seed, const Hidden& weak, const Hidden& strong) {
    std::ifstream rich(SourceDir() / "plant_sim/scenarios/contact_rich.toml");
    std::ofstream scenario(dir_ / "pair.toml");
    const auto table = [](const Hidden& effect, double strength) {
      return "\n[[hidden_effect]]\nname = \"" + effect.name + "\"\nvariant = \"" + effect.formula +
             "\"\nstrength = " + std::to_string(strength) + "\n";
    };
    scenario << rich.rdbuf() << table(weak, 0.3) << "seed = " << seed << "\n" << table(strong, 3.0);
    scenario.close();
    return DiagnoseScenario(dir_ / "pair.toml", seed, {}, {});
  }
  /// The scenario with a law that is off by a smooth random factor of that size.
  [[nodiscard]] std::filesystem::path WithLawError(const std::string& scenario, const std::string& error) const {
    std::ifstream plain(SourceDir() / ("plant_sim/scenarios/" + scenario + ".toml"));
    std::ofstream off(dir_ / "off.toml");
    off << plain.rdbuf() << "\n[law]\nerror = " << error << "\n";
    return dir_ / "off.toml";
  }
  Json DiagnoseScenario(const std::filesystem::path& scenario, const std::string& seed,
                        const std::vector<std::string>& more, const std::vector<std::string>& of_the_workflow) {
    std::vector<std::string> plant = {"--scenario", scenario.string(), "--seed", seed, "--csv", dir_ / "run.csv"};
    plant.insert(plant.end(), more.begin(), more.end());
    const Outcome made = RunProgram(Program("armcmc-plant"), plant);
    EXPECT_EQ(made.code, 0) << made.err;
    std::vector<std::string> gap = {"--data", dir_ / "run.csv", "--out", dir_ / "gap"};
    gap.insert(gap.end(), of_the_workflow.begin(), of_the_workflow.end());
    const Outcome found = RunProgram(Program("armcmc-gap"), gap, std::chrono::minutes(3));
    EXPECT_EQ(found.code, 0) << found.err;
    return ReadJson(dir_ / "gap/result.json");
  }
  ScratchDir dir_;
};

/// Recordings that were once misread by chance: a change of the search is judged by many, not by these few.
class LongNames : public Names {};

class NullData : public Names, public ::testing::WithParamInterface<int> {};

TEST_P(NullData, NothingIsNamed) {
  const Json result = Diagnose(std::to_string(GetParam()), {});
  EXPECT_TRUE(result["effects"].empty()) << result["sentence"];
  EXPECT_NE(result["verdict"], "named");
  EXPECT_NE(result["verdict"], "ambiguous");
  EXPECT_FALSE(std::filesystem::exists(dir_ / "gap/model.toml"));
}

INSTANTIATE_TEST_SUITE_P(Seeds, NullData, ::testing::Range(1001, 1004),
                         [](const auto& at) { return std::to_string(at.param); });
INSTANTIATE_TEST_SUITE_P(LongSeeds, NullData, ::testing::Range(1004, 1031),
                         [](const auto& at) { return std::to_string(at.param); });

class Catalogue : public Names, public ::testing::WithParamInterface<std::string> {};

// At the size of the noise (gap ratio 1) the truth is named, or among what cannot be told apart.
TEST_P(Catalogue, TruthIsInTheReportedSet) {
  const Json result = Diagnose("2001", {"--hide-effect", GetParam(), "--sealed", dir_ / "truth.json"});
  const Json truth = ReadJson(dir_ / "truth.json");
  ASSERT_NEAR(truth["effects"][0]["gap_ratio"].get<double>(), 1.0, 0.05);
  EXPECT_THAT(Reported(result), ::testing::Contains(std::vector<std::string>{GetParam()})) << result["sentence"];
}

INSTANTIATE_TEST_SUITE_P(Effects, Catalogue,
                         ::testing::Values("force_bias", "force_drift", "coulomb_friction", "presliding_friction",
                                           "viscous_friction", "inertia", "sensor_delay", "sensor_lag",
                                           "stress_relaxation", "adhesion", "contact_offset", "sensor_saturation",
                                           "periodic_disturbance", "stiffness_drift"),
                         [](const auto& at) { return at.param; });

class OwnFormula : public Names, public ::testing::WithParamInterface<int> {};

// A stiffness that settles early is not the catalogue's linear drift. Below the noise, a shifted surface that acts for
// a second and then no more explains it nearly as well, by the catalogue's own formula; it must not be named alone.
TEST_P(OwnFormula, OfTheTruthIsNotOutdoneByAnEffectThatActsForAWhile) {
  const Json result = Diagnose(
      std::to_string(GetParam()),
      {"--hide-effect", "stiffness_drift:exponential", "--effect-strength", "0.3", "--sealed", dir_ / "truth.json"});
  const auto reported = Reported(result);
  if (reported.empty()) return;  // weaker than the noise: to name nothing is no mistake
  EXPECT_THAT(reported, ::testing::Contains(std::vector<std::string>{"stiffness_drift"})) << result["sentence"];
}

INSTANTIATE_TEST_SUITE_P(LongSeeds, OwnFormula, ::testing::Values(496954201, 3001),
                         [](const auto& at) { return std::to_string(at.param); });

// Adhesion that seems to end where the diagnosed part has hardly a retraction left to show it by fits a nat better than
// adhesion that stays. Data from later then contradict it, and the pair would be struck off for its gate.
TEST_F(LongNames, AGateThatEarnsNothingIsNotKept) {
  const Json result = Diagnose(
      "248090749", {"--hide-effect", "adhesion:exponential,presliding_friction:dahl", "--sealed", dir_ / "truth.json"});
  EXPECT_THAT(Reported(result), ::testing::Contains(::testing::UnorderedElementsAre("adhesion", "presliding_friction")))
      << result["sentence"];
  for (const Json& effect : result["effects"]) EXPECT_EQ(effect["when"], "always");
}

// A relaxation far slower than the recording is long looks like a drift: where the drift is not in the catalogue, none
// of the formulas of the relaxation may take its name.
TEST_F(LongNames, ADriftThatTheCatalogueLacksIsNoSlowRelaxation) {
  for (const char* seed : {"977806592", "15508109"}) {
    const Json result = Diagnose(
        seed, {"--hide-effect", "force_drift:linear", "--effect-strength", "3", "--sealed", dir_ / "truth.json"},
        {"--without", "force_drift"});
    EXPECT_EQ(result["verdict"], "unnamed") << seed << ": " << result["sentence"];
  }
}

// All parameters breathe with a period of a minute: no formula of the catalogue, and nothing that the estimator, which
// follows it, would lack.
TEST_F(LongNames, ADriftThatTheEstimatorFollowsIsNoMissingEffect) {
  const Json result = DiagnoseScenario("hunt_crossley_drift_sine", "1", {}, {});
  EXPECT_EQ(result["verdict"], "none") << result["sentence"];
  EXPECT_THAT(result["sentence"].get<std::string>(), ::testing::HasSubstr("drift"));
  EXPECT_TRUE(result["effects"].empty());
}

// Friction in free motion, of which the first seven seconds have hardly any: they lack nothing, but they do not explain
// the rest.
TEST_F(Names, WhatOnlyTheRestOfTheRecordingShowsIsNotCalledNothing) {
  const Json result = Diagnose("425160732", {"--hide-effect", "coulomb_friction:tanh", "--effect-gate", "free",
                                             "--sealed", dir_ / "truth.json"});
  EXPECT_THAT(Reported(result), ::testing::Contains(::testing::ElementsAre("coulomb_friction"))) << result["sentence"];
  EXPECT_THAT(result["notes"].dump(), ::testing::HasSubstr("in the last 30 % of the recording only"));
}

// A drift that is over before it is seen is a bias. Resting on that bound, it must not take the bias's probability.
TEST_F(LongNames, AFormulaAtTheBoundOfAnotherEffectIsNoRival) {
  const Json result = DiagnosePair("184122956", {"force_bias", "constant"}, {"sensor_saturation", "clip"});
  EXPECT_THAT(Reported(result), ::testing::Contains(::testing::UnorderedElementsAre("force_bias", "sensor_saturation")))
      << result["sentence"];
}

// One sample that noise moves out of the contact, before adhesion lets go, is no surface in another place.
TEST_F(LongNames, AdhesionIsNotMistakenForAMovedSurfaceForOneSample) {
  const Json result = Diagnose("556764019", {"--hide-effect", "adhesion:exponential", "--effect-strength", "3",
                                             "--sealed", dir_ / "truth.json"});
  EXPECT_THAT(Reported(result), ::testing::Contains(::testing::ElementsAre("adhesion"))) << result["sentence"];
}

// What the branch remembers of the time before the recording is known by its first samples only.
TEST_F(LongNames, ARelaxationIsNotMistakenForAnotherBesideAWeakFriction) {
  const Json result = DiagnosePair("497207867", {"presliding_friction", "dahl"}, {"stress_relaxation", "linear"});
  EXPECT_THAT(Reported(result),
              ::testing::Contains(::testing::UnorderedElementsAre("presliding_friction", "stress_relaxation")))
      << result["sentence"];
}

// Noise moves what a weak branch remembers to its bound, a standard deviation away: that makes it no other effect.
TEST_F(LongNames, AWeakRelaxationBesideAStrongFrictionKeepsItsName) {
  const Json result = DiagnosePair("477769003", {"stress_relaxation", "linear"}, {"coulomb_friction", "tanh"});
  EXPECT_THAT(Reported(result),
              ::testing::Contains(::testing::UnorderedElementsAre("coulomb_friction", "stress_relaxation")))
      << result["sentence"];
}

// Red noise that looks like an effect for seven seconds does not for ten. The rest is too quiet to confirm or
// contradict so little by itself.
TEST_F(Names, ChanceThatTheRestCannotConfirmIsNoEffect) {
  std::ifstream rich(SourceDir() / "plant_sim/scenarios/contact_rich_mm.toml");
  std::ofstream red(dir_ / "red.toml");
  for (std::string line; std::getline(rich, line);)
    if (!line.starts_with("correlation_to"))
      red << (line.starts_with("correlation =") ? "correlation = 0.95" : line) << "\n";
  red.close();
  const Json result = DiagnoseScenario(dir_ / "red.toml", "968474185", {}, {});
  EXPECT_EQ(result["verdict"], "none") << result["sentence"];
  EXPECT_THAT(result["notes"].dump(), ::testing::HasSubstr("all of it shows nothing beyond the noise"));
}

// A latency may be part delay, part lag: where the data cannot tell the two apart, they cannot tell that only one acts.
TEST_F(LongNames, ALatencyMayBePartDelayPartLag) {
  const Json result = Diagnose(
      "906346304", {"--hide-effect", "sensor_lag:first_order,sensor_delay:dead_time", "--sealed", dir_ / "truth.json"});
  ASSERT_EQ(result["verdict"], "ambiguous") << result["sentence"];
  EXPECT_THAT(Reported(result), ::testing::Contains(::testing::ElementsAre("sensor_delay", "sensor_lag")))
      << result["sentence"];
  EXPECT_THAT(result["sentence"].get<std::string>(), ::testing::HasSubstr("or sensor_delay and sensor_lag;"));
}

// The first 70 % name one effect and lack nothing besides; only the rest reaches the limit of the sensor.
TEST_F(LongNames, WhatTheRestOfTheRecordingContradictsIsNamedAnew) {
  const Json result =
      Diagnose("767540293", {"--hide-effect", "inertia:rigid,sensor_saturation:clip", "--sealed", dir_ / "truth.json"});
  EXPECT_THAT(Reported(result), ::testing::Contains(::testing::UnorderedElementsAre("inertia", "sensor_saturation")))
      << result["sentence"];
  EXPECT_THAT(result["notes"].dump(), ::testing::HasSubstr("name inertia, which the rest contradicts"));
}

// Half-way through what is diagnosed the two add up to nothing, so that each of them seems to end there.
TEST_F(LongNames, ABiasAndADriftThatCancelAreNamedBoth) {
  const Json result = Diagnose(
      "336045211", {"--hide-effect", "force_bias:constant,force_drift:linear", "--sealed", dir_ / "truth.json"});
  EXPECT_THAT(Reported(result), ::testing::Contains(::testing::UnorderedElementsAre("force_bias", "force_drift")))
      << result["sentence"];
  for (const Json& effect : result.at("effects")) EXPECT_EQ(effect.at("when"), "always");
}

// One release is fast enough to pull further than the sensor can say.
TEST_F(Names, ASensorThatClipsPullsAsWellAsPushesHasASaturation) {
  const Json result = Diagnose("371165477", {"--hide-effect", "sensor_saturation:clip", "--effect-strength", "3",
                                             "--sealed", dir_ / "truth.json"});
  EXPECT_THAT(Reported(result), ::testing::Contains(::testing::ElementsAre("sensor_saturation"))) << result["sentence"];
  EXPECT_GT(result.at("gap").at("closed_fraction"), 0.99);
}

// An error of the law that no smooth factor takes wholly: something is left, but friction gains beyond that factor
// twice what any other family does.
TEST_F(Names, AnEffectThatNoOtherComesNearIsNamedBesideALawThatErrs) {
  std::ifstream rich(SourceDir() / "plant_sim/scenarios/contact_rich.toml");
  std::ofstream off(dir_ / "off.toml");
  off << rich.rdbuf() << "\n[law]\nerror = 0.03\n";
  off.close();
  const Json result = DiagnoseScenario(
      dir_ / "off.toml", "521942139",
      {"--hide-effect", "coulomb_friction:tanh", "--effect-strength", "3", "--sealed", dir_ / "truth.json"}, {});
  EXPECT_THAT(Reported(result), ::testing::ElementsAre(std::vector<std::string>{"coulomb_friction"}))
      << result["sentence"];
  EXPECT_EQ(result["complete"], false);
}

// Relaxation and friction explain what a law that is off by a hair leaves, and drag that the catalogue lacks explains
// it better: a tie that is less probable than not is no name.
TEST_F(LongNames, ATieThatIsLessProbableThanNotIsWithheld) {
  const Json result = DiagnoseScenario(WithLawError("contact_sine", "0.003"), "789295887", {}, {});
  EXPECT_EQ(result["verdict"], "unnamed") << result["sentence"];
}

}  // namespace
}  // namespace armcmc::test::gap_names_test
