#include "armcmc/ladder/experiment.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "armcmc/plant_sim/described_simulation.hpp"
#include "armcmc/support/effect_library.hpp"
#include "armcmc/support/plant_file.hpp"
#include "described_files.hpp"
#include "motion.hpp"
#include "prospect.hpp"
#include "support/paths.hpp"
#include "tools/ladder/made_data.hpp"

namespace armcmc::ladder::experiment_test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

/// An effect, and where its parameters are as they are sampled.
using Start = std::pair<std::string, std::vector<double>>;

/// A rung on which all of these were named, with these values.
Rung TieOf(const std::vector<Start>& effects, Dataset data, const PlantDescription& plant) {
  static const std::vector<EffectEntry> library = support::ReadEffectLibrary();
  Rung rung;
  rung.base = FitAlone(std::make_shared<const Plant>(plant), &data);
  rung.view.data = data;
  std::vector<std::string> notes;
  const DataScales scales = ScalesOf(data, plant, 2.0);
  for (const auto& [effect, values] : effects) {
    Contender contender;
    for (Candidate& candidate : Candidates(plant, library, scales, &notes))
      if (candidate.entry->name == effect && contender.candidate.entry == nullptr)
        contender.candidate = std::move(candidate);
    Eigen::VectorXd theta(rung.base.fit.theta.size() + static_cast<Eigen::Index>(values.size()));
    theta << rung.base.fit.theta,
        Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
    contender.trial = Refine(contender.candidate.plant, data, theta);
    contender.refined = contender.trial.fit.valid;
    contender.trial.fit.theta.tail(static_cast<Eigen::Index>(values.size())) =
        theta.tail(static_cast<Eigen::Index>(values.size()));
    contender.win_share = 1.0 / static_cast<double>(effects.size());
    rung.named.push_back(rung.contenders.size());
    rung.contenders.push_back(std::move(contender));
  }
  return rung;
}

/// An axis that goes one way at a constant speed, with a ripple over the way.
Dataset OneWay() {
  auto series = std::make_shared<identify::Series>(*test::AxisData([](const auto&) { return 0.0; }).series);
  Dataset data = test::AxisData([](const auto&) { return 0.0; });
  for (std::size_t n = 0; n < series->num_rows(); ++n) {
    const double noise = series->signals[3][n] - 100.0 * series->signals[2][n] - 180.0 * series->signals[1][n];
    series->signals[0][n] = 0.02 * series->t[n];
    series->signals[1][n] = 0.02;
    series->signals[2][n] = 0.0;
    series->signals[3][n] = 3.6 + 6.0 * std::sin(series->signals[0][n] / 0.01) + noise;
  }
  data.series = std::move(series);
  return data;
}

const Start kInTime{"periodic_disturbance", {6.0, 0.0, std::log(2.0)}};
const Start kAlongTheWay{"cogging", {6.0, 0.0, std::log(100.0)}};

TEST(Inputs, AreThoseThatTheSimulationMoves) {
  int plants = 0;
  for (const auto& folder : std::filesystem::directory_iterator(test::SourceDir() / "core/plants")) {
    const std::filesystem::path file = folder.path() / "plant.toml";
    if (!std::filesystem::exists(file)) continue;
    const PlantDescription plant = support::ReadPlant(file).description();
    std::vector<std::string> names;
    for (const std::size_t s : InputsOf(plant)) names.push_back(plant.signals[s].name);
    EXPECT_EQ(names, plant_sim::InputsToMove(plant_sim::ReadDescribedPlant(support::StrictTable::FromFile(file))))
        << file;
    ++plants;
  }
  EXPECT_GE(plants, 8);
}

TEST(Inputs, RangesAreThoseOfTheRecording) {
  const PlantDescription plant = test::AxisPlant();
  const std::vector<InputRange> ranges = RangesOf(OneWay(), plant);
  ASSERT_EQ(ranges.size(), 1u);  // velocity and acceleration follow
  EXPECT_NEAR(ranges[0].low, 0.0, 0.002);
  EXPECT_NEAR(ranges[0].high, 0.28, 0.002);  // of the rows that are not kept apart
  EXPECT_NEAR(ranges[0].speed, 0.02, 1e-9);
  EXPECT_NEAR(ranges[0].frequency_hz, 1.0 / 14.0, 1e-3);
}

