#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "armcmc/adjust_result.hpp"
#include "armcmc/drift.hpp"
#include "armcmc/estimator.hpp"
#include "armcmc/parameter_space.hpp"
#include "support/packs.hpp"

namespace armcmc::sbc_test {
namespace {

using test::Motion;
using test::Normal;

constexpr int kBins = 20;
constexpr int kRanks = 199;  // thinned draws; ranks 0..199 fill 20 bins of 10

/// Truth drawn from the truncated normal prior by rejection.
std::array<double, 3> DrawTruth(const EstimatorSettings& s, Normal* normal) {
  std::array<double, 3> theta{};
  for (std::size_t d = 0; d < 3; ++d) {
    const ParameterSettings& p = s.parameters[d];
    do theta[d] = p.mean + p.sd * (*normal)();
    while (theta[d] < p.lower || theta[d] > p.upper);
  }
  return theta;
}

/// What the three-part prior says of a pack's parameters: they stay, drift or change.
class Truth {
 public:
  Truth(const EstimatorSettings& settings, const ParameterSpace& space, Normal* normal)
      : settings_(settings), space_(space), normal_(normal) {
    Draw();
    Begin();
  }
  [[nodiscard]] const std::array<double, 3>& theta() const { return theta_; }

  /// Between two packs: what changes, begins or ends.
  void Switch(double elapsed_s) {
    if (normal_->Uniform() > settings_.forgetting.lambda_max) Draw();
    if (normal_->Uniform() > std::exp(-Drift::kSwitching * elapsed_s)) Begin();
  }
  /// From one sample to the next: a small step of the speed's own process, within bounds.
  void Step(double elapsed_s) {
    if (law_.rate == 0.0) return;
    for (std::size_t d = 0; d < 3; ++d) {
      const double kept = std::exp(-elapsed_s / law_.persistence);
      theta_[d] += elapsed_s * speed_[d] * space_.scale[d];
      theta_[d] = std::clamp(theta_[d], settings_.parameters[d].lower, settings_.parameters[d].upper);
      if (law_.Moves(static_cast<Eigen::Index>(d)))
        speed_[d] = kept * speed_[d] + law_.rate * std::sqrt(1.0 - kept * kept) * (*normal_)();
    }
  }

 private:
  void Draw() { theta_ = DrawTruth(settings_, normal_); }
  void Begin() {
    const double share = settings_.forgetting.drift_share;
    double left = normal_->Uniform();
    int h = 0;
    while (h + 1 < Drift::NumHypotheses(3) && left > Drift::Of(h, share, 3).prior)
      left -= Drift::Of(h++, share, 3).prior;
    law_ = Drift::Of(h, share, 3);
    Turn();
  }
  void Turn() {
    for (std::size_t d = 0; d < 3; ++d)
      speed_[d] = law_.Moves(static_cast<Eigen::Index>(d)) ? law_.rate * (*normal_)() : 0.0;
  }

