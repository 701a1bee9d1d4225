#include "armcmc/compare/trace.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <utility>

#include "armcmc/models/registry.hpp"
#include "armcmc/plant/program.hpp"

namespace armcmc::compare {
namespace {

constexpr double kNoSample = std::numeric_limits<double>::quiet_NaN();

QuantityTrace& TraceOf(RunTrace* trace, const Estimator& estimator, int mode, int quantity) {
  return trace->quantities[static_cast<std::size_t>(mode * estimator.num_reported() + quantity)];
}

void NameOutput(const Estimator& estimator, RunTrace* trace) {
  if (const auto& described = estimator.settings().plant; described != nullptr) {
    const Plant& plant = described->plant();
    const SignalDescription& output = plant.description().signals[static_cast<std::size_t>(plant.output())];
    trace->output_name = "output " + output.name;
    trace->output_unit = output.unit;
    return;
  }
  const CompiledPlant& plant = *ModelOf(estimator.plant())->compiled;
  trace->output_name = plant.output_word;
  trace->output_unit = plant.output.unit;
}

void AddMode(const Estimate& e, const Estimator& estimator, int m, RunTrace* trace) {
  const ModeEstimate& mode = e.modes[static_cast<std::size_t>(m)];
  for (int i = 0; i < estimator.num_reported() && mode.known; ++i) {
    const MarginalSummary& q = mode.marginal[static_cast<std::size_t>(i)];
    QuantityTrace& out = TraceOf(trace, estimator, m, i);
    out.last = q.ar_map, out.last_sd = q.sd, out.last_q025 = q.q025, out.last_q975 = q.q975;
    if (!mode.updated) continue;
    out.t.push_back(e.t_last_s);
    out.ar_map.push_back(q.ar_map);
    out.q025.push_back(q.q025);
    out.q975.push_back(q.q975);
  }
}

/// The numbers of a step: sums over the modes that it updated, or those of the mode that is reported.
void AddStep(const Estimate& e, RunTrace* trace) {
  double evidence = 0.0, draws = 0.0;
  bool updated = false, modified = false;
  for (const ModeEstimate& mode : e.modes) {
    if (!mode.updated) continue;
    updated = true;
    modified = modified || mode.decision == Decision::kModification;
    evidence += mode.log_evidence;
    draws += mode.draws;
  }
  const ModeEstimate& shown = e.modes[static_cast<std::size_t>(e.report_mode)];
  const auto if_shown = [&shown](double value) { return shown.updated ? value : kNoSample; };
  trace->t.push_back(e.t_last_s);
  trace->log_evidence.push_back(updated ? evidence : kNoSample);
  trace->draws.push_back(updated ? draws : kNoSample);
  trace->zeta.push_back(if_shown(shown.zeta));
  trace->zeta_threshold.push_back(if_shown(shown.zeta_threshold));
  trace->lambda.push_back(if_shown(shown.lambda));
  trace->k_min.push_back(if_shown(shown.k_min));
  trace->ess.push_back(if_shown(shown.ess));
  if (modified) trace->modifications_t.push_back(e.t_last_s);
}

std::string Number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", value);
  return text;
}

const char* NameOf(NoiseKind kind) {
  constexpr const char* kNames[] = {"gaussian", "student_t", "laplace", "mixture"};
  return kNames[static_cast<std::size_t>(kind)];
}

const char* NameOf(Method method) {
  constexpr const char* kNames[] = {"armcmc", "rls", "pf", "mcmc"};
  return kNames[static_cast<std::size_t>(method)];
}

const char* YesNo(bool yes) { return yes ? "true" : "false"; }

const char* NameOf(MismatchIndex index) {
  constexpr const char* kNames[] = {"signed_mean", "rms", "log_predictive"};
  return kNames[static_cast<std::size_t>(index)];
}

std::string Rule(const SamplerSettings& s) {
  if (s.rule == DrawRule::kFixed) return std::to_string(s.fixed_draws);
  return s.rule == DrawRule::kChernoff ? "chernoff" : "k_min";
}

std::string EffectNames(const EstimatorSettings& s) {
  std::string names;
  for (int i = 0; i < s.num_effects; ++i)
    names.append(names.empty() ? "" : ", ").append(s.effects[static_cast<std::size_t>(i)].name);
  return names.empty() ? "none" : names;
}

std::string Prior(const ParameterSettings& p) {
  const std::string bounds = " in [" + Number(p.lower) + ", " + Number(p.upper) + "]";
  return p.prior == PriorKind::kUniform ? "uniform" + bounds : Number(p.mean) + " ± " + Number(p.sd) + bounds;
}

std::string NoiseText(const NoiseSettings& n) {
  std::string text = std::string(NameOf(n.kind)) + ", " + (n.estimate_std ? "estimated from " : "") + Number(n.std);
  if (n.mean != 0.0) text += ", mean " + Number(n.mean);
  if (n.kind == NoiseKind::kStudentT) text += ", dof " + Number(n.dof);
  if (n.kind == NoiseKind::kMixture) text += ", outliers " + Number(n.outlier_weight) + " x " + Number(n.outlier_scale);
  return text;
}

}  // namespace

