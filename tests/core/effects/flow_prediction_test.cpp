// The valve flow with effects as the scoring kernels predict it, against a simulation in plain scalar code.

#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "armcmc/effects/composition.hpp"
#include "armcmc/models/registry.hpp"
#include "core/effects/valve_series.hpp"
#include "core/kernel_sets.hpp"
#include "simd/kernels.hpp"

namespace armcmc::flow_prediction_test {
namespace {

using test::FlowCase;
using test::FlowCases;
using test::Measured;
using test::ValveSeries;
using test::WithFlowEffects;

/// Composition and kernel at the true parameters of a series.
class Predictor {
 public:
  Predictor(const EstimatorSettings& settings, const std::vector<FlowCase>& cases) : composition_(settings) {
    for (std::size_t e = 0; e < cases.size(); ++e) amplitude_.push_back(cases[e].truth);
  }

  bool Prepare(const DataPack& pack) { return composition_.Prepare(pack, effects_.get()); }

  /// Pressure rates of the samples that belong to a mode; `sample` says which those are.
  std::vector<double> Rates(const simd::Kernels& kernels, const DataPack& pack, const ValveSeries& truth, int mode,
                            std::vector<int>* sample) {
    composition_.Fill(pack, *effects_, mode, data_.get());
    const auto m = static_cast<std::size_t>(mode);
    theta_->value[0].fill(truth.g[m]);
    theta_->value[1].fill(truth.theta2[m]);
    for (std::size_t e = 0; e < amplitude_.size(); ++e) theta_->value[2 + e].fill(amplitude_[e]);
    kernels.predict(FindModel("soft_actuator"), *data_, *theta_, tile_.get());
    kernels.predict_half(FindModel("soft_actuator"), *data_, *theta_, half_.get());
    std::vector<double> rates;
    sample->clear();
    for (std::size_t k = 0; k < static_cast<std::size_t>(data_->num_samples); ++k) {
      sample->push_back(data_->sample[k]);
      rates.push_back(tile_->value[k][k % kTileLanes]);
      EXPECT_EQ(half_->value[k][k % (kTileLanes / 2)], rates.back()) << "half a tile, " << kernels.name;
    }
    return rates;
  }

