#include "armcmc/replay/estimate_csv.hpp"

#include <array>
#include <cmath>
#include <cstdio>
#include <string_view>

namespace armcmc::replay {
namespace {

constexpr std::array<const char*, 9> kMarginalColumns = {"",     "_ap",  "_sd",   "_q025",      "_q25",
                                                         "_q50", "_q75", "_q975", "_chain_mean"};

std::array<double, 9> MarginalValues(const MarginalSummary& m) {
  return {m.ar_map, m.ar_ap, m.sd, m.q025, m.q25, m.q50, m.q75, m.q975, m.chain_mean};
}

constexpr std::string_view kStepColumns =
    "lambda,zeta,decision,draws,k_min,ess,kish_ess,acceptance,log_evidence,p_changed,noise_std,"
    "y_pred,y_lo,y_hi,y_free_run,y_rmse";

std::string_view Name(Decision decision) {
  switch (decision) {
    case Decision::kHold: return "hold";
    case Decision::kReinforcement: return "reinforcement";
    case Decision::kModification: return "modification";
  }
  return "";
}

}  // namespace

EstimateCsv::EstimateCsv(const Estimator& estimator, std::ostream* out) : estimator_(estimator), out_(out) {
  *out_ << "pack,t,mode";
  for (int i = 0; i < estimator.num_reported(); ++i)
    for (const char* suffix : kMarginalColumns) *out_ << ',' << estimator.reported(i).name << suffix;
  *out_ << ',' << kStepColumns << ",p_drifted";
  for (int i = 0; i < estimator.num_reported(); ++i) *out_ << ',' << estimator.reported(i).name << "_drift_per_s";
  if (estimator.num_modes() > 1) {
    for (int mode = 0; mode < estimator.num_modes(); ++mode) {
      for (int i = 0; i < estimator.num_reported(); ++i)
        for (const char* suffix : {"", "_sd"})
          *out_ << ',' << estimator.reported(i).name << '_' << estimator.mode_name(mode) << suffix;
      *out_ << ",draws_" << estimator.mode_name(mode);
    }
  }
  *out_ << '\n';
}

void EstimateCsv::Text(std::string_view text) {
  if (!row_.empty()) row_ += ',';
  row_ += text;
}

void EstimateCsv::Number(double value) {
  std::array<char, 32> text{};
  if (!std::isnan(value)) std::snprintf(text.data(), text.size(), "%.17g", value);
  Text(text.data());
}

void EstimateCsv::NumberIf(bool condition, double value) { Number(condition ? value : std::nan("")); }

void EstimateCsv::EndRow() {
  *out_ << row_ << '\n';
  row_.clear();
}

void EstimateCsv::Write(const Estimate& e) {
  const ModeEstimate& mode = e.modes[static_cast<std::size_t>(e.report_mode)];
  Text(std::to_string(e.seq));
  Number(e.t_last_s);
  Text(estimator_.mode_name(e.mode));
  for (int i = 0; i < estimator_.num_reported(); ++i)
    for (const double value : MarginalValues(mode.marginal[static_cast<std::size_t>(i)])) NumberIf(mode.known, value);
  NumberIf(mode.updated, mode.lambda);
  NumberIf(mode.updated, mode.zeta);
  Text(Name(mode.decision));
  Text(std::to_string(mode.draws));
  Text(std::to_string(mode.k_min));
  for (const double value : {mode.ess, mode.kish_ess, mode.acceptance, mode.log_evidence, mode.p_changed})
    NumberIf(mode.updated, value);
  NumberIf(mode.known, mode.noise_std);
  for (const double value : {e.y_pred, e.y_lo, e.y_hi, e.y_free_run, e.y_rmse}) NumberIf(mode.known, value);
  NumberIf(mode.known, mode.p_drifted);
  for (int i = 0; i < estimator_.num_reported(); ++i)
    NumberIf(mode.known, mode.drift_rate[static_cast<std::size_t>(i)]);
  if (estimator_.num_modes() > 1) {
    for (int m = 0; m < estimator_.num_modes(); ++m) {
      const ModeEstimate& one = e.modes[static_cast<std::size_t>(m)];
      for (int i = 0; i < estimator_.num_reported(); ++i) {
        NumberIf(one.known, one.marginal[static_cast<std::size_t>(i)].ar_map);
        NumberIf(one.known, one.marginal[static_cast<std::size_t>(i)].sd);
      }
      Text(std::to_string(one.draws));
    }
  }
  EndRow();
}

}  // namespace armcmc::replay
