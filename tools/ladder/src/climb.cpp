#include "armcmc/ladder/climb.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <mutex>
#include <optional>
#include <set>
#include <utility>

#include "bent_law.hpp"
#include "comparison.hpp"
#include "confirmation.hpp"
#include "constants.hpp"
#include "curves.hpp"
#include "derived_noise.hpp"
#include "earlier_names.hpp"
#include "free_starts.hpp"
#include "motion_rival.hpp"
#include "open_tie.hpp"
#include "plain_rivals.hpp"
#include "rung.hpp"
#include "start_alone.hpp"
#include "superseded.hpp"

namespace armcmc::ladder {
namespace {

/// Reports progress rung by rung; how many rungs there will be is not known, so the fraction is an estimate.
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

/// Alternative explanations of what an effect explains.
struct Rivals {
  Constants constants;
  DerivedNoise noise;
  Curves curves;
  BentLaw bent;
  PlainRivals plain;
  StartAlone start;
  const View& view;
  const Trial& base;
  EarlierNames before;

  /// @param exact  Nothing but noise is left, so that no curve of another shape can do better. A wrong constant, noise,
  ///               or an error in an effect named earlier may still explain the same.
  [[nodiscard]] std::optional<Rival> Of(const Contender& c, double floor, bool exact, bool smaller_part) {
    std::optional<Rival> rival = constants.RivalOf(c);
    if (!rival) rival = start.RivalOf(c, floor);
    if (!rival) rival = MotionRivalOf(view, base, c);
    if (!rival) rival = noise.RivalOf(c);
    if (!rival) rival = bent.RivalOf(c);
    if (!rival) rival = plain.RivalOf(c);
    if (!rival && !exact) rival = curves.RivalOf(c, smaller_part);
    if (rival || !before.FormulaErrorExplains(c)) return rival;
    if (const Candidate* like = before.Like(*c.candidate.entry))
      return Rival{like->entry->name + " had another formula", "acts alike and is three times as large"};
    return curves.BendOf(c, before.effects);
  }
};

/// Gives a name unless a rival rules it out.
void NameUnlessRuledOut(const View& view, double floor, bool open, Rivals* rivals, Rung* rung,
                        std::vector<std::string>* notes) {
  for (bool again = true; again;) {
    again = false;
    Name(view, floor, open, rung);
    for (const std::size_t i : rung->named) {
      Contender& c = rung->contenders[i];
      const std::optional<Rival> rival = rivals->Of(c, floor, !LeavesMore(view, c.trial, floor), open);
      if (!rival) continue;
      RuleOut(view, i, rung);
      again = true;
      if (rung->as_if.empty()) rung->as_if = rival->as_if;
      notes->push_back(c.candidate.entry->name + " was not named: it acts as if " + rival->as_if + ", which " +
                       rival->why);
    }
  }
}

/// What a name is checked against.
struct NamingContext {
  const Dataset& data;  ///< All of it.
  const View& view;
  double floor;
  const Rung* open;  ///< The previous rung, if its name depends on this one; else null.
  Rivals rivals;
};

/// Gives a name unless a rival rules it out or the held-out data contradict it.
void NameAndConfirm(NamingContext* checks, Rung* rung, std::vector<std::string>* notes) {
  double gained = 0.0;  // most of what is withdrawn
  for (bool contradicted = false;;) {
    NameUnlessRuledOut(checks->view, checks->floor, false, &checks->rivals, rung, notes);
    // Of two effects of the same size neither explains the larger part: the first may be named if the next completes
    // it.
    if (rung->named.empty() && checks->open == nullptr && !contradicted) {
      NameUnlessRuledOut(checks->view, checks->floor, true, &checks->rivals, rung, notes);
      rung->open = !rung->named.empty();
    }
    if (rung->named.empty()) return;
    Contender& leader = rung->contenders[rung->named.front()];
    // What explains clearly less than an effect that is not there is not there either.
    if (1.0 - leader.alone.folds < kAsGood * gained) {
      notes->push_back(leader.candidate.entry->name + " was not named: it explains less than what was not named");
      rung->open = false;
      rung->named.clear();
      return;
    }
    const Rung* const open = checks->open;
    const double left = leader.alone.folds * (open != nullptr ? open->leader().alone.folds : 1.0);
    const HeldOutErrors apart = ConfirmOnHeldOut(checks->data, open != nullptr ? open->base : rung->base, leader.trial,
                                                 1.0 - left, NoiseIn(checks->view, leader.trial, checks->floor));
    if (apart.agree) return;
    if (!std::isfinite(apart.after) && open == nullptr) {
      rung->open = true;
      return;
    }
    char text[120];
    std::snprintf(text, sizeof(text), " was not named: on the held-out data the error changes only from %.4g to %.4g",
                  apart.before, apart.after);
    notes->push_back(leader.candidate.entry->name + text);
    gained = std::max(gained, 1.0 - leader.alone.folds);
    leader.has_evidence = rung->open = false;
    rung->named.clear();
    contradicted = true;
  }
}

/// Index of the rung that named the same effect in the same place, if a second one would only draw a curve; else the
/// number of rungs.
std::size_t FirstWith(const Ladder& ladder, const Candidate& candidate) {
  const auto same = [&](const Rung& rung) {
    if (rung.named.empty() || !candidate.entry->single) return false;
    const Candidate& other = rung.leader().candidate;
    return other.entry == candidate.entry && other.binding.form == candidate.binding.form &&
           other.binding.symbols == candidate.binding.symbols;
  };
  return static_cast<std::size_t>(std::find_if(ladder.rungs.begin(), ladder.rungs.end(), same) - ladder.rungs.begin());
}

/// The effect that this rung names, or would but for a rival, although an earlier rung named it in the same place; null
/// if there is none.
const Contender* NamedAgain(const Ladder& ladder, const Rung& rung) {
  for (std::size_t i = 0; i < rung.contenders.size(); ++i) {
    const Contender& c = rung.contenders[i];
    const bool leads = !rung.named.empty() && rung.named.front() == i;
    if ((leads || c.ruled_out) && FirstWith(ladder, c.candidate) < ladder.rungs.size()) return &c;
  }
  return nullptr;
}

/// The series whose sample-to-sample changes measure the noise: the output or, if the law explains a target instead,
/// the error of the law. Inputs that switch make a target jump, and its noise is that of the signals in the law.
Eigen::VectorXd SeriesForNoise(const Trial& base) {
  const std::vector<ModeDescription>& modes = base.model->plant().description().modes;
  const bool target = std::any_of(modes.begin(), modes.end(), [](const auto& mode) { return !mode.target.empty(); });
  return target ? Eigen::VectorXd(base.model->target() - base.fit.prediction) : base.model->target();
}

/// The plant with its constants fitted, if this removes a tenth of the squared error on left-out data.
/// @param rung  The first one, which named nothing. Its best contenders give starting points: a simulated plant may be
///   stuck in a minimum from which an effect helped it out.
std::optional<FreeConstants> Corrected(const PlantDescription& own, const std::shared_ptr<const Plant>& plant,
                                       const Dataset& data, const View& view, const DataScales& scales,
                                       const Rung& rung) {
  constexpr std::size_t kFrom = 3;
  const Eigen::VectorXd& theta = rung.base.fit.theta;
  std::vector<Eigen::VectorXd> known{theta};
  for (const Contender& c : rung.contenders)
    if (c.refined && known.size() <= kFrom && IsSimulated(own))
      known.emplace_back(c.trial.fit.theta.head(theta.size()));
  std::optional<FreeConstants> free = WithFreeConstants(own, plant, data, scales, known);
  if (!free) return free;
  Contender corrected;
  corrected.trial = free->trial;
  corrected.closed = std::clamp(1.0 - std::pow(free->trial.fit.error_sd / rung.base.fit.error_sd, 2), 0.0, 1.0);
  if (!(corrected.closed > kLeastGain)) return std::nullopt;
  LeaveOut(view, &corrected.trial);
  if (!(Compare(view, corrected, rung.base, false).folds < 1.0 - kLeastGain)) return std::nullopt;
  free->trial = std::move(corrected.trial);
  return free;
}

/// Returns to the state before a rung named anything.
void TakeBack(std::size_t rung, Ladder* ladder, Trial* base) {
  ladder->rungs.resize(rung + 1);
  Rung& alone = ladder->rungs.back();
  ladder->plant = std::make_shared<const Plant>(alone.base.model->plant().description());
  *base = alone.base;
  ladder->view = alone.view;
  alone.named.clear();
  alone.open = false;
}

/// The first rung with the constants as the file states them.
struct AsGiven {
  Rung rung;
  std::shared_ptr<const Plant> plant;
  std::vector<std::string> notes;
};

/// The ladder as it ends with a tie.
struct AsTied {
  Trial base;
  View view;
  std::vector<std::string> notes;
};

/// Returns to the constants of the file, since nothing was named with others either. Those others are what the misfit
/// looks like if they explain all of it, or nothing else does.
void RestoreConstants(AsGiven given, Ladder* ladder, Trial* base) {
  const FreeConstants& free = *ladder->free_constants;
  const bool all = !LeavesMore(given.rung.view, free.trial, ladder->noise_floor);
  if (all || given.rung.as_if.empty()) given.rung.as_if = AsIf(free, free.trial, given.rung.view.data.training);
  *base = given.rung.base;
  ladder->view = given.rung.view;
  ladder->plant = std::move(given.plant);
  ladder->notes = std::move(given.notes);
  ladder->rungs.clear();
  ladder->rungs.push_back(std::move(given.rung));
  ladder->free_constants.reset();
}

}  // namespace

Ladder Climb(const ClimbRequest& request) {
  SharedProgress progress(request);
  Ladder ladder;
  ladder.entries = std::make_shared<const std::vector<EffectEntry>>(request.entries);
  ladder.plant = request.plant;
  Dataset data = Compared(*ladder.plant, request.data, request.most_simulated);

  progress.Tell("fitting the model as it is", 0.0);
  Trial base = FitAlone(ladder.plant, &data);
  if (!base.fit.valid) {
    ladder.notes.push_back("the law has no finite value at any start: nothing was compared");
    return ladder;
  }
  ladder.noise_floor = request.known_noise > 0.0 ? request.known_noise
                                                 : request.noise_over_differences *
                                                       NoiseFloor(data, SeriesForNoise(base), base.model->active());
  if (std::shared_ptr<const Plant> freed = WithFreeStarts(base, data, ladder.noise_floor)) {
    Eigen::VectorXd theta = identify::TrajectoryModel(freed, data.series).Start();
    theta.head(base.fit.theta.size()) = base.fit.theta;
    if (Trial free = Refine(freed, data, theta); free.fit.valid) {
      ladder.plant = std::move(freed);
      base = std::move(free);
    }
  }
  ladder.base = base;
  std::set<std::string> families;
  int again = 2;  // rungs that may be repeated from a better fit
  PlantDescription own = request.plant->description();
  Trial start = base;            // of the first rung
  std::optional<AsGiven> given;  // the first rung, if it is repeated with other constants
  const std::vector<std::string> first_notes = ladder.notes;
  std::optional<OpenTie> tied;
  std::optional<AsTied> as_tied;  // if a rung is tried above the tie
  for (int r = 0; r < request.max_rungs; ++r) {
    const std::string which = "rung " + std::to_string(r + 1);
    const DataScales scales = ScalesOf(data, ladder.plant->description(), ladder.noise_floor);
    Rung rung;
    ladder.view = MakeView(data, *base.model, base.fit.theta, scales.period);
    LeaveOut(ladder.view, &base);
    if (r == 0 && !given) ladder.base = base;
    rung.base = base;
    rung.view = ladder.view;
    for (Candidate& candidate : Candidates(ladder.plant->description(), *ladder.entries, scales, &ladder.notes))
      rung.contenders.push_back({std::move(candidate), {}, false, 0.0, {}, {}, 0.0, 0.0, false, false, false});
    progress.Tell(which + ": fitting " + std::to_string(rung.contenders.size()) + " effects",
                  static_cast<double>(r) / request.max_rungs);
    TryAll(ladder.plant, data, ladder.view, ladder.noise_floor, tied ? &families : nullptr, &rung, &ladder.notes);
    if (Trial better = BetterBase(ladder.plant, data, rung); better.fit.valid && again > 0) {
      base = std::move(better);
      --again;
      --r;
      continue;
    }
    Bootstrap(&rung);
    const double floor = ladder.noise_floor;
    const Rung* const open = !ladder.rungs.empty() && ladder.rungs.back().open ? &ladder.rungs.back() : nullptr;
    Judge(ladder.view, floor, families, open != nullptr ? open->leader().alone.folds : 1.0, &rung);
    Sort(&rung);
    NamingContext checks{request.data,
                         ladder.view,
                         floor,
                         open,
                         {{own, ladder.plant, data, ladder.view, base, scales},
                          {ladder.plant, data, ladder.view, base},
                          {ladder.plant, data, ladder.view, base, scales},
                          {ladder.plant, data, ladder.view, base, scales},
                          {ladder.plant, data, ladder.view, base, scales, rung.contenders},
                          {ladder.plant, data, ladder.view, base, scales},
                          ladder.view,
                          base,
                          {}}};
    EarlierNames& before = checks.rivals.before;
    for (const Rung& earlier : ladder.rungs) before.effects.push_back(&earlier.leader().candidate);
    if (r == 0) start = base;
    before.explained = std::pow(start.fit.error_sd / base.fit.error_sd, 2) - 1.0;
    NameAndConfirm(&checks, &rung, &ladder.notes);
    if (r == 0 && rung.named.empty() && rung.as_if.empty() && LeavesMore(ladder.view, base, floor))
      rung.as_if = checks.rivals.curves.Best();
    const bool named = !rung.named.empty(), tie = rung.named.size() > 1;
    if (r == 0 && !named && !given && LeavesMore(ladder.view, base, floor)) {
      progress.Tell(which + ": fitting constants", static_cast<double>(r) / request.max_rungs);
      ladder.free_constants = Corrected(own, ladder.plant, data, ladder.view, scales, rung);
      if (ladder.free_constants) {
        given = AsGiven{std::move(rung), std::exchange(ladder.plant, ladder.free_constants->plant),
                        std::exchange(ladder.notes, first_notes)};
        base = ladder.free_constants->trial;
        own.constants.clear();  // fitted: no rivals any more
        --r;
        continue;
      }
    }
    if (!named && open != nullptr) {
      TakeBack(ladder.rungs.size() - 1, &ladder, &base);
      break;
    }
    // What is named above a tie must not depend on which of its effects is present, nor on what may follow.
    if (tied && (!named || rung.open || NamedAgain(ladder, rung) != nullptr ||
                 !tied->Extend(data, ladder.view, scales, floor, families, *ladder.entries, rung))) {
      base = std::move(as_tied->base);
      ladder.view = std::move(as_tied->view);
      ladder.notes = std::move(as_tied->notes);
      break;
    }
    if (const Contender* second = NamedAgain(ladder, rung)) {
      ladder.notes.push_back(second->candidate.entry->name +
                             " was not named: one alone is not enough, and two of them in one place are pieces of "
                             "something that has another formula");
      TakeBack(FirstWith(ladder, second->candidate), &ladder, &base);
      break;
    }
    if (named && open != nullptr) ladder.rungs.back().open = false;
    ladder.rungs.push_back(std::move(rung));
    if (!named) break;
    if (tied)
      tied->ResolveTie(&ladder);
    else
      DropSuperseded(data, &ladder);
    const Contender& leader = ladder.rungs.back().leader();
    ladder.plant = leader.candidate.plant;
    families.insert(leader.candidate.entry->family);
    base = leader.trial;
    if (tied && tied->decided()) tied.reset();
    if (tie && (tied || ladder.rungs.back().open)) break;
    if (tie) tied.emplace(ladder.rungs.size() - 1, ladder.rungs.back());
    if (tied) {
      if (!LeavesMore(ladder.view, base, floor)) break;
      // Nothing simple is left if no function of the signals explains most of it.
      if (tie && !(FlexibleGain(ladder.view, base) > kLargerPart)) break;
      as_tied = AsTied{base, ladder.view, ladder.notes};
    }
  }
  if (!ladder.rungs.empty() && ladder.rungs.back().open)  // the limit on rungs was reached
    TakeBack(ladder.rungs.size() - 1, &ladder, &base);
  if (given && (ladder.rungs.empty() || ladder.rungs.front().named.empty()))
    RestoreConstants(std::move(*given), &ladder, &base);
  ladder.final_trial = base;
  if (base.judged) {
    ladder.flexible_gain = FlexibleGain(ladder.view, base);
    ladder.complete = !LeavesMore(ladder.view, base, ladder.noise_floor);
  }
  return ladder;
}

}  // namespace armcmc::ladder
