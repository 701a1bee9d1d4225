// Fits of the effects that are tried on a rung.
#include <algorithm>
#include <array>
#include <optional>
#include <set>

#include "armcmc/plant/error.hpp"
#include "armcmc/support/parallel.hpp"
#include "comparison.hpp"
#include "rung.hpp"

namespace armcmc::ladder {
namespace {

constexpr std::size_t kMostJudged =
    8;  // candidates of a rung that are judged, best first: those far behind are not named anyway
constexpr std::size_t kAnywhere = 8;  // starting points for all parameters of a simulated plant

/// Number of starting points: one if only amplitudes are fitted, in which laws are linear; more for shape parameters.
std::size_t StartsFor(const Contender& c) {
  constexpr std::size_t kOfShape = 8;
  const std::vector<EffectParameter>& parameters = c.candidate.form().parameters;
  const bool shape =
      std::any_of(parameters.begin(), parameters.end(), [](const EffectParameter& p) { return p.none != "0"; });
  return shape ? kOfShape : 1;
}

/// The current model on a part of the data.
struct SubsetBase {
  Dataset data;
  double square;  ///< Mean squared error.
};

}  // namespace

void TryAll(const std::shared_ptr<const Plant>& plant, const Dataset& data, const View& view, double floor,
            const std::set<std::string>* above_tie, Rung* rung, std::vector<std::string>* notes) {
  constexpr double kWorthIt = 0.25, kNoGain = 0.05;
  constexpr double kNoiseAlone = 1.2, kMoreThanNoise = 1.5;  // times its square
  constexpr double kMostOfIt = 0.25;                         // of the variance of the output
  std::vector<Contender>& all = rung->contenders;
  const Eigen::VectorXd error = rung->base.model->target() - rung->base.fit.prediction;
  // Candidates with memory are tried on another part of the data than those without.
  std::array<std::optional<SubsetBase>, 2> bases;
  const auto quick = [&](const Contender& c) -> std::optional<SubsetBase>& {
    return bases[Remembers(*c.candidate.plant) ? 1 : 0];
  };
  for (const Contender& c : all)
    if (std::optional<SubsetBase>& base = quick(c); !base) {
      base.emplace(SubsetBase{SubsetForFits(*c.candidate.plant, data, error), 0.0});
      base->square = MeanSquare(Refine(plant, base->data, rung->base.fit.theta));
      // An effect with a later onset does not show at the start of runs.
      if (base->square < kNoiseAlone * floor * floor && MeanSquare(rung->base) > kMoreThanNoise * floor * floor)
        base.emplace(SubsetBase{data, MeanSquare(rung->base)});
    }
  // Starts from the parameters in `known`, or from several points if it is empty.
  const auto try_from = [&](const Eigen::VectorXd& known, std::size_t starts, Contender* c) {
    Trial trial = Try(c->candidate.plant, quick(*c)->data, known, starts, c->candidate.Frequencies());
    if (!trial.fit.valid || (c->trial.fit.valid && !(trial.fit.cost < c->trial.fit.cost))) return;
    c->trial = std::move(trial);
    c->closed = std::clamp(1.0 - MeanSquare(c->trial) / quick(*c)->square, 0.0, 1.0);
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
  // What gains less than half of what a name needs is not worth a fit to all rows.
  const double beyond_noise = 1.0 - std::min(1.0, NoiseIn(view, rung->base, floor) / MeanSquare(rung->base));
  const auto worth_fitting = [&](const Contender& c, double share) {
    const bool larger_part = above_tie != nullptr && !above_tie->contains(c.candidate.entry->family);
    return c.closed >= std::max(share, 0.5 * (larger_part ? kLargerPart * beyond_noise : kLeastGain));
  };
  const double quick_best = best_closing();
  support::InParallel(all.size(), [&](std::size_t i) {
    if (!all[i].trial.fit.valid || !worth_fitting(all[i], kWorthIt * quick_best)) return;
    // What is missing may have distorted the fit of a simulated plant so much that no fit recovers from there.
    if (simulated && !from_anywhere) try_from({}, kAnywhere, &all[i]);
    all[i].trial = Refine(all[i].candidate.plant, data, all[i].trial.fit.theta);
    all[i].refined = all[i].trial.fit.valid;
    all[i].closed =
        all[i].refined ? std::clamp(1.0 - MeanSquare(all[i].trial) / MeanSquare(rung->base), 0.0, 1.0) : 0.0;
  });
  const double best = best_closing();
  // Those with the largest gain are judged, a simple one before a larger one with the same gain.
  std::vector<std::size_t> judged;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (all[i].refined && worth_fitting(all[i], 2.0 * kWorthIt * best)) judged.push_back(i);
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

}  // namespace armcmc::ladder
