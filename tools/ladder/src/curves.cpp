#include "curves.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "action.hpp"
#include "armcmc/ladder/features.hpp"
#include "armcmc/plant/error.hpp"
#include "armcmc/support/parallel.hpp"
#include "comparison.hpp"
#include "one_step.hpp"

namespace armcmc::ladder {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr int kBumps = 8;
constexpr std::size_t kFitted = 4;  // number of curves, each with a different action
constexpr double kAsMuch = 0.9;     // share of what an effect explains
constexpr double kAsWell = 1.5;     // times the error of the best curve
constexpr double kOff = 0.1;        // share of the squared error that an effect leaves: accepted error of its copy

/// @param x     Quantity that the curve follows; "t" is time, "law" the value of the law.
/// @param unit  Unit of the curve.
/// @param size  Prior scale of its coefficients.
EffectForm Along(const std::string& x, const std::string& unit, const std::string& size, EffectTerm term,
                 std::vector<EffectNeed> needs) {
  const bool time = x == "t";
  const std::string scale = x == "law" ? "output" : x;
  const std::string of_x = time ? "s" : scale, low = time ? "start" : "low_" + scale;
  const std::string spacing = (time ? "record/" : "range_" + scale + '/') + std::to_string(kBumps - 1);
  EffectForm form;
  form.variant = true;  // all forms are tried
  form.needs = std::move(needs);
  form.constants.push_back({"w", of_x, "2.4*" + spacing});
  for (int k = 0; k < kBumps; ++k) {
    const std::string number = std::to_string(k + 1);
    std::string middle = low;
    middle.append(" + ").append(std::to_string(k)).append("*").append(spacing);
    form.constants.push_back({"m" + number, of_x, std::move(middle)});
    form.parameters.push_back({"c" + number, unit, "normal", "0", size, "", "", "0"});
    if (!term.formula.empty()) term.formula += " + ";
    term.formula.append("c").append(number).append("*max(1 - ((").append(x);
    term.formula.append(" - m").append(number).append(")/w)^2, 0)^4");
  }
  form.terms.push_back(std::move(term));
  return form;
}

EffectNeed Need(const std::string& name, const std::string& kind) {
  EffectNeed need;
  need.name = name;
  need.kind = kind;
  return need;
}

EffectNeed Used(const std::string& name, const std::string& kind) {
  EffectNeed need = Need(name, kind);
  need.used = true;
  return need;
}

/// Name of the signal or state that a curve follows; "t" is time, "law" the value of the law.
std::string FollowedBy(const Contender& curve) {
  const EffectForm& form = curve.candidate.form();
  if (form.terms.front().slot == "law") return "law";
  // The need that is not the parameter is the quantity followed.
  const bool over_time = form.needs.size() == (form.terms.front().slot == "parameter" ? 1 : 0);
  return over_time ? "t" : curve.candidate.binding.symbols.at(form.needs.back().name);
}

/// "K followed w by a curve"
std::string AsIf(const Contender& curve) {
  const EffectTerm& term = curve.candidate.form().terms.front();
  const std::map<std::string, std::string>& symbols = curve.candidate.binding.symbols;
  const std::string name = FollowedBy(curve), followed = name == "t" ? "time" : name;
  if (term.slot == "parameter") return symbols.at(term.of) + " followed " + followed + " by a curve";
  if (term.slot == "input") return "the plant got a curve of " + followed;
  if (term.slot == "law") return "a curve of the output were measured";
  return "a curve of " + followed + " were added to the " +
         (term.slot == "rate" ? "rate of " + symbols.at(term.of) : "output");
}

EffectEntry CurveEntry() {
  EffectEntry entry;
  entry.name = entry.family = "curve";
  for (const std::string kind : {"signal", "state"}) {
    const EffectNeed x = Need("x", kind);
    entry.forms.push_back(Along("x", "output", "output", {"output", "", ""}, {x}));
    entry.forms.push_back(Along("x", "p", "p", {"parameter", "p", "p"}, {Used("p", "parameter"), x}));
    entry.forms.push_back(Along("x", "v/s", "rate_v", {"rate", "v", ""}, {Need("v", "state"), x}));
  }
  entry.forms.push_back(Along("t", "output", "output", {"output", "", ""}, {}));
  entry.forms.push_back(Along("t", "p", "p", {"parameter", "p", "p"}, {Used("p", "parameter")}));
  entry.forms.push_back(Along("v", "v/s", "rate_v", {"rate", "v", ""}, {Need("v", "state")}));
  entry.forms.push_back(Along("u", "u", "u", {"input", "u", "u"}, {Used("u", "signal")}));
  entry.forms.push_back(Along("law", "output", "output", {"law", "", "law"}, {}));
  return entry;
}

}  // namespace

Curves::Curves(const std::shared_ptr<const Plant>& plant, const Dataset& data, const View& view, const Trial& base,
               const DataScales& scales)
    : plant_(plant), data_(data), view_(view), base_(base), scales_(scales), entries_{CurveEntry()} {}

