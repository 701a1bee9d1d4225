#include "superseded.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>

#include "comparison.hpp"

namespace armcmc::ladder {
namespace {

double LeftOutSquares(const View& view, const Trial& trial) {
  double sum = 0.0;
  for (std::size_t g = 0; g < trial.alone.size(); ++g)
    if (view.groups[g].kind == GroupKind::kFold) sum += trial.alone[g];
  return sum;
}

/// Whether two formulas of one effect act on the same quantities.
bool SameElsewise(const Candidate& a, const Candidate& b) {
  return a.entry == b.entry && a.binding.form != b.binding.form && a.binding.symbols == b.binding.symbols &&
         a.form().terms.front().slot == b.form().terms.front().slot;
}

/// The formula that was named last, as the only one, from the fit in which it was named.
Trial Alone(const Contender& there, const Trial& base, const Contender& last, const Dataset& data) {
  const Eigen::VectorXd& known = last.trial.fit.theta;
  const auto own = static_cast<Eigen::Index>(there.candidate.form().parameters.size()), law = base.fit.theta.size();
  Eigen::VectorXd theta = there.trial.fit.theta;
  if (theta.size() == law + own) theta << known.head(law), known.tail(own);
  return Refine(there.candidate.plant, data, theta);
}

}  // namespace

void DropSuperseded(const Dataset& data, Ladder* ladder) {
  if (ladder->rungs.size() < 2) return;
  const Rung& last = ladder->rungs.back();
  Rung& before = ladder->rungs[ladder->rungs.size() - 2];
  if (last.named.size() != 1 || before.named.size() != 1) return;
  const Contender& formula = last.leader();
  if (!SameElsewise(formula.candidate, before.leader().candidate)) return;
  const auto there = std::find_if(before.contenders.begin(), before.contenders.end(), [&](const Contender& c) {
    return c.candidate.entry == formula.candidate.entry && c.candidate.binding.form == formula.candidate.binding.form &&
           c.candidate.binding.symbols == formula.candidate.binding.symbols;
  });
  if (there == before.contenders.end() || !there->trial.fit.valid) return;
  Trial alone = Alone(*there, before.base, formula, data);
  if (!alone.fit.valid) return;
  LeaveOut(before.view, &alone);
  if (LeftOutSquares(before.view, alone) > kExplainsIt * LeftOutSquares(last.view, formula.trial)) return;
  const std::string& name = formula.candidate.entry->name;
  ladder->notes.push_back(name + " is named once: with its second formula the first is not needed");
  there->trial = std::move(alone);
  there->refined = there->has_evidence = true;
  there->closed = std::clamp(1.0 - std::pow(there->trial.fit.error_sd / before.base.fit.error_sd, 2), 0.0, 1.0);
  there->alone = Compare(before.view, *there, before.base, false);
  there->with_flexible = Compare(before.view, *there, before.base, true);
  before.named = {static_cast<std::size_t>(there - before.contenders.begin())};
  before.open = last.open;
  ladder->rungs.pop_back();
  ladder->view = ladder->rungs.back().view;
}

}  // namespace armcmc::ladder
