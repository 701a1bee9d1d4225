// The gap watch over the plants with states that come along, moved by the independent simulation.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "armcmc/adjust_result.hpp"
#include "armcmc/estimator.hpp"
#include "armcmc/gap_watch/gap_watch.hpp"
#include "armcmc/models/registry.hpp"
#include "armcmc/plant_sim/described_simulation.hpp"
#include "armcmc/support/plant_file.hpp"
#include "described_files.hpp"
#include "simd/kernels.hpp"
#include "support/paths.hpp"

namespace armcmc::state_watch_power_test {
namespace {

using plant_sim::DescribedScenario;
using plant_sim::HiddenTerm;

constexpr int kPackSamples = 100;
constexpr int kPacksOfBlock = 2 * kGapBlockPacks;

/// A plant that is excited at its own pace, so that a pack is about as long as it takes to answer.
struct Case {
  std::string plant;
  double rate_hz;
  std::string input;  ///< Signal that moves: a multisine.
  double amplitude, offset, bandwidth_hz;
  double wrong;  ///< Relative error of the parameters that the watch is given.
  std::vector<std::pair<std::string, std::string>> missing;  ///< State, term of its rate: gap ratio R of about 1.
};

std::vector<Case> Cases() {
  return {{"oscillator", 610.0, "u", 0.3, 0.0, 150.0, 0.003, {{"speed", "-0.0076*pos^3/5e-6"}}},
          {"pendulum",
           100.0,
           "u",
           1.0,
           0.0,
           2.0,
           0.02,
           {{"speed", "-0.33*sign(speed)"}, {"speed", "-0.5*speed*abs(speed)"}, {"speed", "-10*angle^3"}}},
          {"two_tanks",
           0.25,
           "u",
           0.8,
           3.0,
           0.02,
           0.02,
           {{"low", "-0.0033*max(low - 7, 0)"}, {"high", "-0.0073*max(high - 9, 0)"}, {"low", "-0.041*low"}}}};
}

class Source {
 public:
  Source(const Case& c, std::uint64_t seed, int packs, std::vector<HiddenTerm> hidden = {})
      : path_(test::SourceDir() / "core/plants" / c.plant / "plant.toml"),
        mine_(plant_sim::ReadDescribedPlant(support::StrictTable::FromFile(path_))),
        program_(std::make_shared<const PlantProgram>(std::make_shared<const Plant>(support::ReadPlant(path_)))),
        simulation_(mine_, Scenario(c, seed, packs, std::move(hidden))),
        random_(7919 * seed + 13) {
    pack_.run_id = 1;
    pack_.plant = PlantNumber::kDescribed;
    pack_.fingerprint = program_->plant().fingerprint();
    pack_.dt = 1.0 / c.rate_hz;
    pack_.num_inputs = program_->info().num_inputs;
    pack_.num_samples = kPackSamples;
  }

  /// @param colour  Correlation of the noise from sample to sample.
  const DataPack& Next(double colour = 0.0) {
    ++pack_.seq;
    const auto output = static_cast<std::size_t>(mine_.SignalAt(mine_.output));
    for (std::size_t n = 0; n < kPackSamples; ++n) {
      simulation_.Next();
      for (std::size_t s = 0, column = 0; s < mine_.signals.size(); ++s)
        if (s != output) pack_.u[n][column++] = simulation_.measured()[s];
      noise_ = colour * noise_ + std::sqrt(1.0 - colour * colour) * normal_(random_);
      pack_.y[n] = simulation_.measured()[output] + mine_.noise.std * noise_;
      pack_.t_last_s = simulation_.t();
    }
    return pack_;
  }

  [[nodiscard]] EstimatorSettings Settings() const {
    EstimatorSettings settings = DescribedSettings(program_);
    settings.sampler.rule = DrawRule::kFixed;
    settings.sampler.fixed_draws = settings.sampler.max_draws = 1000;
    return settings;
  }
  /// The truth, a little wrong.
  [[nodiscard]] GapReference Reference(double wrong) const {
    GapReference reference;
    reference.known[0] = true;
    reference.noise_std[0] = mine_.noise.std;
    for (std::size_t d = 0; d < mine_.parameters.size(); ++d) {
      const double value = mine_.parameters[d].usual * (d % 2 == 0 ? 1.0 + wrong : 1.0 - wrong);
      reference.theta[0][d] = program_->sampled()[d].prior == "lognormal" ? std::log(value) : value;
    }
    return reference;
  }

