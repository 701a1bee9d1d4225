#include "plants/hunt_crossley/log_linear.hpp"

#include <algorithm>
#include <cmath>

namespace armcmc {

// Of a baseline: Eigen's initialisers stand here as the text books have them. All types are bounded; see rls.cpp.
ARMCMC_TRUST_NONBLOCKING_BEGIN

namespace {

constexpr double kLeastForce = 5.0;  // noise scales

void StartLogLinear(const ParameterSpace& s, ParamVector* mean, ParamMatrix* covariance) noexcept ARMCMC_NONBLOCKING {
  const double k = std::fmax(s.offset[0], 1e-3);
  *mean << std::log(k), s.offset[1] / k, s.offset[2];
  covariance->diagonal() << std::pow(s.scale[0] / k, 2), std::pow(s.scale[1] / k, 2), std::pow(s.scale[2], 2);
}

bool LogLinearRow(const ModeData& data, std::size_t sample, double noise, ParamVector* phi, double* y,
                  double* r) noexcept ARMCMC_NONBLOCKING {
  if (*y < kLeastForce * noise) return false;
  *r /= *y * *y;
  *y = std::log(*y);
  *phi << 1.0, data.feature[1][sample], data.feature[0][sample] / 1.4426950408889634;  // log2 x to log x
  return true;
}

void SaturateLogLinear(const ParameterSpace& s, ParamVector* state) noexcept ARMCMC_NONBLOCKING {
  ParamVector& z = *state;
  const double k = std::clamp(std::exp(std::clamp(z[0], -20.0, 20.0)), std::fmax(s.Theta(0, s.lower[0]), 1e-3),
                              s.Theta(0, s.upper[0]));
  z[0] = std::log(k);
  z[1] = std::clamp(z[1] * k, s.Theta(1, s.lower[1]), s.Theta(1, s.upper[1])) / k;
  z[2] = std::clamp(z[2], s.Theta(2, s.lower[2]), s.Theta(2, s.upper[2]));
}

void LogLinearTheta(const ParamVector& z, double* theta) noexcept ARMCMC_NONBLOCKING {
  theta[0] = std::exp(std::clamp(z[0], -20.0, 20.0));
  theta[1] = theta[0] * z[1];
  theta[2] = z[2];
}

}  // namespace

ARMCMC_TRUST_NONBLOCKING_END

constinit const RegressionForm kLogLinearForm{&StartLogLinear, &LogLinearRow, &SaturateLogLinear, &LogLinearTheta};

}  // namespace armcmc
