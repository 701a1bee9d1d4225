#include "armcmc/gap_bench/summary.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>
#include <string_view>

#include "armcmc/gap_bench/score.hpp"
#include "armcmc/gap_bench/strata.hpp"
#include "armcmc/models/registry.hpp"

namespace armcmc::gap_bench {
namespace {

constexpr int kBins = 10;
constexpr double kVisible = 0.3;  // gap ratio from which an effect has to be found
constexpr double kClear = 1.0;
constexpr double kSure = 0.9;
constexpr double kNear_s = 0.02, kLocated_s = 0.2;  // of an onset

bool Answered(const Outcome& o) { return Counts(o) && o.grade != Grade::kFailed; }

bool SingleEffect(const Outcome& o) {
  const std::string& stratum = o.what.stratum;
  return (stratum == "singles" || stratum == "scale" || stratum == "paper") && Answered(o);
}

/// Of the plant that most strata are made with.
std::span<const EffectInfo* const> ConfusedEffects() { return CompiledModels().front()->compiled->effects; }

int IndexOf(std::string_view effect) {
  const auto effects = ConfusedEffects();
  const auto found =
      std::find_if(effects.begin(), effects.end(), [&](const EffectInfo* info) { return info->name == effect; });
  return found == effects.end() ? -1 : static_cast<int>(found - effects.begin());
}

}  // namespace

int Row::counted() const {
  return std::accumulate(count.begin(), count.end(), 0) - of(Grade::kNotMade) - of(Grade::kNotShown);
}

bool Counts(const Outcome& o) { return o.grade != Grade::kNotMade && o.grade != Grade::kNotShown; }

std::vector<Row> Rows(const std::vector<Outcome>& outcomes) {
  std::vector<Row> rows;
  for (const Outcome& outcome : outcomes) {
    auto row = std::find_if(rows.begin(), rows.end(), [&](const Row& r) {
      return r.stratum == outcome.what.stratum && r.group == outcome.what.group;
    });
    if (row == rows.end()) {
      rows.push_back({outcome.what.stratum, outcome.what.group, {}});
      row = std::prev(rows.end());
    }
    ++row->count[static_cast<std::size_t>(outcome.grade)];
  }
  return rows;
}

Calibration Calibrate(const std::vector<Outcome>& outcomes) {
  Calibration calibration;
  for (int b = 0; b < kBins; ++b) {
    Bin bin;
    bin.low = static_cast<double>(b) / kBins;
    bin.high = static_cast<double>(b + 1) / kBins;
    calibration.bins.push_back(bin);
  }
  for (const Outcome& outcome : outcomes) {
    if (!Answered(outcome)) continue;
    const double p = std::clamp(outcome.label_probability, 0.0, 1.0);
    Bin& bin = calibration.bins[static_cast<std::size_t>(std::min(static_cast<int>(p * kBins), kBins - 1))];
    ++bin.n;
    bin.printed += p;
    bin.right += outcome.label_right ? 1.0 : 0.0;
    ++calibration.n;
  }
  for (Bin& bin : calibration.bins) {
    if (bin.n == 0) continue;
    calibration.error += std::abs(bin.printed - bin.right) / std::max(calibration.n, 1);
    bin.printed /= bin.n;
    bin.right /= bin.n;
  }
  return calibration;
}

Confusion Confuse(const std::vector<Outcome>& outcomes, bool imperfect) {
  Confusion confusion;
  for (const EffectInfo* info : ConfusedEffects()) confusion.names.emplace_back(info->name);
  confusion.answers = confusion.names;
  for (const char* answer : {"tie with the truth", "other set", "unnamed", "none"})
    confusion.answers.emplace_back(answer);
  const std::size_t tie = confusion.names.size();
  confusion.count.assign(confusion.names.size(), std::vector<int>(confusion.answers.size(), 0));
  for (const Outcome& outcome : outcomes) {
    if (imperfect ? !Imperfect(outcome.what.stratum) || !Answered(outcome) : !SingleEffect(outcome)) continue;
    std::vector<TrueEffect> effects = outcome.truth.effects;
    std::erase_if(effects, [](const TrueEffect& effect) { return effect.kind == "outside"; });
    if (outcome.what.strength < kVisible || effects.size() != 1) continue;
    const int row = IndexOf(effects.front().name);
    if (row < 0) continue;
    const std::vector<Names> sets = SetsOf(outcome.answer.result);
    std::size_t column = tie + 1;
    if (outcome.grade == Grade::kTie)
      column = tie;
    else if (outcome.answer.result.verdict == gap::Verdict::kUnnamed)
      column = tie + 2;
    else if (outcome.answer.result.verdict == gap::Verdict::kNone)
      column = tie + 3;
    else if (sets.size() == 1 && sets.front().size() == 1 && IndexOf(sets.front().front()) >= 0)
      column = static_cast<std::size_t>(IndexOf(sets.front().front()));
    ++confusion.count[static_cast<std::size_t>(row)][column];
  }
  return confusion;
}

std::vector<double> Closures(const std::vector<Outcome>& outcomes) {
  std::vector<double> closures;
  for (const Outcome& o : outcomes)
    if (ShownClosed(o)) closures.push_back(o.answer.result.gap.closed_fraction);
  return closures;
}

bool ShownClosed(const Outcome& o) {
  const std::string& stratum = o.what.stratum;
  return (stratum == "singles" || stratum == "scale" || stratum == "pairs") && o.what.strength >= kClear &&
         (o.grade == Grade::kRight || o.grade == Grade::kTie);
}

double Quantile(std::vector<double> values, double share) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::sort(values.begin(), values.end());
  const double at = share * static_cast<double>(values.size() - 1);
  const auto low = static_cast<std::size_t>(at);
  const std::size_t high = std::min(low + 1, values.size() - 1);
  return values[low] + (at - static_cast<double>(low)) * (values[high] - values[low]);
}

Onsets LocateOnsets(const std::vector<Outcome>& outcomes) {
  Onsets onsets;
  std::vector<double> errors;
  int near = 0, located = 0, of_truth = 0;
  for (const Outcome& o : outcomes) {
    if (o.what.stratum != "onset" || (o.grade != Grade::kRight && o.grade != Grade::kTie)) continue;
    ++onsets.n;
    if (o.onset_off_s) of_truth += *o.onset_off_s <= kLocated_s ? 1 : 0;
    if (!o.onset_error_s) continue;
    errors.push_back(*o.onset_error_s);
    near += errors.back() <= kNear_s ? 1 : 0;
    located += errors.back() <= kLocated_s ? 1 : 0;
  }
  onsets.dated = static_cast<int>(errors.size());
  const double n = std::max(onsets.n, 1);
  onsets.within_20_ms = near / n;
  onsets.within_200_ms = located / n;
  onsets.off_within_200_ms = of_truth / n;
  onsets.median_s = Quantile(errors, 0.5);
  onsets.quantile90_s = Quantile(errors, 0.9);
  return onsets;
}

ConfidentLabels CountConfident(const std::vector<Outcome>& outcomes) {
  ConfidentLabels sure;
  for (const Outcome& o : outcomes) {
    if (!Answered(o) || o.label_probability < kSure) continue;
    ++sure.n;
    sure.right += o.label_right ? 1 : 0;
  }
  return sure;
}

}  // namespace armcmc::gap_bench
