#include "armcmc/calibrate/calibrate.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "armcmc/noise_model.hpp"
#include "armcmc/replay/replay.hpp"
#include "armcmc/support/csv.hpp"
#include "armcmc/support/program.hpp"
#include "model_errors.hpp"

namespace armcmc::calibrate {
namespace {

constexpr int kMaxNoiseRuns = 5;
constexpr int kMaxThresholdRuns = 5;
constexpr double kStandsStill = 0.005;    // relative change of the scale
constexpr std::size_t kSettlePacks = 10;  // of a mode, before its estimates are worth measuring errors with
constexpr double kNever = 1e4;            // noise scales; beyond any score, small enough to be subtracted again
constexpr int kDraws = 3'000;             // in the runs that only need the mean
constexpr std::array kRhos = {0.0, 0.002, 0.005, 0.01, 0.02, 0.05};
constexpr double kRounding = 1e-9;  // of the target: errors below it are no noise
constexpr std::size_t kPlotErrors = 20'000;

/// What one run of the estimator leaves.
struct Run {
  std::array<PackErrors, kMaxModes> fitted;       ///< Errors under the estimate after the pack.
  std::array<double, kMaxModes> target_square{};  ///< Largest mean square of the target of a pack.
  std::vector<std::pair<double, double>> ahead;   ///< Of every pack: sum of log densities before it, and samples.
  std::vector<ThresholdSample> scores;
};

/// Runs the estimator over the recording, with as many draws as means and mismatches need.
class Runner {
 public:
  Runner(const CalibrationRequest& request, int expected_runs) : request_(request), expected_runs_(expected_runs) {}

  Run operator()(EstimatorSettings settings) {
    settings.gap_watch.enabled = false;
    const bool fixed = settings.sampler.rule == DrawRule::kFixed;
    const int asked = fixed ? settings.sampler.fixed_draws : settings.sampler.max_draws;
    settings.sampler.rule = DrawRule::kFixed;
    settings.sampler.fixed_draws = std::min(kDraws, asked);
    Estimator estimator(settings);
    const auto source = request_.open();
    Run run;
    ModelErrors errors(settings);
    std::vector<NoiseModel> laws;
    for (int m = 0; m < estimator.num_modes(); ++m) laws.emplace_back(settings.noise[static_cast<std::size_t>(m)]);
    std::array<ModeEstimate, kMaxModes> before{};
    std::array<std::size_t, kMaxModes> informative{};
    std::vector<double> pack_errors;
    replay::Replay(source.get(), &estimator, [&](const replay::RecordedPack& recorded, const Estimate& e) {
      double ahead = 0.0, samples = 0.0;
      for (int m = 0; m < estimator.num_modes(); ++m) {
        const auto i = static_cast<std::size_t>(m);
        if (!e.modes[i].updated) continue;
        if (std::isfinite(e.modes[i].zeta))
          run.scores.push_back({e.t_last_s, ThresholdScore(settings.forgetting, e.modes[i], e.num_samples)});
        if (++informative[i] <= kSettlePacks) continue;
        const double square = Errors(&errors, recorded, e, e.modes, m, &pack_errors);
        run.target_square[i] = std::max(run.target_square[i], square);
        run.fitted[i].push_back(pack_errors);
        Errors(&errors, recorded, e, before, m, &pack_errors);
        for (const double error : pack_errors) ahead += laws[i].LogDensity(error, settings.noise[i].std);
        samples += static_cast<double>(pack_errors.size());
      }
      if (samples > 0.0) run.ahead.emplace_back(ahead, samples);
      before = e.modes;
      request_.on_progress((done_ + source->progress()) / expected_runs_);
    });
    done_ = std::min(done_ + 1, expected_runs_ - 1);
    return run;
  }

