#include "one_step.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <utility>

#include "armcmc/plant/error.hpp"
#include "armcmc/support/parallel.hpp"

namespace armcmc::ladder {

using Eigen::Index;
using Eigen::VectorXd;

DataScales WithRanges(DataScales scales, const std::vector<Feature>& features, const std::vector<Index>& rows) {
  constexpr double kOutermost = 0.001;  // share of rows at the ends of a range that are ignored
  for (const Feature& feature : features) {
    std::vector<double> sorted;
    sorted.reserve(rows.size());
    for (const Index n : rows) sorted.push_back(feature.value[n]);
    std::sort(sorted.begin(), sorted.end());
    const auto at = static_cast<std::size_t>(kOutermost * static_cast<double>(sorted.size()));
    const double low = sorted[at], high = sorted[sorted.size() - 1 - at];
    QuantityScale& scale = scales.quantity[feature.name];
    scale.low = high > low ? low : sorted.front();
    scale.high = high > low ? high : sorted.back();
  }
  return scales;
}

VectorXd LeftOf(const VectorXd& y, const Eigen::MatrixXd& columns, const VectorXd& pull) {
  const VectorXd size = (columns.colwise().squaredNorm().transpose() + pull).cwiseMax(1e-300).cwiseSqrt();
  const Eigen::MatrixXd scaled = columns * size.cwiseInverse().asDiagonal();
  Eigen::MatrixXd matrix = scaled.transpose() * scaled;
  matrix.diagonal() += pull.cwiseQuotient(size.cwiseAbs2());
  matrix.diagonal().array() += 1e-9;
  return y - scaled * matrix.ldlt().solve(scaled.transpose() * y);
}

std::vector<Candidate> BestByOneStep(std::vector<Candidate> all, std::size_t count,
                                     const std::shared_ptr<const Plant>& plant, const Dataset& data,
                                     const Trial& base) {
  constexpr double kAlike = 0.02;  // share of squared explanation in which two candidates with the same action differ
  const Dataset quick = SubsetForFits(*plant, data, base.model->target() - base.fit.prediction);
  const Index own = base.fit.theta.size();
  std::vector<VectorXd> left(all.size());
  VectorXd error;
  double square = 0.0;
  std::vector<Index> rows;
  {
    const identify::TrajectoryModel model(plant, quick.series);
    VectorXd prediction;
    if (!model.PredictOne(base.fit.theta, &prediction)) return {};
    for (Index n = 0; n < prediction.size(); ++n)
      if (quick.training[static_cast<std::size_t>(n)] != 0 && model.active()[static_cast<std::size_t>(n)] != 0)
        rows.push_back(n);
    error = (model.target() - prediction)(rows);
    square = error.squaredNorm();
  }
  support::InParallel(all.size(), [&](std::size_t i) {
    try {
      const identify::TrajectoryModel model(all[i].plant, quick.series);
      VectorXd theta = model.Start(), prediction;
      theta.head(own) = base.fit.theta;
      Eigen::MatrixXd jacobian;
      if (!model.Linearise(theta, &prediction, &jacobian)) return;
      const double variance = square / static_cast<double>(std::max<std::size_t>(rows.size(), 1));
      left[i] = LeftOf(error, jacobian(rows, Eigen::all), variance * identify::PriorPrecision(model));
    } catch (const PlantError&) {  // beyond the limits of a plant
    }
  });
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (left[i].size() > 0 && left[i].squaredNorm() < square) order.push_back(i);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return left[a].squaredNorm() < left[b].squaredNorm(); });
  std::vector<std::size_t> chosen;
  for (const std::size_t i : order) {
    const bool alike = std::any_of(chosen.begin(), chosen.end(), [&](std::size_t c) {
      return (left[c] - left[i]).squaredNorm() < kAlike * (square - left[i].squaredNorm());
    });
    if (!alike && chosen.size() < count) chosen.push_back(i);
  }
  std::vector<Candidate> best;
  best.reserve(chosen.size());
  for (const std::size_t i : chosen) best.push_back(std::move(all[i]));
  return best;
}

}  // namespace armcmc::ladder