std::vector<Candidate> Curves::MostPromising() const {
  const DataScales scales = WithRanges(scales_, FeaturesOf(*base_.model, base_.fit.theta), view_.active_rows);
  std::vector<std::string> notes;  // curves beyond a limit of plants are no rivals
  std::vector<Candidate> all = Candidates(plant_->description(), entries_, scales, &notes);
  std::erase_if(all, [&](const Candidate& candidate) {
    const auto& symbols = candidate.binding.symbols;
    return std::any_of(symbols.begin(), symbols.end(),
                       [&](const auto& symbol) { return IsExplained(plant_->description(), symbol.second); });
  });
  return BestByOneStep(std::move(all), kFitted, plant_, data_, base_);
}

void Curves::FitRivals() {
  fitted_.emplace();
  for (Candidate& candidate : MostPromising())
    fitted_->push_back({std::move(candidate), {}, false, 0.0, {}, {}, 0.0, 0.0, false, false, false});
  const VectorXd error = base_.model->target() - base_.fit.prediction;
  support::InParallel(fitted_->size(), [&](std::size_t i) {
    Contender& c = (*fitted_)[i];
    try {
      c.trial = Try(c.candidate.plant, SubsetForFits(*c.candidate.plant, data_, error), base_.fit.theta, 1);
      if (c.trial.fit.valid) c.trial = Refine(c.candidate.plant, data_, c.trial.fit.theta);
      c.refined = c.trial.fit.valid;
      c.closed = c.refined ? 1.0 - std::pow(c.trial.fit.error_sd / base_.fit.error_sd, 2) : 0.0;
    } catch (const PlantError&) {  // beyond the limits of a plant
    }
  });
  std::stable_sort(fitted_->begin(), fitted_->end(),
                   [](const Contender& a, const Contender& b) { return a.closed > b.closed; });
}

bool Curves::Holds(const Contender& curve, const Contender& c) const {
  // A curve without memory that explains more rules out an effect with memory.
  if (Remembers(c.candidate)) return false;
  if (ActOnSameQuantity(c.candidate, curve.candidate)) return true;
  if (!Reads(c.candidate, FollowedBy(curve)) && !ActsOnLaw(c.candidate)) return false;
  const std::vector<Index>& rows = view_.active_rows;
  const VectorXd apart = (c.trial.fit.prediction - curve.trial.fit.prediction)(rows);
  const VectorXd base = (base_.model->target() - base_.fit.prediction)(rows);
  const Eigen::MatrixXd columns = curve.trial.fit.jacobian(rows, Eigen::all);
  const VectorXd off = LeftOf(apart, columns, VectorXd::Zero(columns.cols()));
  return off.squaredNorm() < kOff * c.alone.folds * base.squaredNorm();
}

void Curves::Judge(Contender* curve) {
  if (curve->trial.judged) return;
  LeaveOut(view_, &curve->trial);
  curve->alone = Compare(view_, *curve, base_, false);
}

std::optional<Rival> Curves::BendOf(const Contender& c, const std::vector<const Candidate*>& before) {
  if (!fitted_) FitRivals();
  for (Contender& curve : *fitted_) {
    const std::string followed = FollowedBy(curve);
    const auto bent =
        std::find_if(before.begin(), before.end(), [&](const Candidate* b) { return Reads(*b, followed); });
    if (!curve.refined || bent == before.end() || curve.closed < kAsMuch * c.closed) continue;
    Judge(&curve);
    if (1.0 - curve.alone.folds < kAsMuch * (1.0 - c.alone.folds)) continue;
    return Rival{AsIf(curve), "explains as much; the formula of " + (*bent)->entry->name + " may be as little off"};
  }
  return std::nullopt;
}

std::string Curves::Best() {
  if (!fitted_) FitRivals();
  if (fitted_->empty() || fitted_->front().closed < kLargerPart) return "";
  Contender& best = fitted_->front();
  Judge(&best);
  return best.alone.folds < kLargerPart && best.alone.blocks < 1.0 ? AsIf(best) : "";
}

std::optional<Rival> Curves::RivalOf(const Contender& c, bool smaller_part) {
  if (!fitted_) FitRivals();
  if (fitted_->empty()) return std::nullopt;
  // The best curve and those nearly as good: often several act alike, and one that represents the effect is enough.
  const double left = kAsWell * (1.0 - fitted_->front().closed);
  std::optional<Rival> rival;
  for (Contender& curve : *fitted_) {
    // A curve that is not far better on the fitted rows is not far better on left-out rows either.
    if (!curve.refined || 1.0 - curve.closed > left || 1.0 - c.closed < kFarBetter * (1.0 - curve.closed)) continue;
    // The curve is the same physics with a better formula. But one curve is simpler than two effects.
    if (!smaller_part && Holds(curve, c)) return std::nullopt;
    if (rival) continue;
    Judge(&curve);
    const double times = c.alone.folds / std::max(curve.alone.folds, 1e-12);
    // A curve need not be better where it extrapolates, but it must not be worse.
    if (times < kFarBetter || curve.alone.blocks > c.alone.blocks || curve.alone.regions > 1.0) continue;
    rival = Rival{AsIf(curve), LeavesLessText(times) + ", and has another shape"};
  }
  return rival;
}

}  // namespace armcmc::ladder
