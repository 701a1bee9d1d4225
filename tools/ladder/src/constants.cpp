#include "constants.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "armcmc/plant/error.hpp"
#include "armcmc/support/parallel.hpp"
#include "comparison.hpp"

namespace armcmc::ladder {
namespace {

constexpr double kConstantOff = 0.05;  // of a constant, at most
constexpr double kWorthAFold = 1.3;    // times that error in the fit itself: beyond, no data left out make up for it

/// A constant times a number about 1.
EffectEntry OffEntry() {
  EffectNeed need;
  need.name = "c";
  need.kind = "constant";
  EffectForm form;
  form.needs = {need};
  const std::string most = std::to_string(kConstantOff);
  form.parameters.push_back({"e", "1", "uniform", "0", "", "-" + most, most, "0"});
  form.terms.push_back({"parameter", "c", "c*(1 + e)"});
  EffectEntry entry;
  entry.name = entry.family = "off";
  entry.forms = {form};
  return entry;
}

/// Of the fit, its data included.
double Square(const Contender& c) { return c.trial.fit.error_sd * c.trial.fit.error_sd; }

}  // namespace

Constants::Constants(const PlantDescription& own, const std::shared_ptr<const Plant>& plant, const Dataset& data,
                     const View& view, const Trial& base, const DataScales& scales)
    : own_(own), plant_(plant), data_(data), view_(view), base_(base), scales_(scales), entries_{OffEntry()} {}

void Constants::FitRivals() {
  fitted_.emplace();
  std::vector<std::string> notes;  // what does not fit a limit is no rival
  Other all;
  PlantDescription together = plant_->description();
  for (Candidate& candidate : Candidates(plant_->description(), entries_, scales_, &notes)) {
    const std::string& name = candidate.binding.symbols.at("c");
    const auto own = std::find_if(own_.constants.begin(), own_.constants.end(),
                                  [&](const ConstantDescription& c) { return c.name == name; });
    if (own == own_.constants.end() || own->value == 0.0) continue;
    const ConstantDescription& constant = *own;
    all.constants.push_back(constant);
    all.contender.candidate = candidate;
    Other one;
    one.constants = {constant};
    one.contender.candidate = std::move(candidate);
    fitted_->push_back(std::move(one));
  }
  if (fitted_->size() > 1) {
    try {
      for (const Other& one : *fitted_)
        together = AddEffect(together, entries_.front(), one.contender.candidate.binding, scales_);
      all.contender.candidate.plant = std::make_shared<const Plant>(std::move(together));
      fitted_->push_back(std::move(all));
    } catch (const PlantError&) {  // needs more than there is room for
    }
  }
  FitFrom(base_.fit.theta);
}

void Constants::FitOne(const Eigen::VectorXd& own, Other* other) const {
  Contender& c = other->contender;
  try {
    Eigen::VectorXd theta = identify::TrajectoryModel(c.candidate.plant, data_.series).Start();
    theta.head(own.size()) = own;
    Trial trial = Refine(c.candidate.plant, data_, theta);
    if (!trial.fit.valid || (c.refined && !(trial.fit.cost < c.trial.fit.cost))) return;
    c.trial = std::move(trial);
    c.refined = true;
    other->left_out = false;
  } catch (const PlantError&) {  // needs more than there is room for
  }
}

void Constants::FitFrom(const Eigen::VectorXd& own) {
  support::InParallel(fitted_->size(), [&](std::size_t i) { FitOne(own, &(*fitted_)[i]); });
}

std::string Constants::AsIf(const Other& other) {
  const auto count = static_cast<Eigen::Index>(other.constants.size());
  const Eigen::VectorXd off = other.contender.trial.fit.theta.tail(count);
  std::string text;
  for (Eigen::Index k = 0; k < count; ++k) {
    const ConstantDescription& constant = other.constants[static_cast<std::size_t>(k)];
    if (k > 0) text += k + 1 < count ? ", " : " and ";
    char one[160];
    std::snprintf(one, sizeof(one), "%s were %.4g instead of %.4g", constant.name.c_str(),
                  constant.value * (1.0 + off[k]), constant.value);
    text += one;
  }
  return text;
}

std::optional<Rival> Constants::RivalOf(const Contender& c) {
  if (!fitted_) FitRivals();
  // A simulated plant may be stuck in a minimum from which the effect helped it out.
  if (const Eigen::VectorXd own = c.trial.fit.theta.head(base_.fit.theta.size());
      IsSimulated(plant_->description()) && std::find(from_.begin(), from_.end(), own) == from_.end()) {
    from_.push_back(own);
    FitFrom(own);
  }
  for (Other& other : *fitted_) {
    Contender& constant = other.contender;
    if (!constant.refined || Square(constant) > kWorthAFold * Square(c)) continue;
    if (!other.left_out) {
      LeaveOut(view_, &constant.trial);
      constant.alone = Compare(view_, constant, base_, false);
      other.left_out = true;
    }
    if (constant.alone.folds <= kExplainsIt * c.alone.folds) return Rival{AsIf(other), "explains as much"};
  }
  return std::nullopt;
}

}  // namespace armcmc::ladder