TEST(Motions, AreWhatTheSimulationMakesOfTheSameWords) {
  const support::PlantFile file = support::ReadPlantFile(test::SourceDir() / "core/plants/servo_axis/plant.toml");
  const plant_sim::DescribedPlant simulated = plant_sim::ReadDescribedPlant(
      support::StrictTable::FromFile(test::SourceDir() / "core/plants/servo_axis/plant.toml"));
  const InputRange range{.signal = 0, .low = -0.1, .high = 0.3, .rest = 0.0, .frequency_hz = 0.4, .speed = 0.5};
  constexpr std::size_t kRows = 500;
  constexpr double kDt = 0.02;
  const std::vector<Motion> motions = MotionsAt(1.0, file.base, {range}, kRows * kDt, kDt);
  ASSERT_EQ(motions.size(), 8u);
  for (const Motion& motion : motions) {
    const auto series = SeriesOf(motion, file.base, std::vector<double>(4, 0.0), kRows, kDt);
    ASSERT_NE(series, nullptr) << motion.program;
    plant_sim::DescribedScenario scenario;
    scenario.dt = kDt;
    scenario.duration_s = kRows * kDt;
    scenario.inputs["q"] = {.kind = plant_sim::InputProgram::Kind::kExpression, .text = motion.program_of.at(0)};
    plant_sim::DescribedSimulation simulation(simulated, scenario);
    for (std::size_t n = 0; n < kRows; ++n) {
      simulation.Next();
      for (std::size_t s = 0; s < 3; ++s) {
        const double value = simulation.measured()[s];
        ASSERT_NEAR(series->signals[s][n], value, 1e-9 * (1.0 + std::fabs(value))) << motion.program << ' ' << s;
      }
      ASSERT_GT(series->signals[0][n], -0.1 - 1e-6) << motion.program;
      ASSERT_LT(series->signals[0][n], 0.3 + 1e-6) << motion.program;
    }
  }
}

TEST(SeparatingMotion, DecidesBetweenARippleInTimeAndOneAlongTheWay) {
  const Dataset data = OneWay();
  const PlantDescription plant = test::AxisPlant();
  const Rung tie = TieOf({kInTime, kAlongTheWay}, data, plant);
  // As it was recorded both predict the same.
  const Tied tied(tie);
  EXPECT_EQ(tied.NotMade(), "");
  const auto again = std::make_shared<identify::Series>(*data.series);
  const std::optional<Prospect> nothing = tied.Refitted(again);
  ASSERT_TRUE(nothing.has_value());
  EXPECT_LT(nothing->least, 1.0);

  const gap::Experiment experiment = SeparatingMotion(data, tie, plant);
  EXPECT_GT(experiment.nats, 100.0);
  EXPECT_THAT(experiment.words, StartsWith("To separate them: move q "));
  EXPECT_THAT(experiment.words, HasSubstr("nats of evidence between periodic disturbance and cogging; 10 decide."));
  EXPECT_FALSE(experiment.course.x.empty());
  EXPECT_EQ(experiment.course_title, "q, m");
  const plant_sim::DescribedScenario scenario =
      plant_sim::ReadDescribedScenario(support::StrictTable::FromText(experiment.scenario_text, "experiment.toml"));
  EXPECT_NEAR(scenario.dt, 0.01, 1e-9);
  EXPECT_NEAR(scenario.duration_s, 20.0, 1e-9);
  EXPECT_EQ(scenario.inputs.size(), 1u);
  EXPECT_NEAR(scenario.truth.at("off").front() + 0.02 * scenario.truth.at("Fv").front(), 3.6, 0.3);
  ASSERT_TRUE(scenario.noise.has_value());
  EXPECT_NEAR(scenario.noise->std, 2.0, 0.2);
}

