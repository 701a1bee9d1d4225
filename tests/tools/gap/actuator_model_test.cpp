// From what is named in the valve flow to the settings of an estimator that predicts the same.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <memory>

#include "armcmc/effects/composition.hpp"
#include "armcmc/gap/model_writer.hpp"
#include "armcmc/gap/workflow.hpp"
#include "armcmc/models/registry.hpp"
#include "armcmc/support/model_file.hpp"
#include "gap/plants/soft_actuator/actuator_equation.hpp"
#include "plants/soft_actuator/model.hpp"
#include "simd/kernels.hpp"
#include "support/paths.hpp"
#include "tools/gap/actuator_rig.hpp"

namespace armcmc::gap::test::actuator_model_test {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

constexpr char kModel[] = "soft_actuator_excited";
constexpr double kNoise = 500.0;

/// A fit of one effect to what the plant hides.
struct Named {
  std::unique_ptr<Equation> equation = MakeFlowEquation(kModel);
  Signals signals;
  std::vector<EffectForm> catalogue;
  std::unique_ptr<Fitter> fitter;
  Fitted fit;

  explicit Named(const std::string& effect) {
    signals = equation->Prepare(RecordPlant(kModel, {{effect, 3.0, {}}}, 61, 8.0), 15);
    catalogue = equation->Catalogue(signals);
    Whitener white;
    white.variance = kNoise * kNoise;
    fitter = std::make_unique<Fitter>(*equation, signals, white);
    const Fitted base = fitter->Fit({}, equation->Start(signals));
    for (const EffectForm& form : catalogue)
      if (form.exact() && form.effect == effect) fit = fitter->Add(base, {&form, {}});
  }
};

/// Largest difference between estimator and workflow, as a share of the largest rate, over samples that the estimator
/// uses; parameters at the means of the settings, gains at those of the fit, the amplitude moved `by`.
double WorstDifference(const Named& named, const EstimatorSettings& settings, double by = 0.0) {
  constexpr Eigen::Index kPack = 100;
  const Signals& s = named.signals;
  const Matrix covariance = named.fit.Covariance(kNoise * kNoise);
  const std::vector<ParameterEstimate> gains = named.equation->Report(s, named.fit.theta, covariance);
  Composition composition(settings);
  const auto effects = std::make_unique<EffectPack>(composition.MakePack());
  const auto data = std::make_unique<ModeData>();
  const auto tile = std::make_unique<PredictionTile>();
  const auto theta = std::make_unique<ThetaTile>();
  theta->value[2].fill(composition.sampled().parameters[2].mean + by);
  double worst = 0.0;
  int compared = 0;
  for (Eigen::Index first = 0; first + kPack <= s.rows(); first += kPack) {
    DataPack pack;
    pack.seq = first / kPack + 1;
    pack.run_id = 1;
    pack.dt = s.dt;
    pack.plant = SoftActuator::kInfo.plant;
    pack.num_samples = static_cast<int>(kPack);
    pack.num_inputs = 4;
    for (Eigen::Index n = 0; n < kPack; ++n) {
      const double u = s.at(Role::kOpening)[first + n];
      pack.u[static_cast<std::size_t>(n)] = {
          std::max(u, 0.0), std::max(-u, 0.0),
          s.at(Role::kPressure)[first + n] + ActuatorConstants(settings.constants).p_atm, s.output[first + n]};
    }
    pack.t_last_s = s.t[first + kPack - 1];
    EXPECT_TRUE(composition.Prepare(pack, effects.get()));
    for (int mode = 0; mode < 2; ++mode) {
      composition.Fill(pack, *effects, mode, data.get());
      theta->value[0].fill(gains[static_cast<std::size_t>(2 * mode)].mean);
      theta->value[1].fill(gains[static_cast<std::size_t>(2 * mode + 1)].mean);
      simd::Best().predict(FindModel("soft_actuator"), *data, *theta, tile.get());
      for (std::size_t k = 0; k < static_cast<std::size_t>(data->num_samples); ++k, ++compared)
        worst = std::max(worst, std::abs(tile->value[k][0] - named.fit.predicted[first + data->sample[k]]));
    }
  }
  EXPECT_GT(compared, 5000);
  return worst / named.fit.predicted.cwiseAbs().maxCoeff();
}

class FlowWriteBack : public ::testing::TestWithParam<const char*> {};

TEST_P(FlowWriteBack, TheEstimatorPredictsWhatTheWorkflowPredictsAndItsFileReadsBackToTheBit) {
  const Named named(GetParam());
  const EstimatorSettings settings = AugmentedSettings(kModel, *named.fitter, named.fit, kNoise);
  ASSERT_EQ(settings.num_effects, 1);
  EXPECT_EQ(settings.effects[0].name, GetParam());
  for (const NoiseSettings& noise : settings.noise) EXPECT_EQ(noise.std, kNoise);
  // The workflow lets a spool stand still before the recording; the estimator waits four of the longest time constants.
  const double tolerance = std::string(GetParam()) == "valve_lag" ? 1e-3 : 1e-6;
  EXPECT_LT(WorstDifference(named, settings), tolerance);
  const double step = 0.2 * settings.effects[0].amplitudes[0].mean;
  EXPECT_GT(WorstDifference(named, settings, step), 1e-4) << "the added amplitude is not active";

  const armcmc::test::ScratchDir dir;
  const std::string text = support::ModelFileText(settings, kModel);
  std::ofstream(dir / "model.toml") << text;
  const EstimatorSettings read = support::ReadModel(dir / "model.toml");
  EXPECT_EQ(support::BaseModel(dir / "model.toml"), kModel);
  EXPECT_EQ(support::ModelFileText(read, kModel), text);
  EXPECT_EQ(read.effects[0].amplitudes[0].mean, settings.effects[0].amplitudes[0].mean);
  EXPECT_EQ(read.forgetting.lambda_max, settings.forgetting.lambda_max) << "of the built-in model";
  // Either valve fits under the prior that they share.
  for (std::size_t d = 0; d < 2; ++d) EXPECT_EQ(read.parameters[d].mean, 0.0);
}

INSTANTIATE_TEST_SUITE_P(Catalogue, FlowWriteBack,
                         ::testing::Values("leak", "valve_dead_band", "valve_lag", "supply_droop", "pressure_bias"),
                         [](const auto& at) { return std::string(at.param); });

WorkflowOutcome Diagnosed(const std::vector<HiddenInPlant>& hidden, unsigned long long seed) {
  WorkflowRequest request;
  request.model = kModel;
  request.data = RecordPlant(kModel, hidden, seed, 12.0);
  return RunWorkflow(request);
}

TEST(ActuatorModelFile, SaysWhyThereIsNoModelForWhatTheBendEquationLacks) {
  const WorkflowOutcome outcome = Diagnosed({{"cubic_stiffness", 2.0, {}}}, 61);
  EXPECT_FALSE(outcome.augmented);
  EXPECT_THAT(outcome.result.notes, Contains(HasSubstr("cubic_stiffness: for offline fits only")));
}

// The bend equation sees the sensor's zero best; the estimator runs it where it has the sensor, too.
TEST(ActuatorModelFile, ASensorThatBothEquationsReadRunsInTheFlow) {
  const WorkflowOutcome outcome = Diagnosed({{"pressure_bias", 1.0, {-3000.0}}}, 61);
  ASSERT_TRUE(outcome.augmented);
  ASSERT_EQ(outcome.augmented->num_effects, 1);
  EXPECT_EQ(outcome.augmented->effects[0].name, "pressure_bias");
  const ParameterSettings& bias = outcome.augmented->effects[0].amplitudes[0];
  EXPECT_NEAR(bias.mean, -3000.0, 2.0 * bias.sd);
}

}  // namespace
}  // namespace armcmc::gap::test::actuator_model_test
