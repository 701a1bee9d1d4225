#include "armcmc/gap_bench/summary.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "armcmc/gap_bench/report.hpp"
#include "armcmc/gap_bench/strata.hpp"

namespace armcmc::gap_bench::summary_test {
namespace {

Outcome Made(const std::string& stratum, Grade grade, double probability, bool right) {
  Outcome outcome;
  outcome.what.stratum = stratum;
  outcome.what.group = "R 1";
  outcome.grade = grade;
  outcome.label_probability = probability;
  outcome.label_right = right;
  return outcome;
}

const Gate* Find(const std::vector<Gate>& gates, const std::string& stratum, const std::string& metric) {
  for (const Gate& gate : gates)
    if (gate.stratum == stratum && gate.metric == metric) return &gate;
  return nullptr;
}

TEST(Rows, CountGradesAndLeaveOutWhatCouldNotBeMade) {
  const auto rows = Rows({Made("singles", Grade::kRight, 1, true), Made("singles", Grade::kWrong, 1, false),
                          Made("singles", Grade::kNotMade, 0, false), Made("null", Grade::kRight, 1, true)});
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0].counted(), 2);
  EXPECT_EQ(rows[0].of(Grade::kWrong), 1);
  EXPECT_EQ(rows[0].of(Grade::kNotMade), 1);
}

TEST(Calibrate, IsTheMeanDistanceOfWhatWasPrintedFromWhatCameTrue) {
  // Three at 0.9 of which two came true, one at 0.4 that did not: (3 |0.9 - 2/3| + 1 |0.4 - 0|) / 4.
  const Calibration calibration =
      Calibrate({Made("singles", Grade::kRight, 0.9, true), Made("singles", Grade::kRight, 0.9, true),
                 Made("singles", Grade::kWrong, 0.9, false), Made("singles", Grade::kWrong, 0.4, false),
                 Made("singles", Grade::kNotMade, 1.0, false)});
  EXPECT_EQ(calibration.n, 4);
  EXPECT_NEAR(calibration.error, (3 * (0.9 - 2.0 / 3.0) + 0.4) / 4, 1e-12);
  EXPECT_EQ(calibration.bins.back().n, 3);
}

TEST(Gates, StandOnlyForStrataThatRan) {
  const std::vector<Gate> gates = Gates({Made("null", Grade::kRight, 1, true), Made("null", Grade::kWrong, 1, false)});
  ASSERT_NE(Find(gates, "null", "named"), nullptr);
  EXPECT_EQ(Find(gates, "null", "named")->value, 0.5);
  EXPECT_FALSE(Find(gates, "null", "named")->passed());
  EXPECT_EQ(Find(gates, "pairs", "wrong"), nullptr);
}

TEST(Gates, AnAnswerThatFailedCountsAsWrong) {
  const std::vector<Gate> gates =
      Gates({Made("pairs", Grade::kFailed, 0, false), Made("pairs", Grade::kRight, 1, true)});
  EXPECT_EQ(Find(gates, "pairs", "wrong")->value, 0.5);
}

TEST(Gates, OfTheActuatorAreByWhatIsHidden) {
  Outcome nothing = Made("actuator", Grade::kUnnamed, 0.9, false);
  nothing.what.effect = "none";
  Outcome found = Made("actuator", Grade::kRight, 0.9, true), misled = Made("actuator", Grade::kTie, 0.9, true);
  Outcome outside = Made("actuator", Grade::kWrong, 0.9, false);
  for (Outcome* one : {&found, &misled, &outside}) one->truth.effects.resize(1);
  found.equation_right = true;
  misled.equation_right = false;
  outside.truth.effects.front().kind = "outside";
  outside.answer.result.verdict = gap::Verdict::kNamed;
  outside.answer.result.effects.resize(1);
  const std::vector<Gate> gates = Gates({nothing, found, misled, outside});
  const auto value = [&](const char* metric) { return Find(gates, "actuator", metric)->value; };
  EXPECT_EQ(value("nothing hidden: named"), 0.0);
  EXPECT_EQ(value("nothing hidden: flagged"), 1.0);
  EXPECT_EQ(value("truth in the set"), 1.0);
  EXPECT_EQ(value("wrong"), 0.0);
  EXPECT_EQ(value("right equation"), 0.5);
  EXPECT_EQ(value("outside the catalogue: false name"), 1.0);
}

