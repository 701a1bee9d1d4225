// From a fitted hypothesis to the settings of an estimator that predicts the same.

#include "armcmc/gap/model_writer.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "armcmc/effects/composition.hpp"
#include "armcmc/models/registry.hpp"
#include "plants/hunt_crossley/model.hpp"
#include "simd/kernels.hpp"
#include "tools/gap/gap_rig.hpp"

namespace armcmc::gap::model_writer_test {
namespace {

using test::Bench;
using test::Hidden;
using test::Measure;
using test::White;

constexpr double kNoise = 0.05;

/// What the estimator's composed model says of the inputs, parameters at the means of the settings.
Vector EstimatorSays(const EstimatorSettings& settings, const Signals& s) {
  constexpr Eigen::Index kPack = 100;
  Composition composition(settings);
  auto effects = std::make_unique<EffectPack>(composition.MakePack());
  auto data = std::make_unique<ModeData>();
  auto tile = std::make_unique<PredictionTile>();
  auto theta = std::make_unique<ThetaTile>();
  const EstimatorSettings& sampled = composition.sampled();
  for (int d = 0; d < sampled.num_parameters; ++d)
    theta->value[static_cast<std::size_t>(d)].fill(sampled.parameters[static_cast<std::size_t>(d)].mean);
  Vector y(s.rows());
  for (Eigen::Index first = 0; first < s.rows(); first += kPack) {
    DataPack pack;
    pack.seq = first / kPack + 1;
    pack.run_id = 1;
    pack.dt = s.dt;
    pack.plant = HuntCrossley::kInfo.plant;
    pack.num_samples = static_cast<int>(std::min(kPack, s.rows() - first));
    pack.num_inputs = 2;
    for (int n = 0; n < pack.num_samples; ++n) {
      const auto i = static_cast<std::size_t>(n);
      pack.u[i] = {s.at(Role::kPosition)[first + n], s.at(Role::kVelocity)[first + n]};
      pack.y[i] = s.output[first + n];
    }
    pack.t_last_s = s.t[first + pack.num_samples - 1];
    pack.t_last_ns = static_cast<Nanos>(pack.t_last_s * 1e9);
    EXPECT_TRUE(composition.Prepare(pack, effects.get()));
    composition.Fill(pack, *effects, 0, data.get());
    simd::Best().predict(FindModel("hunt_crossley"), *data, *theta, tile.get());
    for (int n = 0; n < pack.num_samples; ++n) y[first + n] = tile->value[static_cast<std::size_t>(n)][0];
  }
  return y;
}

/// Largest difference between workflow and estimator, as a share of the largest force, where the formulas are the same;
/// beyond rounding:
///   inertia            the acceleration of the workflow comes from a smoother without phase, that of the estimator is
///                      the last difference, half a sample late; it has none for the first sample of all
///   stress_relaxation  the workflow holds the depth over a sample, the estimator's is linear
///   sensor_lag         the estimator keeps eight of the longest time constants of its prior
double Tolerance(const std::string& effect) {
  if (effect == "inertia") return 2e-2;
  if (effect == "stress_relaxation") return 3e-3;
  if (effect == "sensor_lag") return 1e-4;
  return 1e-9;
}

class WriteBack : public ::testing::TestWithParam<armcmc::test::HiddenEffect> {
 protected:
  WriteBack()
      : bench_(Measure({GetParam()}, 3000, kNoise, 3).recording),
        fitter_(*bench_.equation, bench_.signals, White(kNoise)) {}
  [[nodiscard]] Fitted Fit(const When& when) const {
    return fitter_.Add(bench_.Base(fitter_), {&bench_.Form(GetParam().name), when});
  }
  Bench bench_;
  Fitter fitter_;
};

TEST_P(WriteBack, TheEstimatorPredictsWhatTheWorkflowPredicts) {
  for (const When& when : {When{}, When{When::Kind::kFrom, 0.8}, When{When::Kind::kContact, 0.0}}) {
    const Fitted fit = Fit(when);
    const EstimatorSettings settings = AugmentedSettings("hunt_crossley", fitter_, fit, kNoise);
    ASSERT_EQ(settings.num_effects, 1);
    EXPECT_EQ(settings.effects[0].name, GetParam().name);
    Vector difference = EstimatorSays(settings, bench_.signals) - fit.predicted;
    if (GetParam().name == "inertia") difference[0] = 0.0;
    const double largest = difference.cwiseAbs().maxCoeff() / fit.predicted.cwiseAbs().maxCoeff();
    EXPECT_LT(largest, Tolerance(GetParam().name)) << TermText(fit.hypothesis.terms[0]);
  }
}

INSTANTIATE_TEST_SUITE_P(Catalogue, WriteBack, ::testing::ValuesIn(armcmc::test::Catalogue()),
                         [](const auto& at) { return at.param.name; });

TEST(AugmentedSettings, TwoEffectsAndTheirGatesAreWritten) {
  const Bench bench(Measure({Hidden("force_bias"), Hidden("sensor_lag")}, 3000, kNoise, 3).recording);
  const Fitter fitter(*bench.equation, bench.signals, White(kNoise));
  const Fitted first = fitter.Add(bench.Base(fitter), {&bench.Form("sensor_lag"), {}});
  const Fitted both = fitter.Add(first, {&bench.Form("force_bias"), {When::Kind::kUntil, 2.5}});
  const EstimatorSettings settings = AugmentedSettings("hunt_crossley", fitter, both, kNoise);
  ASSERT_EQ(settings.num_effects, 2);
  EXPECT_EQ(settings.effects[1].gate, EffectGate::kUntil);
  EXPECT_EQ(settings.effects[1].until_s, 2.5);
  for (const NoiseSettings& noise : settings.noise) EXPECT_EQ(noise.std, kNoise);
  const Vector difference = EstimatorSays(settings, bench.signals) - both.predicted;
  EXPECT_LT(difference.cwiseAbs().maxCoeff(), 1e-4 * both.predicted.cwiseAbs().maxCoeff());
}

// Physics: what happens in the contact happens at the surface, wherever that is.
TEST(AugmentedSettings, DepthCountsFromTheSurface) {
  for (const char* name : {"adhesion", "stress_relaxation"}) {
    const armcmc::test::HiddenEffect truth = Hidden(name), offset = Hidden("contact_offset");
    const armcmc::gap::test::Made made = Measure({truth, offset}, 3000, kNoise, 3);
    const Bench bench(made.recording);
    const Fitter fitter(*bench.equation, bench.signals, White(kNoise));
    const Fitted first = fitter.Add(bench.Base(fitter), {&bench.Form("contact_offset"), {}});
    const Fitted both = fitter.Add(first, {&bench.Form(name), {}});
    const EstimatorSettings settings = AugmentedSettings("hunt_crossley", fitter, both, kNoise);
    const Vector difference = EstimatorSays(settings, bench.signals) - both.predicted;
    EXPECT_LT(difference.cwiseAbs().maxCoeff(), Tolerance(name) * both.predicted.cwiseAbs().maxCoeff()) << name;
    // A surface that is not where the recording has its zero takes nothing from either effect.
    const ParameterSettings& distance = settings.effects[0].amplitudes[0];
    const ParameterSettings& amplitude = settings.effects[1].amplitudes[0];
    EXPECT_NEAR(distance.mean, offset.amplitude[0], 4.0 * distance.sd) << name;
    EXPECT_NEAR(amplitude.mean, truth.amplitude[0], 4.0 * amplitude.sd) << name;
    EXPECT_LT((both.predicted - made.clean).norm(), 0.15 * kNoise * std::sqrt(3000.0)) << name;
  }
}

TEST(AugmentedSettings, AFormulaThatTheEstimatorDoesNotKnowIsRefused) {
  const Bench bench(Measure({}, 1500, kNoise, 3).recording);
  const Fitter fitter(*bench.equation, bench.signals, White(kNoise));
  for (const EffectForm& form : bench.catalogue) {
    if (form.exact()) continue;
    const Vector start = Vector::Ones(3 + form.size());  // where it is, whatever that fits
    EXPECT_THROW(
        (void)AugmentedSettings("hunt_crossley", fitter, fitter.Fit({{{&form, {}}}}, start, /*max_steps=*/0), kNoise),
        std::invalid_argument)
        << form.effect << form.variant;
  }
}

// A speed sensor as noisy as its signal asks for more smoothing of a mass than the estimator allows.
TEST(AugmentedSettings, AreValidWhateverTheNoise) {
  for (const double speed_noise : {1e-3, 0.1, 3.0}) {
    Recording recording = Measure({Hidden("inertia")}, 3000, 1e-6, 3).recording;
    recording.columns[2] += speed_noise * test::Noise(3000, 9);
    const Bench bench(recording);
    const Fitter fitter(*bench.equation, bench.signals, White(1e-6));
    const Fitted fit = fitter.Add(bench.Base(fitter), {&bench.Form("inertia"), {}});
    EXPECT_NO_THROW((void)AugmentedSettings("hunt_crossley", fitter, fit, 1e-6)) << speed_noise;
  }
}

}  // namespace
}  // namespace armcmc::gap::model_writer_test
