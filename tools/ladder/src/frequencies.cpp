#include "frequencies.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <bit>
#include <cmath>
#include <complex>
#include <numbers>
#include <string>
#include <unsupported/Eigen/FFT>
#include <vector>

#include "armcmc/identify/fit.hpp"

namespace armcmc::ladder {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// Angular frequency, up to `highest`, at which the errors have most power. The samples at times t lie on a grid of dt
/// with gaps.
double StrongestInTime(const VectorXd& error, const VectorXd& t, double dt, double highest) {
  const double first = t.minCoeff();
  const auto places = static_cast<std::size_t>(std::llround((t.maxCoeff() - first) / dt)) + 1;
  std::vector<double> wave(2 * std::bit_ceil(places), 0.0);
  for (Index n = 0; n < t.size(); ++n) wave[static_cast<std::size_t>(std::llround((t[n] - first) / dt))] += error[n];
  std::vector<std::complex<double>> spectrum;
  Eigen::FFT<double>().fwd(spectrum, wave);
  const double step = 2.0 * std::numbers::pi / (static_cast<double>(wave.size()) * dt);
  const auto slowest = static_cast<std::size_t>(wave.size() / places);  // one period
  const auto last = std::min(wave.size() / 2, static_cast<std::size_t>(highest / step) + 1);
  std::size_t strongest = slowest;
  for (std::size_t k = slowest; k < last; ++k)
    if (std::norm(spectrum[k]) > std::norm(spectrum[strongest])) strongest = k;
  return step * static_cast<double>(strongest);
}

/// The same along any quantity x, by a plain periodogram.
double StrongestAlong(const VectorXd& error, const VectorXd& x, double highest) {
  constexpr double kMost = 4000.0;
  const double range = x.maxCoeff() - x.minCoeff();
  double strongest = 2.0 * std::numbers::pi / range, power = 0.0;
  // Each wave has half a period more over the range than the last: multiplied by the slowest one.
  const Eigen::ArrayXd phase = std::numbers::pi / range * x.array();
  const Eigen::ArrayXd turn_cos = phase.cos(), turn_sin = phase.sin();
  Eigen::ArrayXd cosine = turn_cos, sine = turn_sin, turned(x.size());
  const auto last = static_cast<Index>(std::min(kMost, std::floor(range * highest / std::numbers::pi) + 1.0));
  for (Index half_turns = 2; half_turns < last; ++half_turns) {
    turned = cosine * turn_cos - sine * turn_sin;
    sine = sine * turn_cos + cosine * turn_sin;
    cosine.swap(turned);
    const double c = error.dot(cosine.matrix()), s = error.dot(sine.matrix());
    if (c * c + s * s > power) {
      power = c * c + s * s;
      strongest = std::numbers::pi * static_cast<double>(half_turns) / range;
    }
  }
  return strongest;
}

/// The quantity along which a frequency is defined; empty if it is not measured.
VectorXd Along(const identify::TrajectoryModel& model, const VectorXd& theta, const std::string& name) {
  const auto size = static_cast<Index>(model.num_rows());
  if (name.empty()) return Eigen::Map<const VectorXd>(model.series().t.data(), size);
  const PlantDescription& plant = model.plant().description();
  for (std::size_t s = 0; s < plant.signals.size(); ++s)
    if (plant.signals[s].name == name && static_cast<int>(s) != model.plant().output())
      return Eigen::Map<const VectorXd>(model.series().signals[s].data(), size);
  for (std::size_t s = 0; s < plant.states.size(); ++s)
    if (plant.states[s].name == name) return model.States(theta).col(static_cast<Index>(s));
  return {};
}

/// One Gauss-Newton step of all parameters except `held`.
void StepOfOthers(const identify::TrajectoryModel& model, const std::vector<Index>& rows, Index held, VectorXd* theta) {
  VectorXd prediction;
  Eigen::MatrixXd jacobian;
  if (!model.Linearise(*theta, &prediction, &jacobian)) return;
  jacobian.col(held).setZero();
  const Eigen::MatrixXd columns = jacobian(rows, Eigen::all);
  const VectorXd error = (model.target() - prediction)(rows);
  const double variance = error.squaredNorm() / static_cast<double>(rows.size()) + 1e-300;
  const VectorXd pull = variance * identify::PriorPrecision(model);
  Eigen::MatrixXd normal = columns.transpose() * columns;
  normal.diagonal() += pull;
  VectorXd right = columns.transpose() * error + pull.cwiseProduct(model.Start() - *theta);
  right[held] = 0.0;
  const VectorXd size = normal.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  Eigen::MatrixXd scaled = size.asDiagonal() * normal * size.asDiagonal();
  scaled.diagonal().array() += 1e-9;
  *theta += size.cwiseProduct(scaled.ldlt().solve(size.cwiseProduct(right)));
}

}  // namespace

void AddFrequencies(const identify::TrajectoryModel& model, const Dataset& data,
                    const std::vector<Frequency>& frequencies, std::vector<VectorXd>* starts) {
  const VectorXd start = starts->front(), lower = model.Lower(), upper = model.Upper();
  VectorXd prediction;
  if (frequencies.empty() || !model.PredictOne(start, &prediction)) return;
  std::vector<Index> rows;
  for (std::size_t n = 0; n < data.training.size(); ++n)
    if (data.training[n] != 0 && model.active()[n] != 0) rows.push_back(static_cast<Index>(n));
  if (rows.empty()) return;
  const VectorXd error = (model.target() - prediction)(rows);
  for (const Frequency& frequency : frequencies) {
    const VectorXd along = Along(model, start, frequency.along);
    if (along.size() == 0 || !(along(rows).maxCoeff() > along(rows).minCoeff())) continue;
    const auto d = static_cast<Index>(frequency.parameter);
    VectorXd more = start;
    const double highest = std::exp(upper[d]);
    const double strongest = frequency.along.empty() ? StrongestInTime(error, along(rows), model.series().dt, highest)
                                                     : StrongestAlong(error, along(rows), highest);
    more[d] = std::clamp(std::log(strongest), lower[d], upper[d]);
    StepOfOthers(model, rows, d, &more);
    starts->push_back(more.cwiseMax(lower).cwiseMin(upper));
  }
}

}  // namespace armcmc::ladder