 private:
  static DescribedScenario Scenario(const Case& c, std::uint64_t seed, int packs, std::vector<HiddenTerm> hidden) {
    DescribedScenario scenario;
    scenario.dt = 1.0 / c.rate_hz;
    scenario.duration_s = packs * kPackSamples / c.rate_hz;
    scenario.seed = seed;
    scenario.noise = plant_sim::NoiseLaw{};  // is added here
    scenario.hidden = std::move(hidden);
    plant_sim::InputProgram& input = scenario.inputs[c.input];
    input.amplitude = c.amplitude;
    input.offset = c.offset;
    input.bandwidth_hz = c.bandwidth_hz;
    if (c.plant == "two_tanks") scenario.start = {{"high", 5.0}, {"low", 5.0}};
    return scenario;
  }

  std::filesystem::path path_;
  plant_sim::DescribedPlant mine_;
  std::shared_ptr<const PlantProgram> program_;
  plant_sim::DescribedSimulation simulation_;
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
  double noise_ = 0.0;
  DataPack pack_{};
};

/// The gap that the whole estimator sees after so many blocks, or at the alarm.
GapState Watch(Source* source, int blocks) {
  Estimator estimator(source->Settings());
  const auto result = estimator.MakeResult();
  const auto estimate = std::make_unique<Estimate>();
  for (int k = 0; k < (blocks + 1) * kPacksOfBlock && !estimate->gap.suspected; ++k) {
    (void)estimator.Adjust(source->Next(), 0, ClockRef{}, result.get());
    estimator.Execute(*result, estimate.get());
  }
  return estimate->gap;
}

TEST(StateWatchPower, BetsDoNotPayWhenNothingIsMissing) {
  // Without a tolerance the mean gain of a bet is at most 1.
  constexpr int kRuns = 10, kBlocks = 4;
  for (const Case& c : Cases())
    for (const double colour : {0.0, 0.8}) {
      std::array<double, kMaxGapChecks> gain{};
      int blocks = 0;
      for (std::uint64_t seed = 1; seed <= kRuns; ++seed) {
        Source source(c, seed, (kBlocks + 1) * kPacksOfBlock);
        EstimatorSettings settings = source.Settings();
        settings.gap_watch.tolerance = 0.0;
        GapWatch watch(settings, FindModel(settings.model), simd::Best(), settings.gap_watch.false_alarm_rate);
        const GapReference reference = source.Reference(c.wrong);
        std::int64_t seen = 0;
        for (int k = 0; k < (kBlocks + 1) * kPacksOfBlock; ++k) {
          watch.Step(source.Next(colour), reference, false);
          if (watch.state().num_blocks == seen) continue;
          seen = watch.state().num_blocks;
          ++blocks;
          for (std::size_t check = 0; check < kMaxGapChecks; ++check)
            for (const double sign : {1.0, -1.0}) {
              const CheckScore& score = watch.scores()[check];
              gain[check] += 0.5 * std::exp(sign * score.z - score.margin - 0.5);
            }
        }
      }
      ASSERT_EQ(blocks, kRuns * kBlocks);
      for (std::size_t check = 0; check < kMaxGapChecks; ++check)
        EXPECT_LT(gain[check] / blocks, 1.0 + 4.0 / std::sqrt(blocks)) << c.plant << ' ' << colour << ' ' << check;
    }
}

TEST(StateWatchPower, IsSilentWithoutAHiddenTerm) {
  for (const Case& c : Cases())
    for (std::uint64_t seed = 1; seed <= 2; ++seed) {
      Source source(c, seed, 4 * kPacksOfBlock);
      const GapState state = Watch(&source, 3);
      EXPECT_FALSE(state.suspected) << c.plant << ' ' << seed << ": " << state.where.view();
      EXPECT_EQ(state.num_blocks, 3);
    }
}

TEST(StateWatchPower, FindsATermOfTheSizeOfTheNoiseWithinThreeBlocks) {
  for (const Case& c : Cases())
    for (const auto& [state, term] : c.missing) {
      Source source(c, 1, 4 * kPacksOfBlock, {{HiddenTerm::Slot::kRate, state, term}});
      const GapState found = Watch(&source, 3);
      EXPECT_TRUE(found.suspected) << c.plant << ": " << term << ": log evidence " << found.log_evidence;
    }
}

}  // namespace
}  // namespace armcmc::state_watch_power_test