  const EstimatorSettings& settings_;
  const ParameterSpace& space_;
  Normal* normal_;
  std::array<double, 3> theta_{}, speed_{};
  Drift::Hypothesis law_;
};

using Histogram = std::array<std::array<int, kBins>, 3>;

/// Rank histograms of simulation-based calibration (Talts et al. 2018) over `simulations` sequences of `packs` packs.
/// @param moves  The prior that parameters move by, from sample to sample after the first pack; null: they stay.
Histogram RankHistograms(EstimatorSettings settings, int simulations, int packs, std::uint64_t seed,
                         const EstimatorSettings* moves = nullptr) {
  Histogram histogram{};
  Normal normal(seed);
  settings.sampler.seed = seed;
  Estimator estimator(settings);  // one for all: it takes longer to make than a pack
  const auto result = estimator.MakeResult();
  const ParameterSpace space(settings, settings.noise[0]);
  for (int sim = 0; sim < simulations; ++sim) {
    estimator.Reset();
    std::array<double, 3> theta{};
    std::optional<Truth> truth;
    if (moves != nullptr) {
      theta = truth.emplace(*moves, space, &normal).theta();
    } else {
      theta = DrawTruth(settings, &normal);
    }
    const Motion motion{0.6 + 0.6 * normal.Uniform(), 0.1 + 0.4 * normal.Uniform(), 1.0 + 6.0 * normal.Uniform(),
                        6.28 * normal.Uniform()};
    for (int k = 1; k <= packs; ++k) {  // pack numbers select the random numbers: every pack has its own
      const bool drifts = truth && k > 1;
      if (drifts) truth->Switch(test::kPackSamples * test::kSampleInterval);
      const DataPack pack = test::FillContactPack(
          sim * packs + k, [&](double t) { return motion.At(t); },
          [&](double, const test::Place& at) {
            if (drifts) truth->Step(test::kSampleInterval);
            if (truth) theta = truth->theta();
            return test::ContactTruth{theta[0], theta[1], theta[2]}.Force(at.x, at.v) +
                   settings.noise[0].std * normal();
          });
      estimator.Adjust(pack, 0, {}, result.get());
    }
    const ModeDraws& draws = result->modes[0];
    const int first = draws.burn_in;
    for (std::size_t d = 0; d < 3; ++d) {
      int rank = 0;
      for (int i = 0; i < kRanks; ++i) {
        const int at = first + static_cast<int>((static_cast<long>(draws.draws - first) * i) / kRanks);
        const int dim = static_cast<int>(d);
        if (space.Theta(dim, draws.AtEnd(dim, draws.chain[at])) < theta[d]) ++rank;
      }
      ++histogram[d][static_cast<std::size_t>(rank * kBins / (kRanks + 1))];
    }
  }
  return histogram;
}

double ChiSquare(const std::array<int, kBins>& counts) {
  double total = 0.0;
  for (const int c : counts) total += c;
  double chi2 = 0.0;
  for (const int c : counts) chi2 += (c - total / kBins) * (c - total / kBins) / (total / kBins);
  return chi2;
}

// Quantiles of chi-square with 19 degrees of freedom (R 4.2 qchisq): 1 - 1e-4 / 3 and 1 - 1e-9.
constexpr double kPass = 52.5;
constexpr double kFail = 83.9;

TEST(SimulationBasedCalibration, RanksOfSinglePacksAreUniform) {
  const Histogram h = RankHistograms(BuiltinSettings("hunt_crossley"), 1000, 1, 11);
  for (const auto& counts : h) EXPECT_LT(ChiSquare(counts), kPass);
}

TEST(SimulationBasedCalibration, RanksAfterThreePacksOfTheRecursionAreUniform) {
  const Histogram h = RankHistograms(BuiltinSettings("hunt_crossley"), 400, 3, 12);
  for (const auto& counts : h) EXPECT_LT(ChiSquare(counts), kPass);
}

TEST(LongSimulationBasedCalibration, RanksAfterFivePacksOfTheRecursionAreUniform) {
  const Histogram h = RankHistograms(BuiltinSettings("hunt_crossley"), 2000, 5, 12);
  for (const auto& counts : h) EXPECT_LT(ChiSquare(counts), kPass);
}

/// The decision whether a change is tried looks at the data; without it the prior of every pack is the same mixture.
EstimatorSettings ThreeParts() {
  EstimatorSettings s = BuiltinSettings("hunt_crossley");
  s.forgetting.drift_share = 0.5;
  s.forgetting.lambda_max = 0.97;
  s.forgetting.mu = s.forgetting.threshold = 1e6;
  return s;
}

TEST(SimulationBasedCalibration, RanksOfParametersThatStayDriftAndChangeAreUniform) {
  const EstimatorSettings settings = ThreeParts();
  const Histogram h = RankHistograms(settings, 300, 6, 13, &settings);
  for (const auto& counts : h) EXPECT_LT(ChiSquare(counts), kPass);
}

TEST(LongSimulationBasedCalibration, RanksOfParametersThatStayDriftAndChangeAreUniform) {
  const EstimatorSettings settings = ThreeParts();
  const Histogram h = RankHistograms(settings, 2000, 20, 14, &settings);
  for (const auto& counts : h) EXPECT_LT(ChiSquare(counts), kPass);
}

TEST(SimulationBasedCalibration, FailsWhenDriftIsSwitchedOff) {
  const EstimatorSettings moves = ThreeParts();
  EstimatorSettings broken = moves;
  broken.forgetting.drift_share = 0.0;
  const Histogram h = RankHistograms(broken, 300, 6, 13, &moves);
  double worst = 0.0;
  for (const auto& counts : h) worst = std::fmax(worst, ChiSquare(counts));
  EXPECT_GT(worst, kFail);
}

TEST(SimulationBasedCalibration, FailsWhenTheProposalRatioIsDropped) {
  EstimatorSettings broken = BuiltinSettings("hunt_crossley");
  broken.sampler.use_proposal_ratio = false;
  const Histogram h = RankHistograms(broken, 600, 1, 11);
  double worst = 0.0;
  for (const auto& counts : h) worst = std::fmax(worst, ChiSquare(counts));
  EXPECT_GT(worst, kFail);
}

}  // namespace
}  // namespace armcmc::sbc_test
