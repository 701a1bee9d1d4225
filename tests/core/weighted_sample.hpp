#pragma once

#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include "armcmc/density_fit.hpp"
#include "core/kernel_sets.hpp"

namespace armcmc::test {

inline std::normal_distribution<double> drawn_normal;  // keeps a number back, which must not reach the next test

/// Draws with weights, padded as the fit wants them, and the storage of a fit to them.
class WeightedSample {
 public:
  WeightedSample(int dim, int size, const std::function<void(std::mt19937_64&, double*)>& draw, unsigned seed = 1) {
    std::mt19937_64 generator(seed);
    drawn_normal.reset();
    const auto padded = static_cast<std::size_t>((size + kTileLanes - 1) / kTileLanes * kTileLanes);
    weight.assign(padded, 0.0);
    for (std::size_t d = 0; d < static_cast<std::size_t>(dim); ++d) row[d].assign(padded, 0.0);
    for (std::size_t r = 0; r < kRows; ++r) {
      room[r].resize(padded);
      scratch[r] = room[r].data();
    }
    for (std::size_t k = 0; k < static_cast<std::size_t>(size); ++k) {
      double u[kMaxParams];
      draw(generator, u);
      for (std::size_t d = 0; d < static_cast<std::size_t>(dim); ++d) row[d][k] = u[d];
      weight[k] = 1.0;
    }
    draws.dim = dim;
    draws.size = size;
  }

  double Fit(const FitOptions& options = {}) {
    for (std::size_t d = 0; d < static_cast<std::size_t>(draws.dim); ++d) draws.u[d] = row[d].data();
    draws.weight = weight.data();
    return FitBlock(simd::Best(), draws, options, scratch, tables, &block);
  }

  [[nodiscard]] double Mean(std::size_t d) const {
    double sum = 0.0, total = 0.0;
    for (std::size_t k = 0; k < weight.size(); ++k) {
      sum += weight[k] * row[d][k];
      total += weight[k];
    }
    return sum / total;
  }
  [[nodiscard]] double Covariance(std::size_t i, std::size_t j) const {
    const double a = Mean(i), b = Mean(j);
    double sum = 0.0, total = 0.0;
    for (std::size_t k = 0; k < weight.size(); ++k) {
      sum += weight[k] * (row[i][k] - a) * (row[j][k] - b);
      total += weight[k];
    }
    return sum / total;
  }

  static constexpr std::size_t kRows = kMaxParams + 2;  // as the fit asks for
  WeightedDraws draws;
  std::vector<double> row[kMaxParams], weight, room[kRows];
  double* scratch[kRows] = {};
  MarginalTable tables[kMaxParams];
  DensityBlock block;
};

}  // namespace armcmc::test
