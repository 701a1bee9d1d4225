#include "fitted_rivals.hpp"

#include <cstddef>
#include <utility>

#include "armcmc/plant/error.hpp"
#include "armcmc/support/parallel.hpp"
#include "comparison.hpp"

namespace armcmc::ladder {

std::vector<Contender> FittedRivals(std::vector<Candidate> candidates, const Dataset& data, const Trial& base) {
  std::vector<Contender> fitted;
  fitted.reserve(candidates.size());
  for (Candidate& candidate : candidates)
    fitted.push_back({std::move(candidate), {}, false, 0.0, {}, {}, 0.0, 0.0, false, false, false});
  support::InParallel(fitted.size(), [&](std::size_t i) {
    Contender& rival = fitted[i];
    try {
      Eigen::VectorXd theta = identify::TrajectoryModel(rival.candidate.plant, data.series).Start();
      theta.head(base.fit.theta.size()) = base.fit.theta;
      rival.trial = Refine(rival.candidate.plant, data, theta);
      rival.refined = rival.trial.fit.valid;
    } catch (const PlantError&) {  // beyond the limits of a plant
    }
  });
  return fitted;
}

const Contender* FirstThatExplainsAsMuch(std::vector<Contender>* rivals, const View& view, const Trial& base,
                                         const Contender& c) {
  for (Contender& rival : *rivals) {
    if (!rival.refined) continue;
    if (!rival.trial.judged) {
      LeaveOut(view, &rival.trial);
      rival.alone = Compare(view, rival, base, false);
    }
    if (rival.alone.folds <= kExplainsIt * c.alone.folds) return &rival;
  }
  return nullptr;
}

}  // namespace armcmc::ladder
