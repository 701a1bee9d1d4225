#include <Eigen/Dense>
#include <algorithm>
#include <chrono>
#include <cmath>

#include "armcmc/tables/trace.hpp"

namespace armcmc::tables {
namespace {

/// Sums over the contact so far for one exponent: K and B then follow from two linear equations.
struct Sums {
  double p = 1.0;
  Eigen::Matrix2d gram = Eigen::Matrix2d::Zero();
  Eigen::Vector2d cross = Eigen::Vector2d::Zero();
  double square = 0.0;
};

/// Least squares of (K, B) inside the bounds; 2 unknowns, so the edges are tried one after the other.
double Solve(const Sums& s, const ParameterSettings& k, const ParameterSettings& b, Eigen::Vector2d* best) {
  const auto cost = [&](const Eigen::Vector2d& z) { return s.square - 2.0 * z.dot(s.cross) + z.dot(s.gram * z); };
  const Eigen::Vector2d free = s.gram.ldlt().solve(s.cross);
  const auto inside = [](double v, const ParameterSettings& q) { return v >= q.lower && v <= q.upper; };
  if (free.allFinite() && inside(free[0], k) && inside(free[1], b)) {
    *best = free;
    return cost(free);
  }
  double least = HUGE_VAL;
  const auto offer = [&](Eigen::Vector2d z) {
    z[0] = std::clamp(z[0], k.lower, k.upper);
    z[1] = std::clamp(z[1], b.lower, b.upper);
    if (cost(z) >= least) return;
    least = cost(z);
    *best = z;
  };
  for (const double edge : {k.lower, k.upper})
    offer({edge, (s.cross[1] - s.gram(0, 1) * edge) / std::fmax(s.gram(1, 1), 1e-300)});
  for (const double edge : {b.lower, b.upper})
    offer({(s.cross[0] - s.gram(0, 1) * edge) / std::fmax(s.gram(0, 0), 1e-300), edge});
  return least;
}

}  // namespace

Trace RunBatch(const Recording& recording, const MethodSpec& spec) {
  using Clock = std::chrono::steady_clock;
  constexpr int kGrid = 1501;  // exponents, 0.001 apart
  const auto& parameters = spec.settings.parameters;
  std::vector<Sums> grid(kGrid);
  const double step = (parameters[2].upper - parameters[2].lower) / (kGrid - 1);
  for (int g = 0; g < kGrid; ++g) grid[static_cast<std::size_t>(g)].p = parameters[2].lower + step * g;
  Trace trace{spec.key, spec.label, spec.pack_samples, false, false, {}};
  PackTrace now;
  const int packs = static_cast<int>(recording.size() - 1) / spec.pack_samples;
  for (int k = 1; k <= packs; ++k) {
    const Clock::time_point start = Clock::now();
    int added = 0;
    for (int n = 1; n <= spec.pack_samples; ++n) {
      const auto i = static_cast<std::size_t>(spec.pack_samples * (k - 1) + n);
      const double x = recording.u[0][i];
      if (x <= 0.0) continue;
      ++added;
      const double f = recording.y[i];
      const double v = recording.u[1][i];
      double power = std::pow(x, grid[0].p);
      const double ratio = std::pow(x, step);
      for (Sums& s : grid) {
        s.gram(0, 0) += power * power;
        s.gram(0, 1) += power * power * v;
        s.gram(1, 1) += power * power * v * v;
        s.cross[0] += power * f;
        s.cross[1] += power * v * f;
        s.square += f * f;
        power *= ratio;
      }
    }
    now.modes[0].updated = added > 0;
    if (added > 0) {
      double least = HUGE_VAL;
      for (Sums& s : grid) {
        s.gram(1, 0) = s.gram(0, 1);
        Eigen::Vector2d z;
        const double cost = Solve(s, parameters[0], parameters[1], &z);
        if (cost >= least) continue;
        least = cost;
        now.modes[0].map = {z[0], z[1], s.p};
      }
      now.modes[0].ap = now.modes[0].map;
      now.modes[0].any = now.modes[0].known = true;
    }
    now.ms = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
    trace.packs.push_back(now);
  }
  return trace;
}

}  // namespace armcmc::tables
