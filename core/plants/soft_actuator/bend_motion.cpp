#include "plants/soft_actuator/bend_motion.hpp"

namespace armcmc {

void BendMotion::SetInterval(double dt) noexcept {
  if (dt == dt_) return;
  dt_ = dt;
  // Taylor series of exp(M) for the augmented system (alpha, rate, p, slope of p): 30 terms of a matrix with norm
  // q3 dt + q2 dt of order one, scaled by 2^-6 and squared back, leave rounding error only.
  constexpr int kN = 4;
  constexpr int kSquarings = 6;
  using Matrix = std::array<double, kN * kN>;
  const auto multiply = [](const Matrix& a, const Matrix& b) noexcept {
    Matrix c{};
    for (std::size_t i = 0; i < kN; ++i)
      for (std::size_t k = 0; k < kN; ++k)
        for (std::size_t j = 0; j < kN; ++j) c[i * kN + j] += a[i * kN + k] * b[k * kN + j];
    return c;
  };
  const double h = dt / (1 << kSquarings);
  const Matrix m{
      0.0, h,   0.0, 0.0, -constants_.q3 * h, -constants_.q2 * h, constants_.q1 * h, 0.0, 0.0, 0.0, 0.0, h / dt,
      0.0, 0.0, 0.0, 0.0};
  Matrix term{};
  Matrix sum{};
  for (std::size_t i = 0; i < kN; ++i) term[i * kN + i] = sum[i * kN + i] = 1.0;
  for (int k = 1; k <= 30; ++k) {
    term = multiply(term, m);
    for (auto& t : term) t /= k;
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += term[i];
  }
  for (int k = 0; k < kSquarings; ++k) sum = multiply(sum, sum);
  transition_ = {sum[0], sum[1], sum[4], sum[5]};
  // p(t) = p_0 + (p_1 - p_0) t / dt: column 2 acts on p_0, column 3 on p_1 - p_0.
  gain_ = {sum[2] - sum[3], sum[3], sum[6] - sum[7], sum[7]};
}

}  // namespace armcmc
