#include "armcmc/ladder/climb.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <mutex>
#include <numeric>
#include <random>
#include <set>

#include "armcmc/plant/error.hpp"
#include "comparison.hpp"
#include "held_out.hpp"
#include "parallel.hpp"

namespace armcmc::ladder {
namespace {

constexpr std::size_t kMostJudged = 8;  // of a rung, by closing: what is far behind is not named anyway
constexpr int kBootstrap = 400;
constexpr double kSure = 0.99;         // share of bootstrap samples in which it does
constexpr double kLikely = 0.95;       // the same where few events show it: named, provisionally
constexpr double kAsGood = 0.95;       // of the best's closing: a simpler effect is named first
constexpr double kTie = 0.05;          // share of bootstrap samples that another family may win
constexpr double kLargerPart = 0.5;    // squared error that a name of a new family leaves at most
constexpr double kBeside = 0.95;       // squared error that a name reaches where both may bend, in two of three senses,
constexpr double kFarBeside = 0.8;     // or in one, losing in none, where few events show it or bending feigns it
constexpr double kLeavesAsMuch = 1.5;  // times what the named one leaves: kin that are not excluded
constexpr double kFarBetter = 2.0;     // times less than the simple one leaves: a larger effect that is a rival of it
constexpr double kLoses = 1.1;         // squared error in regions that says: it is not that

double Square(const Trial& trial) { return trial.fit.error_sd * trial.fit.error_sd; }

bool Kin(const EffectEntry& a, const EffectEntry& b) {
  const auto lists = [](const EffectEntry& x, const EffectEntry& y) {
    return std::find(x.kin.begin(), x.kin.end(), y.name) != x.kin.end();
  };
  return lists(a, b) || lists(b, a);
}

std::size_t NumParameters(const Contender& c) { return c.candidate.form().parameters.size(); }

/// Rungs are told of in order; a share of the whole is a guess.
class SharedProgress {
 public:
  explicit SharedProgress(const ClimbRequest& request) : request_(request) {}
  void Tell(const std::string& step, double share) {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (request_.progress) request_.progress(step, share);
  }

