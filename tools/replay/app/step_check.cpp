#include "step_check.hpp"

#include <cmath>

#include "armcmc/identify/step_error.hpp"
#include "armcmc/plant/error.hpp"
#include "armcmc/plant/program.hpp"
#include "armcmc/plant/states.hpp"

namespace armcmc::replay {
namespace {

constexpr std::size_t kMostRows = 4000;

/// What is reported under a name by the first mode that reports it; NaN: by none.
double Reported(const Estimator& estimator, const Estimate& last, const std::string& name) {
  for (int m = 0; m < estimator.num_modes(); ++m)
    for (int i = 0; i < estimator.num_reported(); ++i)
      if (estimator.reported(i).name == name && last.modes[static_cast<std::size_t>(m)].known)
        return last.modes[static_cast<std::size_t>(m)].marginal[static_cast<std::size_t>(i)].ar_ap;
  return std::nan("");
}

}  // namespace

StepCheck::StepCheck(std::shared_ptr<const PlantProgram> plant, int overlap)
    : plant_(std::move(plant)), overlap_(overlap) {
  if (plant_ == nullptr || plant_->plant().states().empty()) {
    plant_ = nullptr;
    return;
  }
  series_.signals.resize(plant_->plant().description().signals.size());
}

void StepCheck::Add(const DataPack& pack) {
  if (plant_ == nullptr || series_.num_rows() >= kMostRows || pack.seq % overlap_ != 0) return;
  if (pack.seq != last_seq_ + overlap_ || pack.run_id != last_run_ || series_.runs.empty())
    series_.runs.push_back(series_.num_rows());
  last_seq_ = pack.seq;
  last_run_ = pack.run_id;
  series_.dt = pack.dt;
  PlantSignals signals{};
  for (int n = 0; n < pack.num_samples; ++n) {
    SignalsAt(pack, n, plant_->plant().output(), &signals);
    series_.t.push_back(pack.t_last_s - (pack.num_samples - 1 - n) * pack.dt);
    for (std::size_t s = 0; s < series_.signals.size(); ++s) series_.signals[s].push_back(signals[s]);
  }
}

std::string StepCheck::Warning(const Estimator& estimator, const Estimate& last) const try {
  if (plant_ == nullptr || series_.num_rows() == 0) return "";
  const auto plant = std::make_shared<const Plant>(plant_->plant().description());
  const identify::TrajectoryModel model(plant, std::make_shared<const identify::Series>(series_));
  Eigen::VectorXd theta(model.num_parameters());
  for (Eigen::Index d = 0; d < theta.size(); ++d) {
    const ParameterDescription& p = model.parameters()[static_cast<std::size_t>(d)];
    const double value = Reported(estimator, last, p.name);
    theta[d] = p.prior == "lognormal" ? std::log(value) : value;
  }
  const double noise_sd = last.modes[0].noise_std;
  if (!theta.allFinite() || !(noise_sd > 0.0)) return "";
  return identify::StepErrorText(identify::StepErrorOf(*plant, series_, theta, noise_sd), series_.dt, noise_sd);
} catch (const PlantError&) {
  return "";  // the estimator can run more than whole recordings can
}

}  // namespace armcmc::replay
