#include <gtest/gtest.h>

#include <memory>

#include "armcmc/effects/composition.hpp"
#include "armcmc/models/registry.hpp"
#include "core/effects/contact_series.hpp"
#include "core/kernel_sets.hpp"
#include "plants/hunt_crossley/contact_pack.hpp"
#include "plants/hunt_crossley/effects.hpp"
#include "plants/hunt_crossley/model.hpp"

namespace armcmc::effect_prediction_test {
namespace {

using test::Catalogue;
using test::HiddenEffect;
using test::Series;

/// Predicts a recording pack by pack, with packs of different sizes.
class Predictor {
 public:
  explicit Predictor(const std::vector<HiddenEffect>& effects, const simd::Kernels& kernels)
      : Predictor(effects, kernels, test::WithEffects(effects)) {}
  Predictor(const std::vector<HiddenEffect>& effects, const simd::Kernels& kernels, const EstimatorSettings& settings)
      : composition_(settings), kernels_(kernels) {
    std::vector<double> theta{4.0, 2.3, 1.7};
    for (const HiddenEffect& e : effects) theta.insert(theta.end(), e.amplitude.begin(), e.amplitude.end());
    for (std::size_t d = 0; d < theta.size(); ++d) theta_.value[d].fill(theta[d]);
  }

  /// The whole recording, by one of the lanes.
  std::vector<double> Run(const Series& series) {
    constexpr std::size_t kLane = 5;
    static constexpr std::size_t kSizes[] = {100, 1, 37, 256, 100, 2};
    std::vector<double> out;
    std::int64_t seq = 1;
    for (std::size_t first = 0; first < series.size();) {
      const std::size_t count = std::min(kSizes[static_cast<std::size_t>(seq) % 6], series.size() - first);
      const DataPack pack = series.Pack(seq++, first, count);
      EXPECT_TRUE(composition_.Prepare(pack, pack_.get()));
      composition_.Fill(pack, *pack_, 0, data_.get());
      kernels_.predict(FindModel("hunt_crossley"), *data_, theta_, tile_.get());
      kernels_.predict_half(FindModel("hunt_crossley"), *data_, theta_, half_.get());
      for (std::size_t n = 0; n < count; ++n) {
        out.push_back(tile_->value[n][kLane]);
        EXPECT_EQ(half_->value[n][0], out.back()) << "half a tile, " << kernels_.name;
        EXPECT_EQ(half_->value[n][kTileLanes / 2 - 1], out.back()) << "half a tile, " << kernels_.name;
      }
      first += count;
    }
    return out;
  }

