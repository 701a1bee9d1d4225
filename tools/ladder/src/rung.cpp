#include "rung.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

#include "armcmc/plant/error.hpp"
#include "armcmc/support/parallel.hpp"
#include "bootstrap.hpp"
#include "comparison.hpp"

namespace armcmc::ladder {
namespace {

constexpr std::size_t kMostJudged =
    8;  // candidates of a rung that are judged, best first: those far behind are not named anyway
constexpr double kAtBound = 1e-3;     // of the logarithm of a frequency or damping ratio
constexpr std::size_t kAnywhere = 8;  // starting points for all parameters of a simulated plant
constexpr double kSure = 0.99;        // fraction of bootstrap samples in which it is better
constexpr double kLikely = 0.95;      // the same if few events show it: the name is provisional
constexpr double kAlike = 1.01;       // times the smallest error: equally good
constexpr double kTie = 0.05;         // fraction of bootstrap samples that another family may win
constexpr double kMostly = 0.5;       // fraction of bootstrap samples that a provisional name has to win
constexpr double kWithFlexible =
    0.95;  // squared error with a flexible remainder that a name has to reach in two of three tests,
constexpr double kFarWithFlexible =
    0.8;                               // or in one, losing in none, if few events show it or the remainder imitates it
constexpr double kLeavesAsMuch = 1.5;  // times the error of the named one: kin that are not excluded
constexpr double kSameGain =
    0.999;  // of the leader's gain: what an integration of the plant errs by, and no formula, decides between kin
constexpr double kLoses = 1.1;  // squared error on regions from which an effect is excluded
constexpr double kSame = 0.02;  // of the mean square of what one adds: the other adds the same

double Square(const Trial& trial) { return trial.fit.error_sd * trial.fit.error_sd; }

int NumParameters(const Contender& c) { return NumFormulaParameters(c.candidate.form()); }

/// Whether an oscillation is none: its frequency is too low for the data to show it, or its damping ratio, a lognormal
/// parameter without a unit, is at the limit beyond which nothing resonates.
bool OscillatesNot(const Contender& c) {
  const Eigen::VectorXd lower = c.trial.model->Lower(), upper = c.trial.model->Upper();
  const std::vector<Frequency> frequencies = c.candidate.Frequencies();
  const std::vector<EffectParameter>& parameters = c.candidate.form().parameters;
  for (std::size_t k = 0; k < parameters.size() && !frequencies.empty(); ++k) {
    const auto d = static_cast<Eigen::Index>(c.candidate.first_fitted() + k);
    const bool ratio = parameters[k].unit == "1" && parameters[k].prior == "lognormal" && !parameters[k].upper.empty();
    if (ratio && c.trial.fit.theta[d] >= upper[d] - kAtBound) return true;
  }
  return std::any_of(frequencies.begin(), frequencies.end(), [&](const Frequency& frequency) {
    const auto d = static_cast<Eigen::Index>(frequency.parameter);
    return c.trial.fit.theta[d] <= lower[d] + kAtBound;
  });
}

/// Whether the data distinguish some amplitude of an effect from zero, with everything else fixed. If they do not, as
/// when a friction never slides or a play is never crossed, the effect acts only through its limit, and that is another
/// effect.
bool IsDetermined(const View& view, const Contender& c) {
  constexpr double kSigmas = 2.0, kSingular = 1e-10;
  const std::vector<EffectParameter>& parameters = c.candidate.form().parameters;
  const auto first = static_cast<Eigen::Index>(c.candidate.first_fitted());
  const auto count = static_cast<Eigen::Index>(parameters.size());
  const identify::FitResult& fit = c.trial.fit;
  const Eigen::MatrixXd columns = fit.jacobian(view.active_rows, Eigen::all).middleCols(first, count);
  const double thinned =
      static_cast<double>(view.data.num_training()) / static_cast<double>(std::max<Eigen::Index>(1, columns.rows()));
  Eigen::MatrixXd precision = thinned / (fit.error_sd * fit.error_sd) * (columns.transpose() * columns);
  precision.diagonal() += identify::PriorPrecision(*c.trial.model).segment(first, count);
  const Eigen::VectorXd size = precision.diagonal().cwiseMax(1e-300).cwiseSqrt();
  Eigen::MatrixXd scaled = size.cwiseInverse().asDiagonal() * precision * size.cwiseInverse().asDiagonal();
  scaled.diagonal().array() += kSingular;
  const Eigen::VectorXd variance = scaled.inverse().diagonal();
  bool any = false;
  for (Eigen::Index k = 0; k < count; ++k) {
    if (parameters[static_cast<std::size_t>(k)].none != "0") continue;
    any = true;
    const double sd = std::sqrt(variance[k]) / size[k];
    if (std::abs(fit.theta[first + k]) > kSigmas * sd) return true;
  }
  return !any;
}

/// Whether only a few segments of the data show the effect.
bool FewShow(const Contender& c) { return c.alone.blocks > 1.0 - kLeastGain || c.gain_share < kSure; }

/// Number of starting points: one if only amplitudes are fitted, in which laws are linear; more for shape parameters.
std::size_t StartsFor(const Contender& c) {
  constexpr std::size_t kOfShape = 8;
  const std::vector<EffectParameter>& parameters = c.candidate.form().parameters;
  const bool shape =
      std::any_of(parameters.begin(), parameters.end(), [](const EffectParameter& p) { return p.none != "0"; });
  return shape ? kOfShape : 1;
}

/// The current model on a part of the data.
struct QuickBase {
  Dataset data;
  double square;  ///< Mean squared error.
};

/// Signals and states that an effect needs.
std::set<std::string> NeededBy(const Contender& c) {
  std::set<std::string> names;
  for (const EffectNeed& need : c.candidate.form().needs) names.insert(c.candidate.binding.symbols.at(need.name));
  return names;
}

/// Whether an effect does the same as another one in the same slot, but with more parameters or more signals. Adhesion
/// that reaches farther than the motion is an offset of one stroke; and an offset of one stroke, if the law has a
/// constant, is dry friction.
bool IsTheSameWithMore(const View& view, const Trial& base, const Contender& c, const Contender& simple) {
  if (c.candidate.form().terms.front().slot != simple.candidate.form().terms.front().slot) return false;
  const std::set<std::string> needs = NeededBy(c), fewer = NeededBy(simple);
  if (fewer.empty() || !std::includes(needs.begin(), needs.end(), fewer.begin(), fewer.end())) return false;
  const int parameters = NumParameters(c), least = NumParameters(simple);
  if (parameters < least || (parameters == least && needs.size() == fewer.size())) return false;
  const Eigen::VectorXd apart = (c.trial.fit.prediction - simple.trial.fit.prediction)(view.active_rows);
  const Eigen::VectorXd added = (simple.trial.fit.prediction - base.fit.prediction)(view.active_rows);
  return apart.squaredNorm() < kSame * added.squaredNorm();
}

}  // namespace

bool AreKin(const EffectEntry& a, const EffectEntry& b) {
  const auto lists = [](const EffectEntry& x, const EffectEntry& y) {
    return std::find(x.kin.begin(), x.kin.end(), y.name) != x.kin.end();
  };
  return lists(a, b) || lists(b, a);
}

void AddCandidates(const std::vector<EffectEntry>& entries, const DataScales& scales, Rung* rung,
                   std::vector<std::string>* notes) {
  for (Candidate& candidate : Candidates(rung->base.model->plant().description(), entries, scales, notes))
    rung->contenders.push_back({std::move(candidate), {}, false, 0.0, {}, {}, 0.0, 0.0, false, false, false});
}

void TryAll(const std::shared_ptr<const Plant>& plant, const Dataset& data, const View& view, double floor, Rung* rung,
            std::vector<std::string>* notes) {
  constexpr double kWorthIt = 0.25, kNoGain = 0.05;
  constexpr double kNoiseAlone = 1.2, kMoreThanNoise = 1.5;  // times its square
  constexpr double kMostOfIt = 0.25;                         // of the variance of the output
  std::vector<Contender>& all = rung->contenders;
  const Eigen::VectorXd error = rung->base.model->target() - rung->base.fit.prediction;
  // Candidates with memory are tried on another part of the data than those without.
  std::array<std::optional<QuickBase>, 2> bases;
  const auto quick = [&](const Contender& c) -> std::optional<QuickBase>& {
    return bases[Remembers(*c.candidate.plant) ? 1 : 0];
  };
  for (const Contender& c : all)
    if (std::optional<QuickBase>& base = quick(c); !base) {
      base.emplace(QuickBase{QuickPart(*c.candidate.plant, data, error), 0.0});
      base->square = Square(Refine(plant, base->data, rung->base.fit.theta));
      // An effect with a later onset does not show at the start of runs.
      if (base->square < kNoiseAlone * floor * floor && Square(rung->base) > kMoreThanNoise * floor * floor)
        base.emplace(QuickBase{data, Square(rung->base)});
    }
  // Starts from the parameters in `known`, or from several points if it is empty.
  const auto try_from = [&](const Eigen::VectorXd& known, std::size_t starts, Contender* c) {
    Trial trial = Try(c->candidate.plant, quick(*c)->data, known, starts, c->candidate.Frequencies());
    if (!trial.fit.valid || (c->trial.fit.valid && !(trial.fit.cost < c->trial.fit.cost))) return;
    c->trial = std::move(trial);
    c->closed = std::clamp(1.0 - Square(c->trial) / quick(*c)->square, 0.0, 1.0);
  };
  const bool simulated = IsSimulated(plant->description());
  // The parameters of a simulated plant that explains little of its output say nothing about those that it has with
  // what is missing.
  const bool from_anywhere = simulated && UnexplainedShare(view, rung->base) > kMostOfIt;
  std::vector<std::string> not_tried(all.size());
  support::InParallel(all.size(), [&](std::size_t i) {
    try {
      try_from(rung->base.fit.theta, StartsFor(all[i]), &all[i]);
      if (from_anywhere) try_from({}, kAnywhere, &all[i]);
    } catch (const PlantError& why) {  // for example a rate that would need the memory of a state
      not_tried[i] = all[i].candidate.entry->name + " was not tried: " + why.what();
    }
  });
  for (const std::string& note : not_tried)
    if (!note.empty() && std::find(notes->begin(), notes->end(), note) == notes->end()) notes->push_back(note);
  const auto best_closing = [&] {
    double best = kNoGain;
    for (const Contender& c : all) best = std::max(best, c.closed);
    return best;
  };
  const double quick_best = best_closing();
  support::InParallel(all.size(), [&](std::size_t i) {
    if (!all[i].trial.fit.valid || all[i].closed < kWorthIt * quick_best) return;
    // What is missing may have distorted the fit of a simulated plant so much that no fit recovers from there.
    if (simulated && !from_anywhere) try_from({}, kAnywhere, &all[i]);
    all[i].trial = Refine(all[i].candidate.plant, data, all[i].trial.fit.theta);
    all[i].refined = all[i].trial.fit.valid;
    all[i].closed = all[i].refined ? std::clamp(1.0 - Square(all[i].trial) / Square(rung->base), 0.0, 1.0) : 0.0;
  });
  const double best = best_closing();
  // Those with the largest gain are judged, a simple one before a larger one with the same gain.
  std::vector<std::size_t> judged;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (all[i].refined && all[i].closed >= std::max(kNoGain, 2.0 * kWorthIt * best)) judged.push_back(i);
  const auto worth = [&](std::size_t i) { return all[i].closed - 0.005 * static_cast<double>(NumParameters(all[i])); };
  std::stable_sort(judged.begin(), judged.end(), [&](std::size_t a, std::size_t b) { return worth(a) > worth(b); });
  judged.resize(std::min(judged.size(), kMostJudged));
  support::InParallel(judged.size(), [&](std::size_t k) {
    const std::size_t i = judged[k];
    LeaveOut(view, &all[i].trial);
    all[i].alone = Compare(view, all[i], rung->base, false);
    all[i].with_flexible = Compare(view, all[i], rung->base, true);
  });
}

Trial BetterBase(const std::shared_ptr<const Plant>& plant, const Dataset& data, const Rung& rung) {
  constexpr std::size_t kTried = 4;
  constexpr double kBetter = 0.99;  // of the error: more than the tolerance of a fit
  Trial best;
  if (!IsSimulated(plant->description())) return best;
  std::vector<const Contender*> first;
  for (const Contender& c : rung.contenders)
    if (c.refined) first.push_back(&c);
  std::stable_sort(first.begin(), first.end(),
                   [](const Contender* a, const Contender* b) { return a->closed > b->closed; });
  first.resize(std::min(first.size(), kTried));
  std::vector<Trial> trials(first.size());
  support::InParallel(first.size(), [&](std::size_t i) {
    trials[i] = Refine(plant, data, first[i]->trial.fit.theta.head(rung.base.fit.theta.size()));
  });
  double least = kBetter * rung.base.fit.error_sd;
  for (Trial& trial : trials)
    if (trial.fit.valid && trial.fit.error_sd < least) {
      least = trial.fit.error_sd;
      best = std::move(trial);
    }
  return best;
}

void Judge(const View& view, double floor, const std::set<std::string>& families, double before, Rung* rung) {
  for (Contender& c : rung->contenders) {
    if (!c.trial.judged) continue;
    // A name that depends on an earlier one must not be provisional.
    const bool gains = c.alone.folds < 1.0 - kLeastGain && c.gain_share >= (families.empty() ? kLikely : kSure);
    // Many effects can each correct a law that is slightly wrong everywhere. What is really missing explains the larger
    // part of the unexplained error, or leaves nothing but noise.
    const double noise = before * NoiseIn(view, c.trial, floor) / Square(rung->base);
    c.larger_part = before * c.alone.folds - noise < kLargerPart * (1.0 - noise) ||
                    families.contains(c.candidate.entry->family) || !LeavesMore(view, c.trial, floor);
    const bool elsewhere = c.alone.blocks < 1.0 && c.alone.regions < kLoses;
    const std::array<double, 3> bent{c.with_flexible.folds, c.with_flexible.blocks, c.with_flexible.regions};
    const auto below = [&](double limit) {
      return std::count_if(bent.begin(), bent.end(), [&](double ratio) { return ratio < limit; });
    };
    const bool survives = below(kWithFlexible) >= 2 || (below(kFarWithFlexible) >= 1 && below(1.0) == 3);
    c.earned = gains && elsewhere && survives && !OscillatesNot(c) && IsDetermined(view, c) &&
               !WorseThanConstant(view, c.trial);
  }
}

void Name(const View& view, double floor, bool open, Rung* rung) {
  std::vector<Contender>& all = rung->contenders;
  const auto may = [open](const Contender& c) { return c.earned && !c.ruled_out && (open || c.larger_part); };
  double best = 0.0;
  for (const Contender& c : all)
    if (may(c)) best = std::max(best, 1.0 - c.alone.folds);
  std::vector<std::size_t> good;
  int fewest = std::numeric_limits<int>::max();
  for (std::size_t i = 0; i < all.size(); ++i)
    if (may(all[i]) && 1.0 - all[i].alone.folds >= kAsGood * best) {
      good.push_back(i);
      fewest = std::min(fewest, NumParameters(all[i]));
    }
  rung->named.clear();
  if (good.empty()) return;
  double least = std::numeric_limits<double>::infinity();
  for (const std::size_t i : good)
    if (NumParameters(all[i]) == fewest) least = std::min(least, all[i].alone.folds);
  // Of equally good ones the one that reads the fewest signals: dry friction if the pressure is constant.
  std::size_t leader = SIZE_MAX;
  for (const std::size_t i : good) {
    if (NumParameters(all[i]) != fewest || all[i].alone.folds > kAlike * least) continue;
    const auto key = [&](std::size_t k) { return std::pair(all[k].candidate.form().needs.size(), all[k].alone.folds); };
    if (leader == SIZE_MAX || key(i) < key(leader)) leader = i;
  }
  rung->named = {leader};
  rung->provisional = FewShow(all[leader]);
  // A formula that leaves nothing but noise is exact: an effect that acts like it or contains it is no rival.
  const bool not_exact = LeavesMore(view, all[leader].trial, floor);
  std::set<std::string> families{all[leader].candidate.entry->family};
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (!may(all[i]) || i == leader) continue;
    const bool as_good = std::find(good.begin(), good.end(), i) != good.end();
    const std::string& family = all[i].candidate.entry->family;
    const bool equal = as_good && NumParameters(all[i]) == fewest && all[i].win_share > kTie;
    const bool larger = as_good && NumParameters(all[i]) > fewest &&
                        kFarBetter * all[i].alone.folds < all[leader].alone.folds &&
                        BetterEverywhere(all[i], all[leader]);
    const bool indistinct = NumParameters(all[i]) == NumParameters(all[leader]) &&
                            1.0 - all[i].alone.folds > kSameGain * (1.0 - all[leader].alone.folds);
    const bool as_much = not_exact && (all[i].alone.folds < kLeavesAsMuch * all[leader].alone.folds ||
                                       ExtrapolatesBetter(all[i], all[leader]));
    const bool kin = AreKin(*all[i].candidate.entry, *all[leader].candidate.entry) && (indistinct || as_much);
    if ((!equal && !larger && !kin) || !families.insert(family).second) continue;
    rung->named.push_back(i);
  }
  const std::vector<std::size_t> tied = rung->named;
  std::erase_if(rung->named, [&](std::size_t i) {
    return std::any_of(tied.begin(), tied.end(),
                       [&](std::size_t k) { return IsTheSameWithMore(view, rung->base, all[i], all[k]); });
  });
  // No later rung refines what is tied: each is given in its best form, the best prediction first.
  if (rung->named.size() > 1)
    for (std::size_t& named : rung->named)
      for (std::size_t i = 0; i < all.size(); ++i)
        if (may(all[i]) && all[i].candidate.entry == all[named].candidate.entry &&
            all[i].alone.folds < all[named].alone.folds)
          named = i;
  std::sort(rung->named.begin(), rung->named.end(),
            [&](std::size_t a, std::size_t b) { return all[a].alone.folds < all[b].alone.folds; });
  leader = rung->named.front();
  if (rung->provisional && WinShare(*rung) < kMostly) {
    rung->named.clear();
    return;
  }
  // A simpler effect is preferred to larger ones that are better; those do not count as rivals.
  rung->probability = rung->named.size() > 1 ? ShareOfFirst(*rung) : all[leader].gain_share;
}