TEST(Gates, WhereThePlantIsNotTheCatalogueAreOfFamiliesAndOfWhatTheFirstRungCloses) {
  Outcome right = Made("law_error", Grade::kRight, 0.95, true), kin = Made("law_error", Grade::kFamily, 0.95, true);
  right.first_rung = 1.0;
  kin.first_rung = 0.5;
  const std::vector<Gate> gates =
      Gates({right, kin, Made("law_error", Grade::kUnnamed, 0.6, false), Made("law_error", Grade::kWrong, 0.9, false),
             Made("near_null", Grade::kUnnamed, 0.6, false), Made("singles", Grade::kRight, 0.95, true)});
  EXPECT_EQ(Find(gates, "law_error", "right family")->value, 0.5);
  EXPECT_EQ(Find(gates, "law_error", "false family")->value, 0.25);
  EXPECT_NEAR(Find(gates, "law_error", "closed of what the truth closes, 10 % quantile")->value, 0.55, 1e-12);
  EXPECT_EQ(Find(gates, "near_null", "named")->value, 0.0);
  // Printed probabilities are judged apart, too.
  EXPECT_EQ(Find(gates, "calibration", "right when P >= 0.9")->n, 1);
  EXPECT_EQ(Find(gates, "calibration, plant not the catalogue", "right when P >= 0.9")->n, 3);
}

TEST(Confuse, KeepsPlantsThatAreNotTheCatalogueApart) {
  Outcome beside = Made("unlisted", Grade::kUnnamed, 0.9, false);
  beside.truth.effects.resize(2);
  beside.truth.effects[0].name = "inertia";
  beside.truth.effects[1].name = "backlash";
  beside.truth.effects[1].kind = "outside";
  beside.answer.result.verdict = gap::Verdict::kUnnamed;
  const auto total = [&](bool imperfect) {
    int n = 0;
    for (const auto& row : Confuse({beside}, imperfect).count)
      for (const int count : row) n += count;
    return n;
  };
  EXPECT_EQ(total(true), 1);
  EXPECT_EQ(total(false), 0);
}

/// A half of a recording of a real motion, named so.
Outcome Half(Part part, const std::string& scenario, const std::string& name) {
  Outcome outcome = Made(kRecorded, Grade::kRight, 0.9, true);
  outcome.what.part = part;
  outcome.what.scenario = scenario;
  outcome.what.effect = "inertia:rigid";
  if (name.empty()) return outcome;
  outcome.answer.result.verdict = gap::Verdict::kNamed;
  outcome.answer.result.effects.resize(1);
  outcome.answer.result.effects.front().name = name;
  return outcome;
}

TEST(Gates, HalvesOfARecordingContradictEachOtherByTheirNamesOnly) {
  Outcome drifted = Half(Part::kSecondHalf, "b", "inertia");
  drifted.what.own = {"force_bias"};
  drifted.answer.result.effects.resize(2);
  drifted.answer.result.effects.back().name = "force_bias";
  const std::vector<Gate> gates = Gates(
      {Half(Part::kFirstHalf, "a", "inertia"), Half(Part::kSecondHalf, "a", "adhesion"),
       Half(Part::kFirstHalf, "b", "inertia"), drifted, Half(Part::kFirstHalf, "c", "inertia"),
       Half(Part::kSecondHalf, "c", ""), Half(Part::kFirstHalf, "d", "inertia"), Half(Part::kWhole, "d", "adhesion")});
  const Gate* gate = Find(gates, kRecorded, "halves contradict each other");
  ASSERT_NE(gate, nullptr);
  EXPECT_EQ(gate->n, 3);
  EXPECT_NEAR(gate->value, 1.0 / 3.0, 1e-12);
}