 private:
  Composition composition_;
  const simd::Kernels& kernels_;
  ThetaTile theta_{};
  std::unique_ptr<EffectPack> pack_ = std::make_unique<EffectPack>(composition_.MakePack());
  std::unique_ptr<ModeData> data_ = std::make_unique<ModeData>();
  std::unique_ptr<PredictionTile> tile_ = std::make_unique<PredictionTile>();
  std::unique_ptr<PredictionTile> half_ = std::make_unique<PredictionTile>();
};

/// Of the first additive effect.
double FeatureAt(const EffectPack& pack, std::size_t n) {
  return static_cast<const ContactPack&>(*pack.compiled).feature[0][n];
}

void ExpectEqualsReference(const std::vector<HiddenEffect>& effects, const std::string& what) {
  Series series(2000);
  test::Simulate(effects, &series);
  for (const simd::Kernels* kernels : test::RunnableKernels()) {
    Predictor predictor(effects, *kernels);
    const std::vector<double> predicted = predictor.Run(series);
    ASSERT_EQ(predicted.size(), series.size());
    double worst = 0.0;
    for (std::size_t n = 0; n < series.size(); ++n) worst = std::fmax(worst, std::fabs(predicted[n] - series.f[n]));
    // Reference filters are integrated in small steps (error 1e-6), the low pass starts from its history.
    EXPECT_LT(worst, 3e-5) << what << " on " << kernels->name;
  }
}

TEST(EffectPrediction, EveryEffectOfTheCatalogueEqualsTheReference) {
  ASSERT_EQ(Catalogue().size(), static_cast<std::size_t>(ContactEffects::kSize)) << "an effect without a reference";
  for (const HiddenEffect& e : Catalogue()) ExpectEqualsReference({e}, e.name);
}

TEST(EffectPrediction, GatesOpenWhereTheyShould) {
  for (HiddenEffect e : Catalogue())
    for (const EffectGate gate : {EffectGate::kContact, EffectGate::kFree, EffectGate::kFrom, EffectGate::kUntil}) {
      e.gate = gate;
      e.from_s = e.until_s = 0.7505;
      ExpectEqualsReference({e}, e.name + " gate " + std::to_string(static_cast<int>(gate)));
    }
}

TEST(EffectPrediction, SlotsComposeInTheFixedOrder) {
  const auto all = Catalogue();
  const auto named = [&](const char* name) {
    for (const auto& e : all)
      if (e.name == name) return e;
    return HiddenEffect{};
  };
  const std::vector<HiddenEffect> sensed{named("sensor_saturation"), named("sensor_lag"), named("coulomb_friction"),
                                         named("sensor_delay"), named("contact_offset")};
  ExpectEqualsReference(sensed, "five slots, named in reverse");
  ExpectEqualsReference({named("stiffness_drift"), named("stress_relaxation"), named("force_bias")}, "law and added");
  ExpectEqualsReference({named("inertia"), named("adhesion"), named("viscous_friction"), named("periodic_disturbance")},
                        "five amplitudes");
}

TEST(EffectPrediction, DepthCountsFromTheSurface) {
  const auto named = [](const char* name, EffectGate gate) {
    for (HiddenEffect e : Catalogue())
      if (e.name == name) {
        e.gate = gate;
        e.from_s = e.until_s = 0.7505;
        return e;
      }
    return HiddenEffect{};
  };
  for (const EffectGate gate : {EffectGate::kAlways, EffectGate::kFrom, EffectGate::kUntil})
    for (const char* other : {"adhesion", "stress_relaxation"}) {
      const HiddenEffect offset = named("contact_offset", gate), effect = named(other, EffectGate::kAlways);
      ExpectEqualsReference({offset, effect}, std::string(other) + " after the offset");
      ExpectEqualsReference({effect, offset}, std::string(other) + " before the offset");
    }
}

// A uniform prior has bounds only; its mean is in the middle.
TEST(EffectPrediction, DepthCountsFromTheMiddleOfAUniformPrior) {
  const std::vector<HiddenEffect> effects{{"contact_offset", {0.12}, {}}, {"adhesion", {0.8}, {0.15}}};
  Series series(1000);
  test::Simulate(effects, &series);
  EstimatorSettings settings = test::WithEffects(effects);
  settings.effects[0].amplitudes[0] = {"distance", PriorKind::kUniform, 0.0, 1.0, 0.0, 0.24};
  const std::vector<double> predicted = Predictor(effects, simd::Best(), settings).Run(series);
  for (std::size_t n = 0; n < series.size(); ++n) ASSERT_NEAR(predicted[n], series.f[n], 3e-5) << n;
}

TEST(EffectPrediction, InstructionSetsAgree) {
  for (const HiddenEffect& e : Catalogue()) {
    Series series(700);
    const auto sets = test::RunnableKernels();
    std::vector<double> first = Predictor({e}, *sets.front()).Run(series);
    for (const simd::Kernels* kernels : sets) {
      const std::vector<double> other = Predictor({e}, *kernels).Run(series);
      for (std::size_t n = 0; n < first.size(); ++n)
        ASSERT_NEAR(other[n], first[n], 1e-10 * (1.0 + std::fabs(first[n]))) << e.name << " " << kernels->name;
    }
  }
}

TEST(EffectPrediction, AnEffectOfSizeZeroIsTheBaseModelToTheBit) {
  for (const HiddenEffect& e : {HiddenEffect{"force_bias", {0.0}, {}}, HiddenEffect{"sensor_delay", {0.0}, {}},
                                HiddenEffect{"stiffness_drift", {0.0}, {0.0}}}) {
    const Series series(1000);
    auto data = std::make_unique<ModeData>();
    auto theta = std::make_unique<ThetaTile>();
    auto tile = std::make_unique<PredictionTile>();
    const double truth[] = {4.0, 2.3, 1.7};
    for (std::size_t d = 0; d < 3; ++d) theta->value[d].fill(truth[d]);
    for (const simd::Kernels* kernels : test::RunnableKernels()) {
      const std::vector<double> composed = Predictor({e}, *kernels).Run(series);
      for (std::size_t first = 0; first < series.size(); first += 100) {
        HuntCrossley::Prepare(series.Pack(1, first, 100), PlantConstants{}, 0, data.get());
        kernels->predict(FindModel("hunt_crossley"), *data, *theta, tile.get());
        std::size_t m = 0;
        for (std::size_t n = first; n < first + 100; ++n) {
          if (series.x[n] < 0.0) continue;
          ASSERT_EQ(composed[n], tile->value[m++][0]) << e.name << " " << kernels->name;
        }
      }
    }
  }
}

TEST(EffectPrediction, AGapStartsTheMemoryAnew) {
  const HiddenEffect relaxation{"stress_relaxation", {2.0}, {0.2}};
  Series series(400);
  Composition composition(test::WithEffects({relaxation})), fresh(test::WithEffects({relaxation}));
  auto pack = std::make_unique<EffectPack>(composition.MakePack()),
       other = std::make_unique<EffectPack>(fresh.MakePack());
  ASSERT_TRUE(composition.Prepare(series.Pack(1, 0, 100), pack.get()));
  ASSERT_TRUE(composition.Prepare(series.Pack(3, 200, 100), pack.get())) << "pack 2 is lost";
  ASSERT_TRUE(fresh.Prepare(series.Pack(3, 200, 100), other.get()));
  for (std::size_t n = 0; n < 100; ++n) ASSERT_EQ(FeatureAt(*pack, n), FeatureAt(*other, n));
}

TEST(EffectPrediction, APackThatOverflowsIsRefusedAndForgotten) {
  const HiddenEffect inertia{"inertia", {0.3}, {0.0}};
  Series series(400);
  Composition composition(test::WithEffects({inertia})), fresh(test::WithEffects({inertia}));
  auto pack = std::make_unique<EffectPack>(composition.MakePack()),
       other = std::make_unique<EffectPack>(fresh.MakePack());
  ASSERT_TRUE(composition.Prepare(series.Pack(1, 0, 100), pack.get()));
  ASSERT_TRUE(fresh.Prepare(series.Pack(1, 0, 100), other.get()));
  DataPack broken = series.Pack(2, 100, 100);
  broken.u[50][1] = 1e308;
  ASSERT_FALSE(composition.Prepare(broken, pack.get()));
  ASSERT_TRUE(composition.Prepare(series.Pack(2, 100, 100), pack.get()));
  ASSERT_TRUE(fresh.Prepare(series.Pack(2, 100, 100), other.get()));
  for (std::size_t n = 0; n < 100; ++n) ASSERT_EQ(FeatureAt(*pack, n), FeatureAt(*other, n));
}

}  // namespace
}  // namespace armcmc::effect_prediction_test
