#include "armcmc/summary.hpp"

#include <algorithm>
#include <cmath>

#include "armcmc/plant/program.hpp"
#include "simd/kernels.hpp"

namespace armcmc {
namespace {

/// Coordinate d of every candidate, at the end of the pack.
void MoveAll(const simd::Kernels& kernels, const ModeDraws& draws, std::size_t d, double* u) noexcept {
  const int whole = draws.draws / 8 * 8;  // the kernels take whole vectors
  kernels.move_to_end(draws.end[d], draws.u[d], whole, u);
  for (int k = whole; k < draws.draws; ++k) u[k] = draws.end[d](draws.u[d][k]);
  if (!draws.some_changed) return;
  for (int k = 0; k < draws.draws; ++k) u[k] += draws.changed[k] * (draws.end_of_changed[d](draws.u[d][k]) - u[k]);
}

/// Reported quantity r of every candidate; 0 for a candidate without weight: outside its bounds the quantity may be
/// NaN, which a weight of 0 would not remove from a sum.
void Reported(const simd::Kernels& kernels, const ModelInfo& info, const PlantConstants& constants,
              const ParameterSpace& space, const ModeDraws& draws, int r, double* value) noexcept {
  const auto ir = static_cast<std::size_t>(r);
  if (info.IsReportedAsSampled(r)) {
    const double* u = draws.u[ir];
    if (draws.moves) {
      MoveAll(kernels, draws, ir, value);
      u = value;
    }
    for (int k = 0; k < draws.draws; ++k) value[k] = space.Theta(r, u[k]);
    return;
  }
  for (int k = 0; k < draws.draws; ++k) {
    std::array<double, kMaxParams> theta{};
    std::array<double, kMaxReported> reported{};
    for (int d = 0; d < space.num_parameters; ++d)
      theta[static_cast<std::size_t>(d)] = space.Theta(d, draws.AtEnd(d, k));
    if (info.described != nullptr) {
      const bool counts = draws.weight[k] > 0.0 || draws.visits[k] != 0;
      value[k] = counts ? info.described->Report(r, theta.data()) : 0.0;
      continue;
    }
    info.Report(theta.data(), constants, reported.data());
    value[k] = reported[ir];
  }
}

/// Derivatives of the reported quantities at theta with respect to the standardised coordinate d.
std::array<double, kMaxReported> Slopes(const ModelInfo& info, const PlantConstants& constants,
                                        const ParameterSpace& space, const std::array<double, kMaxParams>& theta,
                                        int d) noexcept {
  constexpr double kStep = 1e-4;
  std::array<std::array<double, kMaxReported>, 2> reported{};
  for (std::size_t side = 0; side < 2; ++side) {
    std::array<double, kMaxParams> moved = theta;
    moved[static_cast<std::size_t>(d)] += (side == 0 ? -kStep : kStep) * space.scale[static_cast<std::size_t>(d)];
    info.Report(moved.data(), constants, reported[side].data());
  }
  std::array<double, kMaxReported> slope{};
  for (std::size_t r = 0; r < kMaxReported; ++r) slope[r] = (reported[1][r] - reported[0][r]) / (2.0 * kStep);
  return slope;
}

/// Expected rates of the reported quantities if every standardised coordinate moves at its rate.
void DriftRates(const ModelInfo& info, const PlantConstants& constants, const ParameterSpace& space,
                const ModeDraws& draws, std::array<double, kMaxReported>* rate) noexcept {
  rate->fill(0.0);
  std::array<double, kMaxParams> theta{};
  for (int d = 0; d < space.num_parameters; ++d)
    theta[static_cast<std::size_t>(d)] = space.Theta(d, draws.mode_u[static_cast<std::size_t>(d)]);
  for (int d = 0; d < space.num_parameters; ++d) {
    const std::array<double, kMaxReported> slope = Slopes(info, constants, space, theta, d);
    const double speed = draws.drift_rate[static_cast<std::size_t>(d)];
    for (std::size_t r = 0; r < kMaxReported; ++r) (*rate)[r] = std::hypot((*rate)[r], speed * slope[r]);
  }
}

struct MeanAndSd {
  double mean, sd;
};

/// For values with weights that sum to `total`.
MeanAndSd Moments(const simd::Kernels& kernels, const double* value, const double* weight, int count,
                  double total) noexcept {
  const int whole = count / 8 * 8;  // the kernels take whole vectors
  std::array<double, 3> sums{};
  kernels.first_moments(1, &value, weight, whole, sums.data());
  double sum = sums[2];
  for (int k = whole; k < count; ++k) sum += weight[k] * value[k];
  const double mean = sum / total;
  double square = 0.0;
  kernels.second_moments(1, &value, weight, &mean, whole, &square);
  for (int k = whole; k < count; ++k) square += weight[k] * (value[k] - mean) * (value[k] - mean);
  return {mean, std::sqrt(square / total)};
}

/// Quantiles and published histogram of `count` visited values.
void Distribution(const double* value, const double* visits, int count, double total, MarginalSummary* m) noexcept {
  double lo = HUGE_VAL;
  double hi = -HUGE_VAL;
  for (int k = 0; k < count; ++k) {
    lo = std::min(lo, value[k]);
    hi = std::max(hi, value[k]);
  }
  std::array<double, kQuantileBins> fine{};
  const double width = (hi - lo) / kQuantileBins;
  const double per_unit = width > 0.0 ? 1.0 / width : 0.0;
  const double reach = 5.0 * m->sd;
  m->histogram_lo = std::fmax(lo, m->ar_ap - reach);
  m->histogram_hi = std::fmin(hi, m->ar_ap + reach);
  const double coarse_width = (m->histogram_hi - m->histogram_lo) / kHistogramBins;
  const double per_coarse = coarse_width > 0.0 ? 1.0 / coarse_width : 0.0;
  m->density.fill(0.0);
  double inside = 0.0;
  for (int k = 0; k < count; ++k) {
    const double v = value[k];
    // A draw whose reported quantity is NaN counts among the lowest.
    fine[static_cast<std::size_t>(std::min(std::max(0.0, (v - lo) * per_unit), kQuantileBins - 1.0))] += visits[k];
    if (coarse_width > 0.0 && v >= m->histogram_lo && v <= m->histogram_hi) {
      m->density[static_cast<std::size_t>(
          std::min(std::max(0.0, (v - m->histogram_lo) * per_coarse), kHistogramBins - 1.0))] += visits[k];
      inside += visits[k];
    }
  }
  if (inside > 0.0)
    for (double& d : m->density) d /= inside * coarse_width;
  const std::array<double, 5> levels{0.025, 0.25, 0.5, 0.75, 0.975};
  const std::array<double*, 5> outputs{&m->q025, &m->q25, &m->q50, &m->q75, &m->q975};
  std::size_t bin = 0;
  double below = 0.0;
  for (std::size_t i = 0; i < levels.size(); ++i) {
    const double wanted = levels[i] * total;
    while (bin < kQuantileBins - 1 && below + fine[bin] < wanted) below += fine[bin++];
    const double part = fine[bin] > 0.0 ? std::clamp((wanted - below) / fine[bin], 0.0, 1.0) : 0.5;
    *outputs[i] = lo + (static_cast<double>(bin) + part) * width;
  }
}

}  // namespace

SummaryWorkspace::SummaryWorkspace(int capacity)
    : kernels(simd::Best()),
      value(static_cast<std::size_t>(capacity)),
      visited_value(static_cast<std::size_t>(capacity)),
      visits(static_cast<std::size_t>(capacity)),
      visited(static_cast<std::size_t>(capacity)) {}

void Widen(const ModelInfo& info, const PlantConstants& constants, const ParameterSpace& space,
           const std::array<double, kMaxParams>& ratio, ModeEstimate* estimate) noexcept {
  std::array<double, kMaxParams> theta{};
  bool wider = false;
  for (int d = 0; d < space.num_parameters; ++d) {
    const auto i = static_cast<std::size_t>(d);
    theta[i] = info.Sampled(d, estimate->marginal[static_cast<std::size_t>(info.ReportedOf(d))].ar_ap);
    wider = wider || ratio[i] > 1.0;
  }
  if (!wider) return;
  std::array<double, kMaxReported> added{};
  for (int d = 0; d < space.num_parameters; ++d) {
    const auto i = static_cast<std::size_t>(d);
    const auto own = static_cast<std::size_t>(info.ReportedOf(d));
    const std::array<double, kMaxReported> slope = Slopes(info, constants, space, theta, d);
    if (!(std::fabs(slope[own]) > 0.0)) continue;
    const double sd = estimate->marginal[own].sd / std::fabs(slope[own]);
    const double variance = sd * sd * std::fmax(ratio[i] * ratio[i] - 1.0, 0.0);
    for (std::size_t r = 0; r < kMaxReported; ++r) added[r] += slope[r] * slope[r] * variance;
  }
  for (int r = 0; r < info.num_reported; ++r) {
    const auto ir = static_cast<std::size_t>(r);
    MarginalSummary& m = estimate->marginal[ir];
    const double by = std::sqrt(1.0 + added[ir] / (m.sd * m.sd));
    if (!std::isfinite(by)) continue;
    double least = -HUGE_VAL;
    double most = HUGE_VAL;
    if (info.IsReportedAsSampled(r)) {
      least = space.Theta(r, space.lower[ir]);
      most = space.Theta(r, space.upper[ir]);
    }
    const double centre = m.q50;
    for (double* value : {&m.q025, &m.q25, &m.q75, &m.q975, &m.histogram_lo, &m.histogram_hi})
      *value = std::clamp(centre + by * (*value - centre), least, most);
    m.sd *= by;
    m.is_sd *= by;
    for (double& density : m.density) density /= by;
  }
}

double ChainEss(const ModeDraws& draws) noexcept {
  const int first = draws.burn_in;
  const int n = draws.draws - first;
  const int batches = 64;
  const int size = n / batches;
  if (size < 2) return 1.0;
  double smallest = n;
  for (int d = 0; d < draws.dim; ++d) {
    const double* u = draws.u[static_cast<std::size_t>(d)];
    double mean = 0.0;
    for (int i = first; i < first + size * batches; ++i) mean += u[draws.chain[i]];
    mean /= size * batches;
    double variance = 0.0;
    double between = 0.0;
    for (int b = 0; b < batches; ++b) {
      double batch = 0.0;
      for (int i = first + b * size; i < first + (b + 1) * size; ++i) {
        const double c = u[draws.chain[i]] - mean;
        variance += c * c;
        batch += c;
      }
      batch /= size;
      between += batch * batch;
    }
    variance /= size * batches;
    between /= batches - 1;
    if (between > 0.0) smallest = std::fmin(smallest, size * batches * variance / (size * between));
  }
  return std::fmax(smallest, 1.0);
}

void Summarise(const ModelInfo& info, const PlantConstants& constants, const ParameterSpace& space,
               const ModeDraws& draws, SummaryWorkspace* workspace, ModeEstimate* estimate) noexcept {
  estimate->known = draws.known;
  estimate->updated = true;
  estimate->decision = draws.decision;
  estimate->num_samples = draws.num_samples;
  estimate->zeta = draws.zeta;
  estimate->zeta_threshold = draws.zeta_threshold;
  estimate->lambda = draws.lambda;
  estimate->k_min = draws.k_min;
  estimate->draws = draws.draws;
  estimate->truncated = draws.truncated;
  estimate->kish_ess = draws.kish_ess;
  estimate->acceptance = draws.acceptance;
  estimate->log_evidence = draws.log_evidence;
  estimate->p_changed = draws.p_changed;
  estimate->p_drifted = draws.p_drifted;
  DriftRates(info, constants, space, draws, &estimate->drift_rate);
  estimate->ess = ChainEss(draws);

  const double total = draws.draws - draws.burn_in;
  std::array<double, kMaxParams> mode_theta{};
  for (int d = 0; d < space.num_parameters; ++d)
    mode_theta[static_cast<std::size_t>(d)] = space.Theta(d, draws.ToEnd(d, draws.mode_u[static_cast<std::size_t>(d)]));
  std::array<double, kMaxReported> mode{};
  static_assert(kMaxReported == kMaxParams);
  info.Report(mode_theta.data(), constants, mode.data());
  // The chain visits some candidates repeatedly and others never: its statistics are computed from the visited ones.
  int visited = 0;
  for (int k = 0; k < draws.draws; ++k) {
    workspace->visited[static_cast<std::size_t>(visited)] = k;
    workspace->visits[static_cast<std::size_t>(visited)] = draws.visits[k];
    visited += draws.visits[k] != 0 ? 1 : 0;
  }
  const double* visits = workspace->visits.data();
  double* value = workspace->value.data();
  double* visited_value = workspace->visited_value.data();
  for (int r = 0; r < info.num_reported; ++r) {
    MarginalSummary& m = estimate->marginal[static_cast<std::size_t>(r)];
    Reported(workspace->kernels, info, constants, space, draws, r, value);
    for (int j = 0; j < visited; ++j) visited_value[j] = value[workspace->visited[static_cast<std::size_t>(j)]];
    const MeanAndSd weighted = Moments(workspace->kernels, value, draws.weight, draws.draws, 1.0);
    m.ar_ap = weighted.mean;
    m.is_sd = weighted.sd;
    const MeanAndSd chain = Moments(workspace->kernels, visited_value, visits, visited, total);
    m.chain_mean = chain.mean;
    m.sd = chain.sd;
    m.ar_map =
        draws.point_is_mode || draws.decision == Decision::kModification ? mode[static_cast<std::size_t>(r)] : m.ar_ap;
    Distribution(visited_value, visits, visited, total, &m);
  }
  estimate->noise_std = std::exp(space.log_noise_scale);
  if (space.samples_noise_scale()) {
    double mean = 0.0;
    for (int k = 0; k < draws.draws; ++k)
      if (draws.visits[k] != 0)
        mean +=
            draws.visits[k] * std::exp(space.Theta(space.dim - 1, draws.u[static_cast<std::size_t>(space.dim - 1)][k]));
    estimate->noise_std = mean / total;
  }
}

}  // namespace armcmc