TEST(Gates, OfRealRecordingsTellRealNoiseFromThePlants) {
  Outcome plain = Made(kRecorded, Grade::kRight, 0.9, true), real = Made(kRecorded, Grade::kWrong, 0.9, false);
  for (Outcome* one : {&plain, &real}) one->what.effect = "inertia:rigid";
  real.what.group = kRealNoise;
  const std::vector<Gate> gates = Gates({plain, real});
  EXPECT_EQ(Find(gates, kRecorded, "real motion: wrong")->value, 0.0);
  EXPECT_EQ(Find(gates, kRecorded, "real motion and noise: wrong")->value, 1.0);
}

Outcome Begun(Grade grade, std::optional<double> error_s, std::optional<double> off_s) {
  Outcome outcome = Made("onset", grade, 0.9, true);
  outcome.onset_error_s = error_s;
  outcome.onset_off_s = off_s;
  return outcome;
}

TEST(LocateOnsets, CountsOfThoseFoundAlsoTheOnesWithoutATime) {
  // Of four found: one exact, one 0.1 s off the interval, one 0.3 s, one said to act always. The wrong one is not
  // found.
  const std::vector<Outcome> outcomes = {Begun(Grade::kRight, 0.0, 0.15), Begun(Grade::kTie, 0.1, 0.25),
                                         Begun(Grade::kRight, 0.3, 0.3), Begun(Grade::kRight, {}, {}),
                                         Begun(Grade::kWrong, 0.0, 0.0)};
  const Onsets onsets = LocateOnsets(outcomes);
  EXPECT_EQ(onsets.n, 4);
  EXPECT_EQ(onsets.dated, 3);
  EXPECT_EQ(onsets.within_20_ms, 0.25);
  EXPECT_EQ(onsets.within_200_ms, 0.5);
  EXPECT_EQ(onsets.off_within_200_ms, 0.25);
  EXPECT_NEAR(onsets.median_s, 0.1, 1e-12);
  const std::vector<Gate> gates = Gates(outcomes);
  ASSERT_NE(Find(gates, "onset", "onset within 0.2 s, of those found"), nullptr);
  EXPECT_FALSE(Find(gates, "onset", "onset within 0.2 s, of those found")->passed());
  const nlohmann::json json = ToJson(outcomes, 1);
  EXPECT_EQ(json.at("onset").at("within_200_ms"), 0.5);
  EXPECT_EQ(json.at("cases").at(0).at("onset_off_s"), 0.15);
  EXPECT_NE(Html(outcomes, 1).find("50 % were dated within 0.2 s and 25 % within 20 ms"), std::string::npos);
}

TEST(Quantile, IsLinearBetweenValues) {
  EXPECT_NEAR(Quantile({3.0, 1.0, 2.0}, 0.25), 1.5, 1e-12);
  EXPECT_TRUE(std::isnan(Quantile({}, 0.5)));
}

TEST(BenchReport, HoldsEveryCaseWithItsCommands) {
  Outcome outcome = Made("singles", Grade::kRight, 1, true);
  outcome.what.scenario = "contact_rich";
  outcome.what.effect = "inertia:rigid";
  outcome.what.seed = 17;
  outcome.what.without = {"adhesion"};
  const nlohmann::json json = ToJson({outcome}, 4);
  EXPECT_EQ(json.at("schema"), 1);
  const std::string plant = json.at("cases").at(0).at("plant");
  EXPECT_NE(plant.find("--scenario contact_rich --seed 17 --hide-effect inertia:rigid"), std::string::npos) << plant;
  EXPECT_NE(json["cases"][0].at("tool").get<std::string>().find("--without adhesion"), std::string::npos);
  EXPECT_NE(Html({outcome}, 4).find("</html>"), std::string::npos);
}

}  // namespace
}  // namespace armcmc::gap_bench::summary_test