TEST(SeparatingMotion, OfASimulatedPlantBeginsAsTheRecording) {
  const Dataset data =
      test::SwingData([](double u) { return u; }, [](double pos) { return 20.0 * pos + 10.0 * pos * pos * pos; });
  const PlantDescription plant = test::SwingPlant();
  const gap::Experiment experiment =
      SeparatingMotion(data, TieOf({{"cubic_stiffness", {10.0}}, {"drag", {0.5}}}, data, plant), plant);
  EXPECT_THAT(experiment.words, StartsWith("To separate them: vary u "));
  const plant_sim::DescribedScenario scenario =
      plant_sim::ReadDescribedScenario(support::StrictTable::FromText(experiment.scenario_text, "experiment.toml"));
  EXPECT_NEAR(scenario.start.at("y"), data.series->signals[1][0], 1e-9);
  EXPECT_EQ(scenario.inputs.count("y"), 0u);
  EXPECT_EQ(scenario.truth.size(), 3u);
}

TEST(SeparatingMotion, SaysSoWhereNoMotionDecides) {
  const Dataset data = OneWay();
  const PlantDescription plant = test::AxisPlant();
  const gap::Experiment experiment = SeparatingMotion(data, TieOf({kAlongTheWay, kAlongTheWay}, data, plant), plant);
  EXPECT_THAT(experiment.words, StartsWith("No motion within reach of the recording would decide"));
  EXPECT_LT(experiment.nats, 1.0);
  EXPECT_EQ(experiment.scenario_text, "");
  EXPECT_TRUE(experiment.course.x.empty());
}

TEST(SeparatingMotion, SaysSoWhereNoOutcomeCanBePredicted) {
  const Dataset data = OneWay();
  const PlantDescription plant = test::AxisPlant();
  Rung tie = TieOf({kInTime, kAlongTheWay}, data, plant);
  // A viscous friction with which every motion would need several times the forces of the recording.
  tie.base.fit.theta[1] *= 10.0;
  const gap::Experiment experiment = SeparatingMotion(data, tie, plant);
  EXPECT_THAT(experiment.words, HasSubstr("For no motion of the library within the range of the recording"));
  EXPECT_EQ(experiment.scenario_text, "");
}

TEST(SeparatingMotion, TellsHowManyPairsItDecides) {
  const Dataset data = OneWay();
  const PlantDescription plant = test::AxisPlant();
  const gap::Experiment experiment =
      SeparatingMotion(data, TieOf({kInTime, kAlongTheWay, kAlongTheWay}, data, plant), plant);
  EXPECT_THAT(experiment.words, HasSubstr("between cogging and cogging"));
  EXPECT_THAT(experiment.words,
              HasSubstr("so little that repeating it would hardly help; 2 of the 3 pairs would be decided."));
  EXPECT_LT(experiment.nats, 1.0);
  EXPECT_NE(experiment.scenario_text, "");
}

TEST(SeparatingMotion, ForeseesNothingWhereALawReadsWhatTheMotionMakes) {
  const Dataset data = OneWay();
  PlantDescription plant = test::AxisPlant();
  Rung tie = TieOf({kInTime, kAlongTheWay}, data, plant);
  // The velocity is a state that somebody measures.
  plant.signals[1].derivative_of = "";
  plant.signals[2].derivative_of = "";
  plant.states = {{"w", "m/s", "velocity", "a", "v", "v", 1}};
  tie.base.model = std::make_shared<const identify::TrajectoryModel>(std::make_shared<const Plant>(plant), data.series);
  const gap::Experiment experiment = SeparatingMotion(data, tie, plant);
  EXPECT_THAT(experiment.words, HasSubstr("cannot be predicted: v depends on the motion itself"));
  EXPECT_THAT(experiment.words, Not(HasSubstr("nats")));
  EXPECT_EQ(experiment.scenario_text, "");
}

}  // namespace
}  // namespace armcmc::ladder::experiment_test
