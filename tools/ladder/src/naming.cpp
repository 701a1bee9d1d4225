#include "naming.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <utility>

#include "bent_law.hpp"
#include "comparison.hpp"
#include "confirmation.hpp"
#include "constants.hpp"
#include "curves.hpp"
#include "derived_noise.hpp"
#include "motion_rival.hpp"
#include "plain_rivals.hpp"
#include "rung.hpp"
#include "start_alone.hpp"

namespace armcmc::ladder {
namespace {

/// What was named on the rungs before.
struct Before {
  const std::vector<const Candidate*>& effects;
  double explained = 0.0;  ///< Squared error that it removed, relative to what remains.

  /// The named effect that acts like this one; null if none does.
  [[nodiscard]] const Candidate* Like(const Contender& c) const {
    const auto alike = std::find_if(effects.begin(), effects.end(),
                                    [&](const Candidate* e) { return AreKin(*e->entry, *c.candidate.entry); });
    return alike == effects.end() ? nullptr : *alike;
  }
  /// Whether an effect of another family is so small compared with it that an error of its formula would explain it.
  [[nodiscard]] bool Dwarfs(const Contender& c) const {
    constexpr double kFormulaError = 1.0 / 3.0;  // of the amplitude: formulas for the same physics differ by this much
    return 1.0 - c.alone.folds < kFormulaError * kFormulaError * explained &&
           std::none_of(effects.begin(), effects.end(),
                        [&](const Candidate* e) { return e->entry->family == c.candidate.entry->family; });
  }
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
  Before before;

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
    if (rival || !before.Dwarfs(c)) return rival;
    if (const Candidate* like = before.Like(c))
      return Rival{like->entry->name + " had another formula", "acts alike and is three times as large"};
    return curves.BendOf(c, before.effects);
  }
};

/// Gives a name unless a rival rules it out.
void NameOne(const View& view, double floor, bool open, Rivals* rivals, Rung* rung, std::vector<std::string>* notes) {
  for (bool again = true; again;) {
    again = false;
    Name(view, floor, open, rung);
    for (const std::size_t i : rung->named) {
      Contender& c = rung->contenders[i];
      const std::optional<Rival> rival = rivals->Of(c, floor, !LeavesMore(view, c.trial, floor), open);
      if (!rival) continue;
      c.ruled_out = again = true;
      if (rung->as_if.empty()) rung->as_if = rival->as_if;
      notes->push_back(c.candidate.entry->name + " was not named: it acts as if " + rival->as_if + ", which " +
                       rival->why);
    }
  }
}

/// Gives a name unless a rival rules it out or the held-out data contradict it.
void NameWith(const NameChecks& checks, Rivals* rivals, Rung* rung, std::vector<std::string>* notes) {
  double gained = 0.0;  // most of what is withdrawn
  for (bool contradicted = false;;) {
    NameOne(rung->view, checks.floor, false, rivals, rung, notes);
    // Of two effects of the same size neither explains the larger part: the first may be named if the next completes
    // it.
    if (rung->named.empty() && checks.open == nullptr && !contradicted) {
      NameOne(rung->view, checks.floor, true, rivals, rung, notes);
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
    const Rung* const open = checks.open;
    const double left = leader.alone.folds * (open != nullptr ? open->leader().alone.folds : 1.0);
    const HeldOutErrors apart = ConfirmOnHeldOut(checks.all, open != nullptr ? open->base : rung->base, leader.trial,
                                                 1.0 - left, NoiseIn(rung->view, leader.trial, checks.floor));
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
    leader.earned = rung->open = false;
    rung->named.clear();
    contradicted = true;
  }
}

}  // namespace

void NameAndConfirm(const NameChecks& checks, Rung* rung, std::vector<std::string>* notes) {
  const View& view = rung->view;
  const Trial& base = rung->base;
  const auto& [all, data, own, plant, scales, floor, open, named, explained] = checks;
  Rivals rivals{{own, plant, data, view, base, scales},
                {plant, data, view, base},
                {plant, data, view, base, scales},
                {plant, data, view, base, scales},
                {plant, data, view, base, scales, rung->contenders},
                {plant, data, view, base, scales},
                view,
                base,
                {named, explained}};
  NameWith(checks, &rivals, rung, notes);
  if (named.empty() && rung->named.empty() && rung->as_if.empty() && LeavesMore(view, base, floor))
    rung->as_if = rivals.curves.Best();
}

}  // namespace armcmc::ladder
