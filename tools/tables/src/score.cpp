#include "armcmc/tables/score.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include "armcmc/models/registry.hpp"
#include "armcmc/output_predictor.hpp"

namespace armcmc::tables {
namespace {

const std::array<double, 3>& PointOf(const ModeTrace& k, Point point) { return point == Point::kMap ? k.map : k.ap; }

void Times(const Trace& trace, double* median, double* most) {
  std::vector<double> ms;
  for (const PackTrace& p : trace.packs)
    if (p.modes[0].updated || p.modes[1].updated) ms.push_back(p.ms);
  if (ms.empty()) return;
  std::sort(ms.begin(), ms.end());
  *median = ms[ms.size() / 2];
  *most = ms.back();
}

DriftScore ScoreDrift(const Trace& trace, std::size_t mode) {
  DriftScore s;
  double updates = 0.0;
  for (const PackTrace& pack : trace.packs) {
    const ModeTrace& state = pack.modes[mode];
    if (!state.updated) continue;
    updates += 1.0;
    s.share += state.p_drifted;
    for (std::size_t d = 0; d < s.rate.size(); ++d) s.rate[d] += state.drift_rate[d];
  }
  s.share /= std::fmax(updates, 1.0);
  for (double& rate : s.rate) rate /= std::fmax(updates, 1.0);
  return s;
}

int ModeAt(const Recording& r, std::size_t i) { return r.u[0][i] != 0.0 ? 0 : r.u[1][i] != 0.0 ? 1 : 2; }

}  // namespace

std::vector<double> ShownForce(const Recording& r, const Trace& trace, Point point, const EstimatorSettings& settings) {
  std::vector<double> force(r.size(), 0.0);
  std::array<double, 3> prior{};
  for (std::size_t d = 0; d < 3; ++d) prior[d] = settings.parameters[d].mean;
  for (std::size_t i = 0; i < r.size(); ++i) {
    if (r.u[0][i] < 0.0) continue;
    const PackTrace* shown = trace.ShownAt(i);
    const auto& theta = shown != nullptr && shown->modes[0].any ? PointOf(shown->modes[0], point) : prior;
    force[i] = std::pow(r.u[0][i], theta[2]) * (theta[0] + theta[1] * r.u[1][i]);
  }
  return force;
}

ContactScore ScoreContact(const Recording& r, const Trace& trace, Point point, const EstimatorSettings& settings) {
  ContactScore s;
  double contact = 0.0, active = 0.0;
  const std::vector<double> force = ShownForce(r, trace, point, settings);
  for (std::size_t i = 0; i < r.size(); ++i) {
    const double error = 1e3 * std::fabs(force[i] - r.target[i]);
    s.force_overall_mn += error / static_cast<double>(r.size());
    s.noisy_force_l2_n += std::pow(force[i] - r.y[i], 2);
    if (r.u[0][i] < 0.0) continue;
    contact += 1.0;
    s.force_contact_mn += error;
    const PackTrace* shown = trace.ShownAt(i);
    const bool known = shown != nullptr && shown->modes[0].known;
    active += known ? 1.0 : 0.0;
    for (std::size_t d = 0; d < 3; ++d) {
      const double e = std::fabs((known ? PointOf(shown->modes[0], point)[d] : 0.0) - r.truth[d][i]);
      s.mae_contact[d] += e;
      if (known) s.mae_active_contact[d] += e;
    }
  }
  s.noisy_force_l2_n = std::sqrt(s.noisy_force_l2_n);
  s.force_contact_mn /= contact;
  for (std::size_t d = 0; d < 3; ++d) {
    s.mae_contact[d] /= contact;
    s.mae_active_contact[d] /= active;
  }
  double counted = 0.0, updates = 0.0;
  std::array<std::vector<double>, 3> sd;
  for (std::size_t k = 0; k < trace.packs.size(); ++k) {
    const ModeTrace& mode = trace.packs[k].modes[0];
    if (!mode.updated) continue;
    updates += 1.0;
    s.mean_draws += trace.packs[k].draws;
    s.false_modifications += k > 0 && trace.packs[k].decision == static_cast<int>(Decision::kModification) ? 1 : 0;
    const std::size_t last = (k + 1) * static_cast<std::size_t>(trace.pack_samples);
    if (!mode.known || last >= r.size()) continue;
    counted += 1.0;
    for (std::size_t d = 0; d < 3; ++d) sd[d].push_back(mode.sd[d]);
    for (std::size_t l = 0; l < kLevels.size(); ++l)
      for (std::size_t d = 0; d < 3; ++d) {
        const auto& [from, to] = mode.interval[l][d];
        s.coverage[l][d] += from <= r.truth[d][last] && r.truth[d][last] <= to ? 1.0 : 0.0;
        s.width[l][d] += to - from;
      }
  }
  s.mean_draws /= std::fmax(updates, 1.0);
  for (auto* table : {&s.coverage, &s.width})
    for (auto& level : *table)
      for (double& v : level) v /= std::fmax(counted, 1.0);
  if (trace.has_intervals)
    for (std::size_t l = 0; l < kLevels.size(); ++l)
      for (std::size_t d = 0; d < 3; ++d) s.coverage_variance[l][d] = NullCoverageVariance(sd[d], l);
  s.drift = ScoreDrift(trace, 0);
  Times(trace, &s.median_ms, &s.max_ms);
  return s;
}

std::vector<double> ShownAngle(const Recording& r, const Trace& trace, Point point, const EstimatorSettings& settings,
                               bool restarted) {
  const ModelInfo& info = *CompiledModels()[static_cast<std::size_t>(FindModel(settings.model))];
  const std::unique_ptr<OutputPredictor> predictor = info.compiled->make_predictor(info, settings.constants, nullptr);
  const auto pack = std::make_unique<DataPack>();
  std::vector<double> angle(r.size(), r.y[0]);
  std::array<double, kMaxPackSamples> output{}, free_run{};
  for (int k = 1; k <= static_cast<int>(trace.packs.size()); ++k) {
    FillPack(r, k, trace.pack_samples, pack.get());
    ShownEstimates shown;
    if (k >= 3) {
      for (std::size_t m = 0; m < 2; ++m) {
        const ModeTrace& mode = trace.packs[static_cast<std::size_t>(k - 3)].modes[m];
        shown.known[m] = mode.known;
        for (std::size_t d = 0; d < 3; ++d) shown.theta[m][d] = PointOf(mode, point)[d];
      }
    }
    predictor->Predict(*pack, shown, &output, &free_run);
    for (std::size_t n = 0; n < static_cast<std::size_t>(trace.pack_samples); ++n)
      angle[static_cast<std::size_t>(trace.pack_samples * (k - 1)) + 1 + n] = restarted ? output[n] : free_run[n];
  }
  return angle;
}

ActuatorScore ScoreActuator(const Recording& r, const Trace& trace, Point point, const EstimatorSettings& settings) {
  ActuatorScore s;
  const double p_atm = ConstantOf(settings, "p_atm");
  std::array<double, 2> count{};
  double flow_error = 0.0, flow = 0.0;
  for (std::size_t i = 0; i < r.size(); ++i) {
    const int acting = ModeAt(r, i);
    if (acting > 1) continue;
    const auto m = static_cast<std::size_t>(acting);
    const PackTrace* shown = trace.ShownAt(i);
    const bool known = shown != nullptr && shown->modes[m].known;
    std::array<double, 3> theta{};
    if (known) {
      theta = PointOf(shown->modes[m], point);
      count[m] += 1.0;
      s.g_rel_error[m] += std::fabs(theta[0] / r.truth[0][i] - 1.0);
      const double theta1 = theta[0] - theta[1] * p_atm, truth1 = r.truth[0][i] - r.truth[1][i] * p_atm;
      s.theta1_l2 += std::pow(theta1 - truth1, 2);
      s.theta2_l2 += std::pow(theta[1] - r.truth[1][i], 2);
    }
    flow_error += std::pow(r.u[3][i] * (theta[0] + theta[1] * (r.u[2][i] - p_atm)) - r.target[i], 2);
    flow += std::pow(r.target[i], 2);
  }
  for (std::size_t m = 0; m < 2; ++m) s.g_rel_error[m] /= std::fmax(count[m], 1.0);
  s.theta1_l2 = std::sqrt(s.theta1_l2);
  s.theta2_l2 = std::sqrt(s.theta2_l2);
  s.flow_rel_error = std::sqrt(flow_error / flow);
  for (const bool restarted : {false, true}) {
    const std::vector<double> angle = ShownAngle(r, trace, point, settings, restarted);
    double sum = 0.0;
    for (std::size_t i = 0; i < r.size(); ++i) sum += std::pow(angle[i] - r.y[i], 2);
    (restarted ? s.alpha_restarted_l2 : s.alpha_l2) = std::sqrt(sum);
  }
  for (std::size_t m = 0; m < 2; ++m) {
    double counted = 0.0;
    for (std::size_t k = 0; k < trace.packs.size(); ++k) {
      const ModeTrace& mode = trace.packs[k].modes[m];
      const std::size_t last = (k + 1) * static_cast<std::size_t>(trace.pack_samples);
      if (!mode.updated || !mode.known || last >= r.size() || ModeAt(r, last) != static_cast<int>(m)) continue;
      counted += 1.0;
      for (std::size_t d = 0; d < 2; ++d) {
        const auto covers = [&](std::size_t level) {
          const auto& [from, to] = mode.interval[level][d];
          return from <= r.truth[d][last] && r.truth[d][last] <= to ? 1.0 : 0.0;
        };
        s.coverage50[m][d] += covers(0);
        s.coverage95[m][d] += covers(2);
      }
    }
    for (auto* coverage : {&s.coverage50[m], &s.coverage95[m]})
      for (double& c : *coverage) c /= std::fmax(counted, 1.0);
    s.drift[m] = ScoreDrift(trace, m);
  }
  Times(trace, &s.median_ms, &s.max_ms);
  return s;
}

}  // namespace armcmc::tables
