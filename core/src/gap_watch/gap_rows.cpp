#include "armcmc/gap_watch/gap_rows.hpp"

#include <algorithm>
#include <cmath>

#include "armcmc/models/compiled_plant.hpp"
#include "gap_tools.hpp"
#include "simd/kernels.hpp"

namespace armcmc {
namespace {

constexpr double kRelativeStep = 1e-4;  // of a difference quotient, relative to the size of the parameter

}  // namespace

GapLineariser::GapLineariser(const EstimatorSettings& settings, int model, const simd::Kernels& kernels,
                             bool judges_passive)
    : settings_(settings), model_(model), kernels_(kernels), judges_passive_(judges_passive), composition_(settings) {
  effects_ = composition_.MakePack();
  if (settings.plant != nullptr && settings.plant->states().size() > 0)
    starts_ = std::make_unique<GapStarts>(settings.plant->states(), kernels);
}

const ParameterSettings& GapLineariser::parameter(int column) const noexcept {
  return composition_.sampled().parameters[At(column % info().num_parameters)];
}

GapReference GapLineariser::Moved(const GapReference& reference, const GapShift& shift) const noexcept {
  GapReference moved = reference;
  const int count = info().num_parameters;
  for (int c = 0; c < num_columns(); ++c) {
    double& theta = moved.theta[At(c / count)][At(c % count)];
    theta = std::clamp(theta + shift[At(c)], parameter(c).lower, parameter(c).upper);
  }
  return moved;
}

void GapLineariser::FillTheta(const std::array<double, kMaxParams>& theta) noexcept {
  for (int d = 0; d < info().num_parameters; ++d) {
    const ParameterSettings& p = parameter(d);
    const double size = p.prior == PriorKind::kNormal ? p.sd : p.upper - p.lower;
    const double step = kRelativeStep * std::max(std::fabs(theta[At(d)]), size);
    auto& lanes = theta_.value[At(d)];
    lanes.fill(theta[At(d)]);
    lanes[At(1 + 2 * d)] = std::min(theta[At(d)] + step, p.upper);
    lanes[At(2 + 2 * d)] = std::max(theta[At(d)] - step, p.lower);
  }
}

bool GapLineariser::Predict(const DataPack& pack, double noise_std) noexcept {
  if (!starts_) {
    kernels_.predict(model_, data_, theta_, &prediction_);
    return true;
  }
  std::array<double, kMaxParams> theta{};
  for (int d = 0; d < info().num_parameters; ++d) theta[At(d)] = theta_.value[At(d)][0];
  if (!starts_->Fit(pack, theta, noise_std, &data_, &effects_.described.states)) return false;
  kernels_.run_states(data_, theta_, no_offset_, &end_, &prediction_);
  return true;
}

bool GapLineariser::FillMode(int mode, double noise_std, const std::array<int, kMaxPackSamples>& modes,
                             GapRows* rows) noexcept {
  bool finite = true;
  int row = 0;
  for (std::size_t n = 0; n < At(rows->num_samples) && row < data_.num_samples; ++n) {
    if (data_.compiled != nullptr ? At(data_.sample[At(row)]) != n : modes[n] != mode) continue;
    const auto& value = prediction_.value[At(row)];
    rows->used[n] = true;
    rows->output[n] = value[0] / noise_std;
    rows->error[n] = (data_.target[At(row)] - value[0]) / noise_std;
    finite = finite && std::isfinite(rows->error[n]);
    for (int d = 0; d < info().num_parameters; ++d) {
      const auto& lanes = theta_.value[At(d)];
      const double width = lanes[At(1 + 2 * d)] - lanes[At(2 + 2 * d)];
      const double slope = width > 0.0 ? (value[At(1 + 2 * d)] - value[At(2 + 2 * d)]) / (width * noise_std) : 0.0;
      rows->slope[At(mode * info().num_parameters + d)][n] = slope;
      finite = finite && std::isfinite(slope);
    }
    ++row;
  }
  return finite;
}

bool GapLineariser::Linearise(const DataPack& pack, const GapReference& at, GapRows* rows,
                              std::array<int, kMaxPackSamples>* modes) noexcept {
  const int n = rows->num_samples = pack.num_samples;
  std::fill_n(rows->used.begin(), n, false);
  std::fill_n(rows->error.begin(), n, 0.0);
  std::fill_n(rows->output.begin(), n, 0.0);
  for (int c = 0; c < num_columns(); ++c) std::fill_n(rows->slope[At(c)].begin(), n, 0.0);
  if (!composition_.empty() && !composition_.Prepare(pack, &effects_)) return false;
  for (int i = 0; i < n; ++i) (*modes)[At(i)] = composition_.ModeOf(pack, effects_, i);
  bool finite = true;
  for (int m = 0; m < info().num_modes; ++m) {
    if (!at.known[At(m)]) continue;
    FillTheta(at.theta[At(m)]);
    if (composition_.empty()) {
      info().compiled->prepare(pack, settings_.constants, m, &data_);
    } else {
      composition_.Fill(pack, effects_, m, &data_);
    }
    if (data_.num_samples == 0) continue;
    finite = Predict(pack, at.noise_std[At(m)]) && FillMode(m, at.noise_std[At(m)], *modes, rows) && finite;
  }
  if (starts_) {
    rows->num_removed = starts_->directions().count();
    RemoveStarts(&rows->error);
    for (int c = 0; c < num_columns(); ++c) RemoveStarts(&rows->slope[At(c)]);
  }
  if (judges_passive_ && at.known[0]) FillPassive(pack, at.noise_std[0], *modes, rows);
  return finite;
}

void GapLineariser::FillPassive(const DataPack& pack, double noise_std, const std::array<int, kMaxPackSamples>& modes,
                                GapRows* rows) const noexcept {
  const bool described = info().described != nullptr;
  if (!described && !composition_.empty()) return;  // with effects every sample belongs to the law
  for (std::size_t i = 0; i < At(rows->num_samples); ++i) {
    if (modes[i] != info().num_modes || (described && !effects_.described.passive_given[i])) continue;
    rows->used[i] = true;
    rows->output[i] = described ? effects_.described.passive[i] / noise_std : 0.0;
    rows->error[i] = pack.y[i] / noise_std - rows->output[i];
  }
}

}  // namespace armcmc
