#include "armcmc/gap/statistics.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace armcmc::gap {

double RootMeanSquare(const Vector& series, const Vector& weight) {
  return std::sqrt((series.array().square() * weight.array()).sum() / std::max(weight.sum(), 1.0));
}

double RootMeanSquare(const Vector& series) { return RootMeanSquare(series, Vector::Ones(series.size())); }

double Quantile(const Vector& series, double q) {
  std::vector<double> sorted(series.data(), series.data() + series.size());
  const auto at = static_cast<std::ptrdiff_t>(q * static_cast<double>(sorted.size() - 1));
  std::nth_element(sorted.begin(), sorted.begin() + at, sorted.end());
  return sorted[static_cast<std::size_t>(at)];
}

bool Moves(const Vector& series) { return series.maxCoeff() - series.minCoeff() > 1e-9 * series.cwiseAbs().maxCoeff(); }

}  // namespace armcmc::gap
