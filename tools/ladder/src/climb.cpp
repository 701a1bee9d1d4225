#include "armcmc/ladder/climb.hpp"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <optional>
#include <set>

#include "comparison.hpp"
#include "curves.hpp"
#include "derived_noise.hpp"
#include "held_out.hpp"
#include "rung.hpp"

namespace armcmc::ladder {
namespace {

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

/// What else may explain what an effect seems to.
struct Rivals {
  DerivedNoise noise;
  Curves curves;

  /// @param exact  It leaves noise alone, so that no curve has another shape. Noise may still be what it explains.
  [[nodiscard]] std::optional<Rival> Of(const Contender& c, bool exact) {
    const std::optional<Rival> rival = noise.RivalOf(c);
    return rival || exact ? rival : curves.RivalOf(c);
  }
};

/// Names what no rival rules out.
void NameOne(const View& view, double floor, bool open, Rivals* rivals, Rung* rung, std::vector<std::string>* notes) {
  for (bool again = true; again;) {
    again = false;
    Name(view, floor, open, rung);
    for (const std::size_t i : rung->named) {
      Contender& c = rung->contenders[i];
      const std::optional<Rival> rival = rivals->Of(c, !LeavesMore(view, c.trial, floor));
      if (!rival) continue;
      c.ruled_out = again = true;
      if (rung->as_if.empty()) rung->as_if = rival->as_if;
      notes->push_back(c.candidate.entry->name + " was not named: it acts as if " + rival->as_if + ", which " +
                       rival->why);
    }
  }
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

/// What this rung would name, or would but for a rival, though an earlier one did in the same place.
const Contender* NamedAgain(const Ladder& ladder, const Rung& rung) {
  for (std::size_t i = 0; i < rung.contenders.size(); ++i) {
    const Contender& c = rung.contenders[i];
    const bool leads = !rung.named.empty() && rung.named.front() == i;
    if ((leads || c.ruled_out) && FirstWith(ladder, c.candidate) < ladder.rungs.size()) return &c;
  }
  return nullptr;
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
  ladder.noise_floor = request.known_noise > 0.0 ? request.known_noise
                                                 : request.noise_over_differences *
                                                       NoiseFloor(data, base.model->target(), base.model->active());
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
      rung.contenders.push_back({std::move(candidate), {}, false, 0.0, {}, {}, 0.0, 0.0, false, false, false});
    progress.Tell(which + ": fitting " + std::to_string(rung.contenders.size()) + " effects",
                  static_cast<double>(r) / request.max_rungs);
    TryAll(ladder.plant, data, ladder.view, &rung, &ladder.notes);
    Bootstrap(&rung);
    const double floor = ladder.noise_floor;
    const Rung* const open = !ladder.rungs.empty() && ladder.rungs.back().open ? &ladder.rungs.back() : nullptr;
    Judge(ladder.view, floor, families, open != nullptr ? open->leader().alone.folds : 1.0, &rung);
    Sort(&rung);
    Rivals rivals{{ladder.plant, data, ladder.view, base}, {ladder.plant, data, ladder.view, base, scales}};
    NameOne(ladder.view, floor, false, &rivals, &rung, &ladder.notes);
    // Two effects of one size each take the smaller part: the first may be named if the next one makes up for it.
    if (rung.named.empty() && open == nullptr) {
      NameOne(ladder.view, floor, true, &rivals, &rung, &ladder.notes);
      rung.open = !rung.named.empty();
    }
    if (r == 0 && rung.named.empty() && rung.as_if.empty() && LeavesMore(ladder.view, base, floor))
      rung.as_if = rivals.curves.Best();
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
    if (const Contender* again = NamedAgain(ladder, rung)) {
      ladder.notes.push_back(again->candidate.entry->name +
                             " was not named: one alone does not do, and two of them in one place are pieces of "
                             "something that has another formula");
      TakeBack(FirstWith(ladder, again->candidate), &ladder, &base);
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