 private:
  Composition composition_;
  std::vector<double> amplitude_;
  std::unique_ptr<EffectPack> effects_ = std::make_unique<EffectPack>(composition_.MakePack());
  std::unique_ptr<ModeData> data_ = std::make_unique<ModeData>();
  std::unique_ptr<ThetaTile> theta_ = std::make_unique<ThetaTile>();
  std::unique_ptr<PredictionTile> tile_ = std::make_unique<PredictionTile>();
  std::unique_ptr<PredictionTile> half_ = std::make_unique<PredictionTile>();
};

/// Largest error over a recording, as a share of the largest rate; `compared` counts samples.
double LargestError(const simd::Kernels& kernels, const EstimatorSettings& settings, const std::vector<FlowCase>& cases,
                    const ValveSeries& series, int* compared) {
  Predictor predictor(settings, cases);
  double largest = 0.0, error = 0.0;
  *compared = 0;
  for (const double rate : series.clean_pdot) largest = std::fmax(largest, std::fabs(rate));
  std::vector<int> sample;
  std::size_t first = 0;
  for (const DataPack& pack : series.Packs()) {
    EXPECT_TRUE(predictor.Prepare(pack));
    for (int mode = 0; mode < 2; ++mode) {
      const std::vector<double> rates = predictor.Rates(kernels, pack, series, mode, &sample);
      for (std::size_t k = 0; k < rates.size(); ++k, ++*compared)
        error = std::fmax(error, std::fabs(rates[k] - series.clean_pdot[first + static_cast<std::size_t>(sample[k])]));
    }
    first += 100;
  }
  return error / largest;
}

TEST(FlowPrediction, EveryEffectIsTheTextbooksInEveryInstructionSet) {
  for (const FlowCase& one : FlowCases()) {
    const ValveSeries series = Measured({one}, 4000);
    for (const simd::Kernels* kernels : test::RunnableKernels()) {
      int compared = 0;
      EXPECT_LT(LargestError(*kernels, WithFlowEffects({one}), {one}, series, &compared), 1e-9)
          << one.name << " on " << kernels->name;
      EXPECT_GT(compared, one.name == "valve_lag" ? 1000 : 3900) << one.name;
    }
  }
}

TEST(FlowPrediction, EffectsActInTheOrderOfTheirSlots) {
  const ValveSeries series = Measured(FlowCases(), 4000);
  int compared = 0;
  EXPECT_LT(LargestError(simd::Best(), WithFlowEffects(FlowCases()), FlowCases(), series, &compared), 1e-9);
  EXPECT_GT(compared, 1000);
}

TEST(FlowPrediction, AnEffectBeginsWithItsGate) {
  for (const FlowCase& one : FlowCases()) {
    ValveSeries series;
    series.*one.value = one.truth;
    series.from_s = 1.2345;
    series.Simulate(4000);
    EstimatorSettings settings = WithFlowEffects({one});
    settings.effects[0].gate = EffectGate::kFrom;
    settings.effects[0].from_s = 1.2345;
    int compared = 0;
    EXPECT_LT(LargestError(simd::Best(), settings, {one}, series, &compared), 1e-9) << one.name;
    EXPECT_GT(compared, 1000);
    settings.effects[0].from_s = 2.2345;
    EXPECT_GT(LargestError(simd::Best(), settings, {one}, series, &compared), 1e-5) << one.name;
  }
}

TEST(FlowPrediction, InstructionSetsThatFuseGiveTheSameBits) {
  const auto sets = test::FusedKernels();
  if (sets.size() < 2) GTEST_SKIP() << "one such instruction set only";
  const ValveSeries series = Measured(FlowCases(), 500);
  Predictor predictor(WithFlowEffects(FlowCases()), FlowCases());
  std::vector<int> sample;
  for (const DataPack& pack : series.Packs()) {
    ASSERT_TRUE(predictor.Prepare(pack));
    EXPECT_EQ(predictor.Rates(*sets[0], pack, series, 0, &sample), predictor.Rates(*sets[1], pack, series, 0, &sample));
  }
}

TEST(FlowPrediction, ASlowValveIsFollowedFromPackToPack) {
  FlowCase slow = FlowCases()[1];
  slow.truth = 0.03;
  EstimatorSettings settings = WithFlowEffects({slow});
  settings.effects[0].amplitudes[0].mean = 0.029;  // the typical one, from which the memory before 256 samples is made
  settings.effects[0].amplitudes[0].upper = 0.06;
  int compared = 0;
  EXPECT_LT(LargestError(simd::Best(), settings, {slow}, Measured({slow}, 4000), &compared), 1e-4);
  EXPECT_GT(compared, 2000);
}

// Behind a slow valve the other one may still be open, and after a lost pack nobody knows how far.
TEST(FlowPrediction, SamplesOfWhichTheValveIsNotSureAreLeftOut) {
  const FlowCase lag = FlowCases()[1];
  EstimatorSettings settings = WithFlowEffects({lag});
  settings.effects[0].amplitudes[0].upper = 0.01;
  const ValveSeries series = Measured({lag}, 2000);
  const std::vector<DataPack> packs = series.Packs();
  Predictor predictor(settings, {lag});
  std::vector<int> sample;
  const auto used = [&](const DataPack& pack) {
    EXPECT_TRUE(predictor.Prepare(pack));
    std::size_t count = 0;
    for (int mode = 0; mode < 2; ++mode) {
      (void)predictor.Rates(simd::Best(), pack, series, mode, &sample);
      count += sample.size();
      for (const int n : sample)
        EXPECT_GT(series.opening[static_cast<std::size_t>((pack.seq - 1) * 100 + n)] * (mode == 0 ? 1.0 : -1.0), 0.0);
    }
    return count;
  };
  EXPECT_EQ(used(packs[0]), 60u) << "four of the longest time constants after the start";
  EXPECT_EQ(used(packs[1]), 100u);
  const std::size_t switched = used(packs[2]);  // fill to vent after 250 samples
  EXPECT_LT(switched, 100u);
  EXPECT_GT(switched, 85u);
  EXPECT_EQ(used(packs[4]), 60u) << "pack 4 is lost";
}

}  // namespace
}  // namespace armcmc::flow_prediction_test
