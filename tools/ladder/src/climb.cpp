#include "armcmc/ladder/climb.hpp"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <optional>
#include <set>
#include <utility>

#include "bootstrap.hpp"
#include "comparison.hpp"
#include "free_starts.hpp"
#include "naming.hpp"
#include "open_tie.hpp"
#include "reselect.hpp"
#include "rung.hpp"
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
Eigen::VectorXd SmoothBut(const Trial& base) {
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
void GiveBackConstants(AsGiven given, Ladder* ladder, Trial* base) {
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

/// Names effects one after the other.
class Climber {
 public:
  explicit Climber(const ClimbRequest& request) : request_(request), progress_(request) {
    ladder_.entries = std::make_shared<const std::vector<EffectEntry>>(request.entries);
    ladder_.plant = request.plant;
    data_ = Compared(*ladder_.plant, request.data, request.most_simulated);
  }

  Ladder Run();

 private:
  enum class Next { kRung, kEnd };
  /// Fits the plant without additions. @return whether its law has a finite value.
  bool FitBase();
  /// Names effects above those that are named, until nothing earns a name.
  void NameMore();
  /// Tries one rung above those that are named.
  Next Step();
  /// What follows when a rung has been given its name, or none.
  Next Take(Rung rung, const DataScales& scales);
  /// Whether something may be named above the tie.
  Next AboveTie();
  /// Tests the names again, each with those that follow it in the model. @return whether one was replaced or dropped
  /// and more may be named.
  bool NameAgain();
  /// Repeats the first rung, which named nothing, with the constants of the plant fitted, if that removes enough.
  bool FreeConstantsFor(Rung* rung, const DataScales& scales);

  const ClimbRequest& request_;
  SharedProgress progress_;
  Ladder ladder_;
  Dataset data_;  ///< The rows on which models are compared.
  Trial base_;
  std::set<std::string> families_;
  int again_ = 2;  ///< Rungs that may be repeated from a better fit.
  PlantDescription own_ = request_.plant->description();
  Trial start_;                   ///< Base of the first rung.
  std::optional<AsGiven> given_;  ///< The first rung, if it is repeated with other constants.
  std::vector<std::string> first_notes_;
  std::optional<OpenTie> tied_;
  std::optional<AsTied> as_tied_;   ///< If a rung is tried above the tie.
  std::vector<Candidate> dropped_;  ///< Effects that were named and did not hold.
};

Ladder Climber::Run() {
  constexpr int kMostChanges = 4;
  if (!FitBase()) return std::move(ladder_);
  NameMore();
  for (int k = 0; k < kMostChanges && NameAgain(); ++k) NameMore();
  if (given_ && (ladder_.rungs.empty() || ladder_.rungs.front().named.empty()))
    GiveBackConstants(std::move(*given_), &ladder_, &base_);
  ladder_.final_trial = base_;
  if (base_.judged) {
    ladder_.flexible_gain = FlexibleGain(ladder_.view, base_);
    ladder_.complete = !LeavesMore(ladder_.view, base_, ladder_.noise_floor);
  }
  return std::move(ladder_);
}

bool Climber::FitBase() {
  progress_.Tell("fitting the model as it is", 0.0);
  base_ = FitAlone(ladder_.plant, &data_);
  if (!base_.fit.valid) {
    ladder_.notes.push_back("the law has no finite value at any start: nothing was compared");
    return false;
  }
  ladder_.noise_floor = request_.known_noise > 0.0 ? request_.known_noise
                                                   : request_.noise_over_differences *
                                                         NoiseFloor(data_, SmoothBut(base_), base_.model->active());
  if (std::shared_ptr<const Plant> freed = WithFreeStarts(base_, data_, ladder_.noise_floor)) {
    Eigen::VectorXd theta = identify::TrajectoryModel(freed, data_.series).Start();
    theta.head(base_.fit.theta.size()) = base_.fit.theta;
    if (Trial free = Refine(freed, data_, theta); free.fit.valid) {
      ladder_.plant = std::move(freed);
      base_ = std::move(free);
    }
  }
  ladder_.base = start_ = base_;
  first_notes_ = ladder_.notes;
  return true;
}

void Climber::NameMore() {
  while (ladder_.rungs.size() < static_cast<std::size_t>(request_.max_rungs))
    if (Step() == Next::kEnd) break;
  if (!ladder_.rungs.empty() && ladder_.rungs.back().open)  // the limit on rungs was reached
    TakeBack(ladder_.rungs.size() - 1, &ladder_, &base_);
}

Climber::Next Climber::Step() {
  const std::string which = "rung " + std::to_string(ladder_.rungs.size() + 1);
  const double share = static_cast<double>(ladder_.rungs.size()) / request_.max_rungs;
  const bool first = ladder_.rungs.empty();
  const double floor = ladder_.noise_floor;
  const DataScales scales = ScalesOf(data_, ladder_.plant->description(), floor);
  ladder_.view = MakeView(data_, *base_.model, base_.fit.theta, scales.period);
  LeaveOut(ladder_.view, &base_);
  if (first && !given_) ladder_.base = base_;
  Rung rung;
  rung.base = base_;
  rung.view = ladder_.view;
  AddCandidates(*ladder_.entries, scales, &rung, &ladder_.notes);
  progress_.Tell(which + ": fitting " + std::to_string(rung.contenders.size()) + " effects", share);
  TryAll(ladder_.plant, data_, ladder_.view, floor, &rung, &ladder_.notes);
  if (Trial better = BetterBase(ladder_.plant, data_, rung); better.fit.valid && again_ > 0) {
    base_ = std::move(better);
    --again_;
    return Next::kRung;
  }
  Bootstrap(&rung);
  const Rung* const open = !first && ladder_.rungs.back().open ? &ladder_.rungs.back() : nullptr;
  Judge(ladder_.view, floor, families_, open != nullptr ? open->leader().alone.folds : 1.0, &rung);
  Sort(&rung);
  std::vector<const Candidate*> before;
  for (const Rung& earlier : ladder_.rungs) before.push_back(&earlier.leader().candidate);
  if (first) start_ = base_;
  const double explained = std::pow(start_.fit.error_sd / base_.fit.error_sd, 2) - 1.0;
  NameAndConfirm({request_.data, data_, own_, ladder_.plant, scales, floor, open, std::move(before), explained}, &rung,
                 &ladder_.notes);
  if (first && rung.named.empty() && !given_ && LeavesMore(ladder_.view, base_, floor)) {
    progress_.Tell(which + ": fitting constants", share);
    if (FreeConstantsFor(&rung, scales)) return Next::kRung;
  }
  return Take(std::move(rung), scales);
}

bool Climber::FreeConstantsFor(Rung* rung, const DataScales& scales) {
  ladder_.free_constants = Corrected(own_, ladder_.plant, data_, ladder_.view, scales, *rung);
  if (!ladder_.free_constants) return false;
  given_ = AsGiven{std::move(*rung), std::exchange(ladder_.plant, ladder_.free_constants->plant),
                   std::exchange(ladder_.notes, first_notes_)};
  base_ = ladder_.free_constants->trial;
  own_.constants.clear();  // fitted: no rivals any more
  return true;
}

Climber::Next Climber::Take(Rung rung, const DataScales& scales) {
  const bool named = !rung.named.empty(), tie = rung.named.size() > 1;
  const bool open = !ladder_.rungs.empty() && ladder_.rungs.back().open;
  if (!named && open) {
    TakeBack(ladder_.rungs.size() - 1, &ladder_, &base_);
    return Next::kEnd;
  }
  // What is named above a tie must not depend on which of its effects is present, nor on what may follow.
  if (tied_ && (!named || rung.open || NamedAgain(ladder_, rung) != nullptr ||
                !tied_->Extend(data_, ladder_.view, scales, ladder_.noise_floor, families_, rung))) {
    base_ = std::move(as_tied_->base);
    ladder_.view = std::move(as_tied_->view);
    ladder_.notes = std::move(as_tied_->notes);
    return Next::kEnd;
  }
  if (const Contender* second = NamedAgain(ladder_, rung)) {
    ladder_.notes.push_back(second->candidate.entry->name +
                            " was not named: one alone does not do, and two of them in one place are pieces of "
                            "something that has another formula");
    TakeBack(FirstWith(ladder_, second->candidate), &ladder_, &base_);
    return Next::kEnd;
  }
  if (named && open) ladder_.rungs.back().open = false;
  ladder_.rungs.push_back(std::move(rung));
  if (!named) return Next::kEnd;
  if (tied_)
    tied_->Settle(&ladder_);
  else
    DropSuperseded(data_, &ladder_);
  const Contender& leader = ladder_.rungs.back().leader();
  ladder_.plant = leader.candidate.plant;
  families_.insert(leader.candidate.entry->family);
  base_ = leader.trial;
  if (tied_ && tied_->decided()) tied_.reset();
  if (tie && (tied_ || ladder_.rungs.back().open)) return Next::kEnd;
  if (tie) tied_.emplace(ladder_.rungs.size() - 1, ladder_.rungs.back());
  return tied_ ? AboveTie() : Next::kRung;
}

Climber::Next Climber::AboveTie() {
  if (!LeavesMore(ladder_.view, base_, ladder_.noise_floor)) return Next::kEnd;
  // Nothing simple is left if no function of the signals explains most of it.
  const bool tie = ladder_.rungs.back().named.size() > 1;
  if (tie && !(FlexibleGain(ladder_.view, base_) > kLargerPart)) return Next::kEnd;
  as_tied_ = AsTied{base_, ladder_.view, ladder_.notes};
  return Next::kRung;
}

bool Climber::NameAgain() {
  const Again again{request_.data, data_, own_, ladder_.noise_floor, start_.fit.error_sd};
  if (!Reselect(again, base_, &dropped_, &ladder_)) return false;
  tied_.reset();
  families_.clear();
  for (const Rung& rung : ladder_.rungs) families_.insert(rung.leader().candidate.entry->family);
  const Rung& last = ladder_.rungs.back();
  ladder_.plant = last.leader().candidate.plant;
  ladder_.view = last.view;
  base_ = last.leader().trial;
  if (last.named.size() < 2) return true;
  tied_.emplace(ladder_.rungs.size() - 1, last);
  return AboveTie() == Next::kRung;
}

}  // namespace

Ladder Climb(const ClimbRequest& request) { return Climber(request).Run(); }

}  // namespace armcmc::ladder