double RunTrace::residual_rms() const {
  double square = 0.0, count = 0.0;
  for (const double r : residual)
    if (std::isfinite(r)) square += r * r, count += 1.0;
  return count > 0.0 ? std::sqrt(square / count) : kNoSample;
}

double RunTrace::total_log_evidence() const {
  double sum = 0.0;
  for (const double value : log_evidence)
    if (std::isfinite(value)) sum += value;
  return sum;
}

RunTrace TraceRun(const EstimatorSettings& settings, replay::PackSource* source, std::string label,
                  const std::function<void(double)>& on_progress) {
  Estimator estimator(settings);
  RunTrace trace;
  trace.label = std::move(label);
  trace.settings = settings;
  NameOutput(estimator, &trace);
  for (int m = 0; m < estimator.num_modes(); ++m)
    for (int i = 0; i < estimator.num_reported(); ++i) {
      QuantityTrace quantity;
      quantity.name = estimator.reported(i).name;
      quantity.unit = estimator.reported(i).unit;
      quantity.mode = estimator.mode_name(m);
      trace.quantities.push_back(std::move(quantity));
    }
  trace.summary = replay::Replay(source, &estimator, [&](const replay::RecordedPack& recorded, const Estimate& e) {
    for (int m = 0; m < estimator.num_modes(); ++m) AddMode(e, estimator, m, &trace);
    AddStep(e, &trace);
    for (std::size_t n = 0; n < static_cast<std::size_t>(e.num_samples); ++n) {
      trace.sample_t.push_back(recorded.t[n]);
      trace.residual.push_back(recorded.pack.y[n] - e.y_shown[n]);
    }
    on_progress(source->progress());
  });
  for (const double seconds : trace.summary.pack_compute_s) trace.compute_ms.push_back(1e3 * seconds);
  return trace;
}

std::vector<SettingDifference> DifferencesOf(const EstimatorSettings& a, const EstimatorSettings& b) {
  std::vector<SettingDifference> differences;
  const auto add = [&](const std::string& key, const std::string& of_a, const std::string& of_b) {
    if (of_a != of_b) differences.push_back({key, of_a, of_b});
  };
  add("model.name", a.model, b.model);
  add("method", NameOf(a.method), NameOf(b.method));
  const BaselineSettings &v = a.baseline, &w = b.baseline;
  add("baseline.recall", YesNo(v.recall), YesNo(w.recall));
  add("baseline.rls_forgetting", Number(v.rls_forgetting), Number(w.rls_forgetting));
  add("baseline.rls_reset", YesNo(v.rls_reset), YesNo(w.rls_reset));
  add("baseline.particles", std::to_string(v.particles), std::to_string(w.particles));
  add("baseline.pf_updates", std::to_string(v.pf_updates), std::to_string(w.pf_updates));
  add("baseline.pf_jitter", Number(v.pf_jitter), Number(w.pf_jitter));
  add("effects", EffectNames(a), EffectNames(b));
  if (a.model == b.model) {
    for (int i = 0; i < std::min(a.num_parameters, b.num_parameters); ++i) {
      const auto k = static_cast<std::size_t>(i);
      add("model.parameters." + a.parameters[k].name, Prior(a.parameters[k]), Prior(b.parameters[k]));
    }
  }
  add("model.regress_rate", YesNo(a.regress_rate), YesNo(b.regress_rate));
  for (std::size_t m = 0; m < a.noise.size(); ++m)
    add("noise (mode " + std::to_string(m) + ")", NoiseText(a.noise[m]), NoiseText(b.noise[m]));
  const ForgettingSettings &f = a.forgetting, &g = b.forgetting;
  add("forgetting.index", NameOf(f.index), NameOf(g.index));
  add("forgetting.threshold", Number(f.threshold), Number(g.threshold));
  add("forgetting.mu", Number(f.mu), Number(g.mu));
  add("forgetting.lambda_max", Number(f.lambda_max), Number(g.lambda_max));
  add("forgetting.rho", Number(f.rho), Number(g.rho));
  add("forgetting.min_samples", std::to_string(f.min_samples), std::to_string(g.min_samples));
  add("forgetting.drift_share", Number(f.drift_share), Number(g.drift_share));
  add("forgetting.partial_change", YesNo(f.partial_change), YesNo(g.partial_change));
  const SamplerSettings &s = a.sampler, &r = b.sampler;
  add("sampler.draws", Rule(s), Rule(r));
  add("sampler.epsilon", Number(s.epsilon), Number(r.epsilon));
  add("sampler.delta", Number(s.delta), Number(r.delta));
  add("sampler.max_draws", std::to_string(s.max_draws), std::to_string(r.max_draws));
  add("sampler.lambda_q_min", Number(s.lambda_q_min), Number(r.lambda_q_min));
  add("sampler.lambda_q_max", Number(s.lambda_q_max), Number(r.lambda_q_max));
  add("sampler.use_linearity", YesNo(s.use_linearity), YesNo(r.use_linearity));
  add("sampler.seed", std::to_string(s.seed), std::to_string(r.seed));
  return differences;
}

}  // namespace armcmc::compare
