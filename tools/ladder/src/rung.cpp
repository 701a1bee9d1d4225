#include "rung.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <numeric>
#include <random>
#include <utility>

#include "comparison.hpp"

namespace armcmc::ladder {
namespace {

constexpr int kBootstrap = 400;
constexpr double kAtBound = 1e-3;  // of the logarithm of a frequency or damping ratio
constexpr double kSure = 0.99;     // fraction of bootstrap samples in which it is better
constexpr double kLikely = 0.95;   // the same if few events show it: the name is provisional
constexpr double kAlike = 1.01;    // times the smallest error: equally good
constexpr double kTie = 0.05;      // fraction of bootstrap samples that another family may win
constexpr double kMostly = 0.5;    // fraction of bootstrap samples that a provisional name has to win
constexpr double kWithFlexible =
    0.95;  // squared error with a flexible remainder that a name has to reach in two of three tests,
constexpr double kFarWithFlexible =
    0.8;                               // or in one, losing in none, if few events show it or the remainder imitates it
constexpr double kLeavesAsMuch = 1.5;  // times the error of the named one: kin that are not excluded
constexpr double kSameGain =
    0.999;  // of the leader's gain: what an integration of the plant errs by, and no formula, decides between kin
constexpr double kLoses = 1.1;  // squared error on regions from which an effect is excluded
constexpr double kSame = 0.02;  // of the mean square of what one adds: the other adds the same

/// Whether an oscillation is none: its frequency is too low for the data to show it, or its damping ratio, a lognormal
/// parameter without a unit, is at the limit beyond which nothing resonates.
bool IsNotResonant(const Contender& c) {
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

/// Bootstrap samples of the short segments, the same at every call.
/// @param see  Called for each sample with the squared errors of the base model and of those in `among`.
template <class See>
void ForEachSample(const Rung& rung, const std::vector<std::size_t>& among, See see) {
  std::mt19937_64 random(400);
  const std::size_t stretches = rung.base.stretches.size();
  std::vector<double> weight, squares(among.size());
  for (int b = 0; b < kBootstrap; ++b) {
    weight.assign(stretches, 0.0);
    for (std::size_t k = 0; k < stretches; ++k) weight[random() % stretches] += 1.0;
    const auto total = [&](const std::vector<double>& of_stretch) {
      return std::inner_product(weight.begin(), weight.end(), of_stretch.begin(), 0.0);
    };
    for (std::size_t k = 0; k < among.size(); ++k) squares[k] = total(rung.contenders[among[k]].trial.stretches);
    see(total(rung.base.stretches), squares);
  }
}

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

/// Fraction of bootstrap samples in which the first of those named is the best of them.
double ShareOfFirst(const Rung& rung) {
  int wins = 0;
  ForEachSample(rung, rung.named, [&](double, const std::vector<double>& squares) {
    if (std::min_element(squares.begin(), squares.end()) == squares.begin()) ++wins;
  });
  return static_cast<double>(wins) / kBootstrap;
}

/// Fraction of the bootstrap samples in which a family of those named has the smallest error of all that were compared.
double WinShare(const Rung& rung) {
  double share = 0.0;
  for (const std::size_t i : rung.named) share += rung.contenders[i].win_share;
  return share;
}

}  // namespace

bool AreKin(const EffectEntry& a, const EffectEntry& b) {
  const auto lists = [](const EffectEntry& x, const EffectEntry& y) {
    return std::find(x.kin.begin(), x.kin.end(), y.name) != x.kin.end();
  };
  return lists(a, b) || lists(b, a);
}

void Bootstrap(Rung* rung) {
  std::vector<int> gains(rung->contenders.size(), 0);
  std::vector<std::size_t> judged;
  for (std::size_t i = 0; i < rung->contenders.size(); ++i)
    if (rung->contenders[i].trial.judged) judged.push_back(i);
  std::map<std::string, int> wins;
  ForEachSample(*rung, judged, [&](double base, const std::vector<double>& squares) {
    const auto least = std::min_element(squares.begin(), squares.end());
    if (least != squares.end() && *least < base) {
      const auto winner = judged[static_cast<std::size_t>(least - squares.begin())];
      ++wins[rung->contenders[winner].candidate.entry->family];
    }
    for (std::size_t k = 0; k < judged.size(); ++k)
      if (squares[k] < (1.0 - kLeastGain) * base) ++gains[judged[k]];
  });
  for (std::size_t i = 0; i < rung->contenders.size(); ++i) {
    Contender& c = rung->contenders[i];
    c.gain_share = static_cast<double>(gains[i]) / kBootstrap;
    c.win_share = static_cast<double>(wins[c.candidate.entry->family]) / kBootstrap;
  }
}

void Judge(const View& view, double floor, const std::set<std::string>& families, double before, Rung* rung) {
  for (Contender& c : rung->contenders) {
    if (!c.trial.judged) continue;
    // A name that depends on an earlier one must not be provisional.
    const bool gains = c.alone.folds < 1.0 - kLeastGain && c.gain_share >= (families.empty() ? kLikely : kSure);
    // Many effects can each correct a law that is slightly wrong everywhere. What is really missing explains the larger
    // part of the unexplained error, or leaves nothing but noise.
    const double noise = before * NoiseIn(view, c.trial, floor) / MeanSquare(rung->base);
    c.larger_part = before * c.alone.folds - noise < kLargerPart * (1.0 - noise) ||
                    families.contains(c.candidate.entry->family) || !LeavesMore(view, c.trial, floor);
    const bool elsewhere = c.alone.blocks < 1.0 && c.alone.regions < kLoses;
    const std::array<double, 3> bent{c.with_flexible.folds, c.with_flexible.blocks, c.with_flexible.regions};
    const auto below = [&](double limit) {
      return std::count_if(bent.begin(), bent.end(), [&](double ratio) { return ratio < limit; });
    };
    const bool survives = below(kWithFlexible) >= 2 || (below(kFarWithFlexible) >= 1 && below(1.0) == 3);
    c.has_evidence = gains && elsewhere && survives && !IsNotResonant(c) && IsDetermined(view, c) &&
                     !WorseThanConstant(view, c.trial);
  }
}

void RuleOut(const View& view, std::size_t which, Rung* rung) {
  std::vector<Contender>& all = rung->contenders;
  all[which].ruled_out = true;
  for (Contender& c : all)
    if (c.trial.judged && IsTheSameWithMore(view, rung->base, c, all[which])) c.ruled_out_with = true;
}

void Name(const View& view, double floor, bool open, Rung* rung) {
  std::vector<Contender>& all = rung->contenders;
  const auto may = [open](const Contender& c) {
    return c.has_evidence && !c.ruled_out && !c.ruled_out_with && (open || c.larger_part);
  };
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
  rung->provisional = all[leader].alone.blocks > 1.0 - kLeastGain || all[leader].gain_share < kSure;
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
