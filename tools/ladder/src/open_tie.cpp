#include "open_tie.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "comparison.hpp"
#include "rung.hpp"

namespace armcmc::ladder {
namespace {

/// The same effect in the same place of another model; empty if there is no room for it.
std::optional<Candidate> SameOn(const PlantDescription& plant, const Candidate& effect,
                                const std::vector<EffectEntry>& entries, const DataScales& scales) {
  std::vector<std::string> notes;
  for (Candidate& candidate : Candidates(plant, entries, scales, &notes))
    if (candidate.entry == effect.entry && candidate.binding.form == effect.binding.form &&
        candidate.binding.symbols == effect.binding.symbols)
      return std::move(candidate);
  return std::nullopt;
}

}  // namespace

OpenTie::OpenTie(std::size_t place, const Rung& rung) : place_(place) {
  for (const std::size_t i : rung.named)
    branches_.push_back({i, rung.contenders[i].candidate, {}, rung.contenders[i].trial});
}

bool OpenTie::Extend(const Dataset& data, const View& view, const DataScales& scales, double floor,
                     const std::set<std::string>& families, const std::vector<EffectEntry>& entries, const Rung& next) {
  const EffectEntry* const entry = next.leader().candidate.entry;
  if (std::any_of(branches_.begin(), branches_.end(), [&](const Branch& b) { return b.effect.entry == entry; }))
    return false;
  Rung compared;  // the branches with the effect, as if each were an effect on top of the first one
  compared.base = next.base;
  std::vector<Contender> added;
  for (std::size_t b = 0; b < branches_.size(); ++b) {
    const Branch& branch = branches_[b];
    Contender with = next.leader();
    if (b > 0) {
      const std::shared_ptr<const Plant> plant =
          std::make_shared<const Plant>(branch.trial.model->plant().description());
      std::optional<Candidate> same = SameOn(plant->description(), with.candidate, entries, scales);
      if (!same) return false;
      Rung alone;
      alone.base = branch.trial;
      LeaveOut(view, &alone.base);
      alone.contenders.push_back({std::move(*same), {}, false, 0.0, {}, {}, 0.0, 0.0, false, false, false});
      std::vector<std::string> notes;
      TryAll(plant, data, view, floor, &families, &alone, &notes);
      Bootstrap(&alone);
      Judge(view, floor, families, 1.0, &alone);
      with = std::move(alone.contenders.front());
      if (!with.has_evidence || !with.larger_part) return false;
    }
    Contender whole = with;
    whole.candidate = branch.effect;
    whole.closed = std::clamp(1.0 - std::pow(with.trial.fit.error_sd / next.base.fit.error_sd, 2), 0.0, 1.0);
    whole.alone = Compare(view, whole, next.base, false);
    compared.contenders.push_back(std::move(whole));
    added.push_back(std::move(with));
  }
  Bootstrap(&compared);
  std::vector<Branch> left;
  for (const std::size_t b : StillTied(compared)) {
    Branch branch = std::move(branches_[b]);
    branch.trial = added[b].trial;
    branch.above.push_back(std::move(added[b]));
    left.push_back(std::move(branch));
  }
  branches_ = std::move(left);
  return true;
}

void OpenTie::ResolveTie(Ladder* ladder) const {
  Rung& rung = ladder->rungs[place_];
  rung.named.clear();
  for (const Branch& branch : branches_) rung.named.push_back(branch.tied);
  for (std::size_t k = 0; k < branches_.front().above.size(); ++k) {
    Rung& later = ladder->rungs[place_ + 1 + k];
    later.contenders[later.named.front()] = branches_.front().above[k];
  }
}

}  // namespace armcmc::ladder
