#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <vector>

#include "armcmc/data_pack.hpp"
#include "armcmc/settings.hpp"

namespace armcmc::test {

struct MarginalTruth {
  double mean = 0.0, sd = 0.0, q025 = 0.0, q975 = 0.0;
};

/// Dense quadrature of the posterior of one Hunt-Crossley pack under Gaussian noise: an oracle that shares no code with
/// the sampler.
///
/// Given p the likelihood is Gaussian in (K, B): its sufficient statistics cost one sweep over the pack for each node
/// of p. (K, B) is then summed on a grid that follows its conditional mean and shape, so that a narrow ridge gets as
/// many nodes as a round peak. `log_prior(K, B, p)` is any function; -infinity outside its support.
class ContactQuadrature {
 public:
  static constexpr int kPNodes = 81;
  static constexpr int kNodes = 81;  ///< Per axis of (K, B), over +-kReach conditional standard deviations.
  static constexpr double kReach = 7.0;

  using LogPrior = std::function<double(double, double, double)>;

  /// @param p_lower, p_upper   Range of p to sum over; must hold the posterior.
  /// @param grid_mean, grid_precision  Normal law on (K, B) that, with the likelihood, shapes the grid: precision k-k,
  /// k-b, b-b.
  static std::array<MarginalTruth, 3> Run(const DataPack& pack, double noise_std, const LogPrior& log_prior,
                                          double p_lower, double p_upper, const std::array<double, 2>& grid_mean,
                                          const std::array<double, 3>& grid_precision) {
    struct Node {
      double value, log_weight;
    };
    std::array<std::vector<Node>, 3> marginal;
    const double iv = 1.0 / (noise_std * noise_std);
    double top = -HUGE_VAL;
    for (int ip = 0; ip < kPNodes; ++ip) {
      const double p = p_lower + (p_upper - p_lower) * (ip + 0.5) / kPNodes;
      double a = 0, b = 0, c = 0, r1 = 0, r2 = 0, yy = 0;
      for (int n = 0; n < pack.num_samples; ++n) {
        const auto i = static_cast<std::size_t>(n);
        if (pack.u[i][0] < 0.0) continue;
        const double h = std::pow(pack.u[i][0], p);
        const double hv = h * pack.u[i][1];
        a += h * h * iv;
        b += h * hv * iv;
        c += hv * hv * iv;
        r1 += h * pack.y[i] * iv;
        r2 += hv * pack.y[i] * iv;
        yy += pack.y[i] * pack.y[i] * iv;
      }
      const auto log_likelihood = [&](double k, double bb) {
        return -0.5 * (yy - 2.0 * (k * r1 + bb * r2) + k * k * a + 2.0 * k * bb * b + bb * bb * c);
      };
      // Grid: likelihood times a normal law with the given precision.
      const double ga = a + grid_precision[0], gb = b + grid_precision[1], gc = c + grid_precision[2];
      const double g1 = r1 + grid_precision[0] * grid_mean[0] + grid_precision[1] * grid_mean[1];
      const double g2 = r2 + grid_precision[1] * grid_mean[0] + grid_precision[2] * grid_mean[1];
      const double det = ga * gc - gb * gb;
      const double mk = (gc * g1 - gb * g2) / det, mb = (ga * g2 - gb * g1) / det;
      const double l11 = std::sqrt(gc / det), l21 = -gb / det / l11,
                   l22 = std::sqrt(std::fmax(ga / det - l21 * l21, 0.0));
      const double cell = l11 * l22;
      for (int i = 0; i < kNodes; ++i)
        for (int j = 0; j < kNodes; ++j) {
          const double z1 = kReach * (2.0 * (i + 0.5) / kNodes - 1.0), z2 = kReach * (2.0 * (j + 0.5) / kNodes - 1.0);
          const double k = mk + l11 * z1, bb = mb + l21 * z1 + l22 * z2;
          const double prior = log_prior(k, bb, p);
          if (!(prior > -HUGE_VAL)) continue;
          const double w = log_likelihood(k, bb) + prior + std::log(cell);
          top = std::fmax(top, w);
          marginal[0].push_back({k, w});
          marginal[1].push_back({bb, w});
          marginal[2].push_back({p, w});
        }
    }
    std::array<MarginalTruth, 3> out;
    for (std::size_t d = 0; d < 3; ++d) {
      auto& nodes = marginal[d];
      double z = 0, m = 0, v = 0;
      for (auto& n : nodes) {
        n.log_weight = std::exp(n.log_weight - top);
        z += n.log_weight;
        m += n.log_weight * n.value;
      }
      m /= z;
      for (const auto& n : nodes) v += n.log_weight * (n.value - m) * (n.value - m);
      out[d].mean = m;
      out[d].sd = std::sqrt(v / z);
      // Quantiles from a fine histogram, linear within a bin: 40 bins a standard deviation.
      constexpr int kBins = 800;
      std::array<double, kBins> bins{};
      const double lo = m - 10.0 * out[d].sd, width = 20.0 * out[d].sd / kBins;
      const double half = d == 2 ? 0.5 * (p_upper - p_lower) / kPNodes : 0.0;
      for (const auto& n : nodes) {
        // A node of p stands for its whole cell: spread it evenly.
        const int spread = d == 2 ? 8 : 1;
        for (int s = 0; s < spread; ++s) {
          const double x = n.value + (spread > 1 ? half * (2.0 * (s + 0.5) / spread - 1.0) : 0.0);
          const int bin = std::clamp(static_cast<int>((x - lo) / width), 0, kBins - 1);
          bins[static_cast<std::size_t>(bin)] += n.log_weight / z / spread;
        }
      }
      const auto quantile = [&](double q) {
        double below = 0;
        for (int i = 0; i < kBins; ++i) {
          const double w = bins[static_cast<std::size_t>(i)];
          if (below + w >= q) return lo + width * (i + (q - below) / w);
          below += w;
        }
        return lo + width * kBins;
      };
      out[d].q025 = quantile(0.025);
      out[d].q975 = quantile(0.975);
    }
    return out;
  }
};

}  // namespace armcmc::test