 private:
  const ClimbRequest& request_;
  std::mutex mutex_;
};

/// One where amplitudes alone are sought, which vanish at 0 and in which laws are linear; more where a shape is.
std::size_t StartsFor(const Contender& c) {
  constexpr std::size_t kOfShape = 8;
  const std::vector<EffectParameter>& parameters = c.candidate.form().parameters;
  const bool shape =
      std::any_of(parameters.begin(), parameters.end(), [](const EffectParameter& p) { return p.none != "0"; });
  return shape ? kOfShape : 1;
}

/// Fits everything quickly, what is worth it on all rows, and judges what may be named.
/// @param notes  Gets why an effect could not be tried.
void TryAll(const std::shared_ptr<const Plant>& plant, const Dataset& data, const View& view, Rung* rung,
            std::vector<std::string>* notes) {
  constexpr double kWorthIt = 0.25, kNoGain = 0.05;
  std::vector<Contender>& all = rung->contenders;
  const Eigen::VectorXd error = rung->base.model->target() - rung->base.fit.prediction;
  std::vector<std::string> not_tried(all.size());
  InParallel(all.size(), [&](std::size_t i) {
    try {
      const Dataset quick = QuickPart(*all[i].candidate.plant, data, error);
      const double base = Square(Refine(plant, quick, rung->base.fit.theta));
      all[i].trial = Try(all[i].candidate.plant, quick, rung->base.fit.theta, StartsFor(all[i]));
      if (all[i].trial.fit.valid) all[i].closed = std::clamp(1.0 - Square(all[i].trial) / base, 0.0, 1.0);
    } catch (const PlantError& why) {  // as a rate that would have to remember a state
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
  InParallel(all.size(), [&](std::size_t i) {
    if (!all[i].trial.fit.valid || all[i].closed < kWorthIt * quick_best) return;
    all[i].trial = Refine(all[i].candidate.plant, data, all[i].trial.fit.theta);
    all[i].refined = all[i].trial.fit.valid;
    all[i].closed = all[i].refined ? std::clamp(1.0 - Square(all[i].trial) / Square(rung->base), 0.0, 1.0) : 0.0;
  });
  const double best = best_closing();
  // Those that close most are judged, a simple one before a larger one that closes as much.
  std::vector<std::size_t> judged;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (all[i].refined && all[i].closed >= std::max(kNoGain, 2.0 * kWorthIt * best)) judged.push_back(i);
  const auto worth = [&](std::size_t i) { return all[i].closed - 0.005 * static_cast<double>(NumParameters(all[i])); };
  std::stable_sort(judged.begin(), judged.end(), [&](std::size_t a, std::size_t b) { return worth(a) > worth(b); });
  judged.resize(std::min(judged.size(), kMostJudged));
  InParallel(judged.size(), [&](std::size_t k) {
    const std::size_t i = judged[k];
    LeaveOut(view, &all[i].trial);
    all[i].alone = Compare(view, all[i], rung->base, false);
    all[i].beside = Compare(view, all[i], rung->base, true);
  });
}

/// Fills gain_share and win_share from bootstrap samples of the short stretches.
void Bootstrap(Rung* rung) {
  std::mt19937_64 random(400);
  const std::size_t stretches = rung->base.stretches.size();
  std::vector<int> gains(rung->contenders.size(), 0);
  std::map<std::string, int> wins;
  for (int b = 0; b < kBootstrap; ++b) {
    std::vector<double> weight(stretches, 0.0);
    for (std::size_t k = 0; k < stretches; ++k) weight[random() % stretches] += 1.0;
    const auto total = [&](const std::vector<double>& squares) {
      return std::inner_product(weight.begin(), weight.end(), squares.begin(), 0.0);
    };
    const double base = total(rung->base.stretches);
    double least = base;
    std::string winner;
    for (std::size_t i = 0; i < rung->contenders.size(); ++i) {
      const Contender& c = rung->contenders[i];
      if (!c.trial.judged) continue;
      const double mine = total(c.trial.stretches);
      if (mine < (1.0 - kLeastGain) * base) ++gains[i];
      if (mine < least) {
        least = mine;
        winner = c.candidate.entry->family;
      }
    }
    ++wins[winner];
  }
  for (std::size_t i = 0; i < rung->contenders.size(); ++i) {
    Contender& c = rung->contenders[i];
    c.gain_share = static_cast<double>(gains[i]) / kBootstrap;
    c.win_share = static_cast<double>(wins[c.candidate.entry->family]) / kBootstrap;
  }
}

/// @param families  That were named before: more of the same is looked for in finer parts.
/// @param before    Share of the error that the rung before leaves, where its name is still open; else 1.
void Judge(const View& view, double floor, const std::set<std::string>& families, double before, Rung* rung) {
  for (Contender& c : rung->contenders) {
    if (!c.trial.judged) continue;
    // What stands on an earlier name has to be sure.
    const bool gains = c.alone.folds < 1.0 - kLeastGain && c.gain_share >= (families.empty() ? kLikely : kSure);
    // A law that is a little off everywhere can be bent by many effects, each a little. What is really missing takes
    // the larger part of what is unexplained, or leaves nothing.
    c.larger_part = before * c.alone.folds < kLargerPart || families.contains(c.candidate.entry->family) ||
                    !LeavesMore(view, c.trial, floor);
    const bool elsewhere = c.alone.blocks < 1.0 && c.alone.regions < kLoses;
    const std::array<double, 3> bent{c.beside.folds, c.beside.blocks, c.beside.regions};
    const auto below = [&](double limit) {
      return std::count_if(bent.begin(), bent.end(), [&](double ratio) { return ratio < limit; });
    };
    const bool beside = below(kBeside) >= 2 || (below(kFarBeside) >= 1 && below(1.0) == 3);
    c.earned = gains && elsewhere && beside;
  }
}

/// Better wherever it is looked for.
bool BetterEverywhere(const Contender& a, const Contender& b) {
  return a.alone.folds < b.alone.folds && a.alone.blocks < b.alone.blocks && a.alone.regions < b.alone.regions;
}

/// @param open  Also what takes the smaller part only.
void Name(const View& view, double floor, bool open, Rung* rung) {
  std::vector<Contender>& all = rung->contenders;
  const auto may = [open](const Contender& c) { return c.earned && (open || c.larger_part); };
  double best = 0.0;
  for (const Contender& c : all)
    if (may(c)) best = std::max(best, 1.0 - c.alone.folds);
  std::vector<std::size_t> good;
  std::size_t fewest = SIZE_MAX;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (may(all[i]) && 1.0 - all[i].alone.folds >= kAsGood * best) {
      good.push_back(i);
      fewest = std::min(fewest, NumParameters(all[i]));
    }
  if (good.empty()) return;
  std::size_t leader = SIZE_MAX;
  for (const std::size_t i : good)
    if (NumParameters(all[i]) == fewest && (leader == SIZE_MAX || all[i].alone.folds < all[leader].alone.folds))
      leader = i;
  rung->named = {leader};
  rung->provisional = all[leader].alone.blocks > 1.0 - kLeastGain || all[leader].gain_share < kSure;
  // A formula that leaves noise alone is exact: what is like it, or holds it, is no rival.
  const bool not_exact = LeavesMore(view, all[leader].trial, floor);
  std::set<std::string> families{all[leader].candidate.entry->family};
  double tied = all[leader].win_share;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (!may(all[i]) || i == leader) continue;
    const bool as_good = std::find(good.begin(), good.end(), i) != good.end();
    const std::string& family = all[i].candidate.entry->family;
    const bool equal = as_good && NumParameters(all[i]) == fewest && all[i].win_share > kTie;
    const bool larger = as_good && NumParameters(all[i]) > fewest &&
                        kFarBetter * all[i].alone.folds < all[leader].alone.folds &&
                        BetterEverywhere(all[i], all[leader]);
    const bool kin = not_exact && Kin(*all[i].candidate.entry, *all[leader].candidate.entry) &&
                     all[i].alone.folds < kLeavesAsMuch * all[leader].alone.folds;
    if ((!equal && !larger && !kin) || !families.insert(family).second) continue;
    rung->named.push_back(i);
    tied += all[i].win_share;
  }
  // Which of them it is, is open, and nothing follows that would refine it: of each its best form, the one that
  // predicts best first.
  if (rung->named.size() > 1)
    for (std::size_t& named : rung->named)
      for (std::size_t i = 0; i < all.size(); ++i)
        if (may(all[i]) && all[i].candidate.entry == all[named].candidate.entry &&
            all[i].alone.folds < all[named].alone.folds)
          named = i;
  std::sort(rung->named.begin(), rung->named.end(),
            [&](std::size_t a, std::size_t b) { return all[a].alone.folds < all[b].alone.folds; });
  leader = rung->named.front();
  // Simpler effects that are named first do not win against larger ones; those are no rivals.
  rung->probability = rung->named.size() > 1 ? all[leader].win_share / std::max(tied, 1e-9) : all[leader].gain_share;
}

/// The rung that named the same effect in the same place, if a second one makes a curve of it; else how many there are.
std::size_t FirstWith(const Ladder& ladder, const Candidate& candidate) {
  const auto same = [&](const Rung& rung) {
    if (rung.named.empty() || !candidate.entry->single) return false;
    const Candidate& other = rung.leader().candidate;
    return other.entry == candidate.entry && other.binding.form == candidate.binding.form &&
           other.binding.symbols == candidate.binding.symbols;
  };
  return static_cast<std::size_t>(std::find_if(ladder.rungs.begin(), ladder.rungs.end(), same) - ladder.rungs.begin());
}

/// Back to where nothing had been named on a rung.
void TakeBack(std::size_t rung, Ladder* ladder, Trial* base) {
  ladder->rungs.resize(rung + 1);
  Rung& alone = ladder->rungs.back();
  ladder->plant = std::make_shared<const Plant>(alone.base.model->plant().description());
  *base = alone.base;
  ladder->view = alone.view;
  alone.named.clear();
  alone.open = false;
}

/// Whether the data kept apart agree: at least half of the gain is found there. Without any there is no objection.
bool Confirmed(const Dataset& data, const Trial& base, const Contender& c) {
  constexpr double kAgain = 0.5;
  const WholeRun before = RunWhole(data, base), after = RunWhole(data, c.trial);
  const std::vector<Eigen::Index> rows = HeldOutRows(data, before);
  if (rows.empty()) return true;
  const double was = FitOn(before, rows, 1.0).rmse, is = FitOn(after, rows, 1.0).rmse;
  return 1.0 - is * is / (was * was) > kAgain * (1.0 - c.alone.folds);
}

void Sort(Rung* rung) {
  const auto key = [](const Contender& c) { return c.trial.judged ? c.alone.folds : 2.0 - c.closed; };
  std::stable_sort(rung->contenders.begin(), rung->contenders.end(),
                   [&](const Contender& a, const Contender& b) { return key(a) < key(b); });
}

}  // namespace

Ladder Climb(const ClimbRequest& request) {
  SharedProgress progress(request);
  Ladder ladder;
  ladder.entries = std::make_shared<const std::vector<EffectEntry>>(request.entries);
  ladder.plant = request.plant;
  Dataset data = Compared(*ladder.plant, request.data);

  progress.Tell("fitting the model as it is", 0.0);
  Trial base = FitAlone(ladder.plant, &data);
  if (!base.fit.valid) {
    ladder.notes.push_back("the law has no finite value at any start: nothing was compared");
    return ladder;
  }
  ladder.noise_floor =
      request.known_noise > 0.0 ? request.known_noise : NoiseFloor(data, base.model->target(), base.model->active());
  ladder.base = base;
  std::set<std::string> families;
  for (int r = 0; r < request.max_rungs; ++r) {
    const std::string which = "rung " + std::to_string(r + 1);
    const DataScales scales = ScalesOf(data, ladder.plant->description(), ladder.noise_floor);
    Rung rung;
    ladder.view = MakeView(data, *base.model, base.fit.theta, scales.period);
    LeaveOut(ladder.view, &base);
    if (r == 0) ladder.base = base;
    rung.base = base;
    rung.view = ladder.view;
    for (Candidate& candidate : Candidates(ladder.plant->description(), *ladder.entries, scales, &ladder.notes))
      rung.contenders.push_back({std::move(candidate), {}, false, 0.0, {}, {}, 0.0, 0.0, false, false});
    progress.Tell(which + ": fitting " + std::to_string(rung.contenders.size()) + " effects",
                  static_cast<double>(r) / request.max_rungs);
    TryAll(ladder.plant, data, ladder.view, &rung, &ladder.notes);
    Bootstrap(&rung);
    const double floor = ladder.noise_floor;
    const Rung* const open = !ladder.rungs.empty() && ladder.rungs.back().open ? &ladder.rungs.back() : nullptr;
    Judge(ladder.view, floor, families, open != nullptr ? open->leader().alone.folds : 1.0, &rung);
    Sort(&rung);
    Name(ladder.view, floor, false, &rung);
    // Two effects of one size each take the smaller part: the first may be named if the next one makes up for it.
    if (rung.named.empty() && open == nullptr) {
      Name(ladder.view, floor, true, &rung);
      rung.open = !rung.named.empty();
    }
    if (!rung.named.empty() && !Confirmed(request.data, base, rung.leader())) {
      ladder.notes.push_back(rung.leader().candidate.entry->name +
                             " was not named: what it gains is not found again in the data kept apart");
      rung.named.clear();
      rung.open = false;
    }
    const bool named = !rung.named.empty(), tie = rung.named.size() > 1;
    if (!named && open != nullptr) {
      TakeBack(ladder.rungs.size() - 1, &ladder, &base);
      break;
    }
    if (const std::size_t first = named ? FirstWith(ladder, rung.leader().candidate) : ladder.rungs.size();
        first < ladder.rungs.size()) {
      ladder.notes.push_back(rung.leader().candidate.entry->name +
                             " was not named: one alone does not do, and two of them in one place are pieces of "
                             "something that has another formula");
      TakeBack(first, &ladder, &base);
      break;
    }
    if (named && open != nullptr) ladder.rungs.back().open = false;
    ladder.rungs.push_back(std::move(rung));
    if (!named) break;
    const Contender& leader = ladder.rungs.back().leader();
    ladder.plant = leader.candidate.plant;
    families.insert(leader.candidate.entry->family);
    base = leader.trial;
    if (tie) break;
  }
  if (!ladder.rungs.empty() && ladder.rungs.back().open)  // the last that was allowed
    TakeBack(ladder.rungs.size() - 1, &ladder, &base);
  ladder.final_trial = base;
  if (base.judged) {
    ladder.flexible_gain = FlexibleGain(ladder.view, base);
    ladder.complete = !LeavesMore(ladder.view, base, ladder.noise_floor);
  }
  return ladder;
}

}  // namespace armcmc::ladder