 private:
  /// Without effects from the model; with them from the prediction on display, which is the contact force.
  double Errors(ModelErrors* model, const replay::RecordedPack& recorded, const Estimate& e,
                const std::array<ModeEstimate, kMaxModes>& estimates, int mode, std::vector<double>* errors) const {
    if (request_.settings.num_effects == 0) return model->Of(recorded.pack, estimates, mode, errors);
    errors->clear();
    double square = 0.0;
    for (std::size_t n = 0; n < static_cast<std::size_t>(e.num_samples); ++n) {
      square += recorded.pack.y[n] * recorded.pack.y[n] / e.num_samples;
      if (std::isfinite(e.y_shown[n]))
        errors->push_back(recorded.pack.y[n] - e.y_shown[n] - request_.settings.noise[0].mean);
    }
    return square;
  }

  const CalibrationRequest& request_;
  int expected_runs_, done_ = 0;
};

std::vector<double> Flat(const PackErrors& errors, std::size_t most) {
  std::vector<double> all;
  for (const auto& pack : errors) all.insert(all.end(), pack.begin(), pack.end());
  const std::size_t step = all.size() / most + 1;
  std::vector<double> some;
  for (std::size_t i = 0; i < all.size(); i += step) some.push_back(all[i]);
  return some;
}

ModeNoise NoiseOf(const PackErrors& errors, double target_square, const NoiseSettings& start, std::string mode) {
  ModeNoise noise;
  noise.mode = std::move(mode);
  noise.packs = errors.size();
  for (const auto& pack : errors) noise.samples += pack.size();
  noise.errors = Flat(errors, kPlotErrors);
  double square = 0.0;
  for (const double e : noise.errors) square += e * e / static_cast<double>(noise.errors.size());
  if (noise.packs < kMinPacks) {
    noise.why_not = "only " + std::to_string(noise.packs) + " packs, expected at least " + std::to_string(kMinPacks);
  } else if (!(square > kRounding * kRounding * target_square)) {
    noise.why_not = "the recording holds no noise, the errors are those of rounding";
  }
  if (!noise.why_not.empty()) return noise;
  noise.calibrated = true;
  noise.laws = CompareLaws(errors, start);
  noise.chosen = SimplestGoodLaw(noise.laws);
  noise.correlation = Lag1Correlation(errors);
  return noise;
}

/// Law and scale of every mode, until they stand still.
void CalibrateNoise(Runner* run, Calibration* c) {
  const Estimator names(c->settings);
  for (c->noise_runs = 1; c->noise_runs <= kMaxNoiseRuns; ++c->noise_runs) {
    const Run result = (*run)(c->settings);
    bool still = true;
    c->noise.clear();
    for (int m = 0; m < names.num_modes(); ++m) {
      const auto i = static_cast<std::size_t>(m);
      NoiseSettings& noise = c->settings.noise[i];
      c->noise.push_back(NoiseOf(result.fitted[i], result.target_square[i], noise, std::string(names.mode_name(m))));
      const ModeNoise& found = c->noise.back();
      if (!found.calibrated) continue;
      const NoiseSettings& next = found.laws[found.chosen].noise;
      still = still && next.kind == noise.kind && std::fabs(next.std / noise.std - 1.0) < kStandsStill;
      noise = next;
    }
    if (still) break;
  }
  c->noise_runs = std::min(c->noise_runs, kMaxNoiseRuns);
  for (const ModeNoise& noise : c->noise) {
    if (!noise.calibrated) {
      c->notes.push_back("mode " + noise.mode + ": " + noise.why_not + "; its noise is unchanged");
    } else if (std::fabs(noise.correlation) > 0.2) {
      c->notes.push_back("mode " + noise.mode + ": successive errors are correlated (correlation " +
                         support::ExactNumber(std::round(100.0 * noise.correlation) / 100.0) +
                         "), which no noise law allows for; the posterior is too narrow");
    }
  }
}

void CalibrateRho(Runner* run, Calibration* c) {
  std::vector<std::vector<std::pair<double, double>>> ahead;
  for (const double rho : kRhos) {
    EstimatorSettings settings = c->settings;
    settings.forgetting.rho = rho;
    ahead.push_back((*run)(settings).ahead);
    double sum = 0.0, samples = 0.0;
    for (const auto& [value, count] : ahead.back()) sum += value, samples += count;
    c->rho.push_back({rho, samples > 0.0 ? sum / samples : -HUGE_VAL, 0.0, 0.0});
  }
  const auto best = static_cast<std::size_t>(
      std::max_element(c->rho.begin(), c->rho.end(),
                       [](const RhoScore& a, const RhoScore& b) { return a.ahead < b.ahead; }) -
      c->rho.begin());
  std::optional<double> chosen;
  for (std::size_t k = 0; k < c->rho.size(); ++k) {
    RhoScore& score = c->rho[k];
    score.behind = c->rho[best].ahead - score.ahead;
    double square = 0.0, samples = 0.0;
    // Packs of all runs are the same ones unless a run failed on one.
    for (std::size_t p = 0; p < std::min(ahead[k].size(), ahead[best].size()); ++p) {
      const double off = ahead[best][p].first - ahead[k][p].first - score.behind * ahead[k][p].second;
      square += off * off;
      samples += ahead[k][p].second;
    }
    score.behind_se = samples > 0.0 ? std::sqrt(square) / samples : 0.0;
    if (!chosen && score.behind <= 2.0 * score.behind_se) chosen = score.rho;
  }
  c->settings.forgetting.rho = chosen.value_or(kRhos[best]);
}

/// A pack that is taken for a change throws the past away, and the packs behind it meet a wider posterior: the scores
/// depend on the threshold, which is therefore chosen again from a run with it.
void CalibrateThreshold(Runner* run, Calibration* c) {
  std::vector<double> scores;
  for (int round = 0; round < kMaxThresholdRuns; ++round) {
    c->scores = (*run)(c->settings).scores;
    scores.clear();
    for (const ThresholdSample& sample : c->scores) scores.push_back(sample.score);
    c->threshold = ChooseThreshold(scores, c->false_modifications);
    const double before = std::exchange(c->settings.forgetting.threshold, c->threshold.threshold);
    if (std::fabs(c->threshold.threshold / before - 1.0) < 0.02) break;
  }
  if (c->threshold.extrapolated)
    c->notes.push_back("a rate of " + support::ExactNumber(c->false_modifications) + " is smaller than " +
                       std::to_string(scores.size()) +
                       " packs can show; the threshold follows from an exponential tail");
  if (c->threshold.at_floor)
    c->notes.push_back("the smallest threshold, " + support::ExactNumber(kSmallestThreshold) +
                       ", already gives fewer false modifications than requested");
}

}  // namespace

Calibration Calibrate(const CalibrationRequest& request) {
  Calibration c;
  c.settings = request.settings;
  c.false_modifications = request.false_modifications;
  const bool tries_rho = request.settings.num_effects == 0;
  Runner run(request, 2 + (tries_rho ? static_cast<int>(kRhos.size()) : 0) + 2);
  c.settings.forgetting.threshold = kNever;
  // At rest, so that no parameter follows what is noise; the threshold is found with the drift that acts later.
  const double drift_share = std::exchange(c.settings.forgetting.drift_share, 0.0);
  CalibrateNoise(&run, &c);
  c.settings.forgetting.drift_share = drift_share;
  if (std::none_of(c.noise.begin(), c.noise.end(), [](const ModeNoise& n) { return n.calibrated; }))
    throw support::InputError("the recording cannot be used for calibration: mode " + c.noise.front().mode + ": " +
                              c.noise.front().why_not + " after the first " + std::to_string(kSettlePacks));
  if (tries_rho) {
    CalibrateRho(&run, &c);
  } else {
    c.notes.emplace_back("rho is unchanged: it is not tried with a model that has effects");
  }
  CalibrateThreshold(&run, &c);
  return c;
}

}  // namespace armcmc::calibrate
