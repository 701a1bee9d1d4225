#pragma once

#include <algorithm>
#include <cmath>

namespace armcmc::plant_sim {

/// One step of Bogacki and Shampine's third-order method (1989) for y' = f(t, y):
///
///   k1 = f(t, y)    k2 = f(t + h/2, y + h/2 k1)    k3 = f(t + 3h/4, y + 3h/4 k2)
///   y(t + h) = y + h (2/9 k1 + 1/3 k2 + 4/9 k3)
///
/// At h = 1 ms it is the fixed-step solver behind the paper's traces, so that they come out digit by digit.
template <typename Vector, typename Function>
[[nodiscard]] Vector BogackiShampineStep(const Function& f, double t, const Vector& y, double h) {
  const Vector k1 = f(t, y);
  const Vector k2 = f(t + 0.5 * h, Vector(y + 0.5 * h * k1));
  const Vector k3 = f(t + 0.75 * h, Vector(y + 0.75 * h * k2));
  return y + h * (2.0 / 9.0 * k1 + 1.0 / 3.0 * k2 + 4.0 / 9.0 * k3);
}

/// Number of equal steps that cover an interval with steps of at most max_step_s, >= 1.
[[nodiscard]] inline int NumSubsteps(double interval_s, double max_step_s) {
  return std::max(1, static_cast<int>(std::ceil(interval_s / max_step_s - 1e-9)));
}

}  // namespace armcmc::plant_sim