void NameAs(std::vector<std::size_t> named, Rung* rung) {
  std::sort(named.begin(), named.end(), [&](std::size_t a, std::size_t b) {
    return rung->contenders[a].alone.folds < rung->contenders[b].alone.folds;
  });
  rung->named = std::move(named);
  rung->open = false;
  rung->provisional = FewShow(rung->leader());
  rung->probability = rung->named.size() > 1 ? ShareOfFirst(*rung) : rung->leader().gain_share;
}

std::vector<std::size_t> StillTied(const Rung& rung) {
  const std::vector<Contender>& all = rung.contenders;
  std::vector<std::size_t> order(all.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return all[a].alone.folds < all[b].alone.folds; });
  const Contender& best = all[order.front()];
  std::erase_if(order, [&](std::size_t i) {
    if (&all[i] == &best) return false;
    const bool kin = AreKin(*all[i].candidate.entry, *best.candidate.entry);
    const bool as_much = all[i].alone.folds < kLeavesAsMuch * best.alone.folds || ExtrapolatesBetter(all[i], best);
    return !(kin && as_much) && all[i].win_share <= kTie;
  });
  return order;
}

void Sort(Rung* rung) {
  const auto key = [](const Contender& c) { return c.trial.judged ? c.alone.folds : 2.0 - c.closed; };
  std::stable_sort(rung->contenders.begin(), rung->contenders.end(),
                   [&](const Contender& a, const Contender& b) { return key(a) < key(b); });
}

}  // namespace armcmc::ladder
