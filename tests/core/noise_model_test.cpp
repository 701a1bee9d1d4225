#include "armcmc/noise_model.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace armcmc::noise_model_test {
namespace {

NoiseModel Law(NoiseKind kind, double dof = 4.0) {
  NoiseSettings s;
  s.kind = kind;
  s.dof = dof;
  return NoiseModel(s);
}

const std::vector<NoiseKind> kKinds{NoiseKind::kGaussian, NoiseKind::kStudentT, NoiseKind::kLaplace,
                                    NoiseKind::kMixture};

/// Integral of f over the real line: trapezium in s with e = sinh(s), which reaches 1e7.
template <class F>
double Integrate(F f) {
  constexpr int kSteps = 200'000;
  const double reach = std::asinh(1e7);
  double sum = 0.0;
  for (int i = 0; i <= kSteps; ++i) {
    const double s = reach * (2.0 * i / kSteps - 1.0);
    sum += f(std::sinh(s)) * std::cosh(s);
  }
  return sum * 2.0 * reach / kSteps;
}

TEST(NoiseModel, EveryLawIntegratesToOne) {
  for (const NoiseKind kind : kKinds)
    for (const double scale : {0.1, 1.0, 3.0}) {
      const NoiseModel law = Law(kind);
      EXPECT_NEAR(Integrate([&](double e) { return std::exp(law.LogDensity(e, scale)); }), 1.0, 1e-6)
          << static_cast<int>(kind) << " scale " << scale;
    }
}

TEST(NoiseModel, GaussianHasItsClosedForm) {
  const NoiseModel law = Law(NoiseKind::kGaussian);
  EXPECT_NEAR(law.LogDensity(0.3, 0.2), -0.5 * 2.25 - std::log(0.2) - 0.5 * std::log(2.0 * std::numbers::pi), 1e-14);
  EXPECT_NEAR(law.Deviance(0.3, 0.2), 2.25, 1e-13);
  EXPECT_NEAR(law.deviance_mean(), 1.0, 1e-6);
  EXPECT_NEAR(law.deviance_sd(), std::numbers::sqrt2, 1e-6);
  EXPECT_NEAR(law.log_density_mean(), -0.5 * (1.0 + std::log(2.0 * std::numbers::pi)), 1e-6);
  EXPECT_NEAR(law.log_density_sd(), 1.0 / std::numbers::sqrt2, 1e-6);
  EXPECT_NEAR(law.information(), 1.0, 1e-6);
  EXPECT_NEAR(law.scale_information(), 2.0, 1e-6);
}

TEST(NoiseModel, StudentTHasItsClosedForm) {
  for (const double nu : {3.0, 4.0, 8.0}) {
    const NoiseModel law = Law(NoiseKind::kStudentT, nu);
    EXPECT_NEAR(law.information(), (nu + 1.0) / (nu + 3.0), 1e-5) << nu;
    EXPECT_NEAR(law.scale_information(), 2.0 * nu / (nu + 3.0), 1e-5) << nu;
  }
  // dof 1 is the Cauchy law.
  const NoiseModel cauchy = Law(NoiseKind::kStudentT, 1.0);
  EXPECT_NEAR(cauchy.LogDensity(2.0, 1.0), -std::log(std::numbers::pi * 5.0), 1e-12);
  EXPECT_NEAR(cauchy.log_density_mean(), -std::log(4.0 * std::numbers::pi), 1e-4);
  EXPECT_NEAR(cauchy.deviance_mean(), 4.0 * std::numbers::ln2, 1e-4);
}

TEST(NoiseModel, LaplaceHasItsClosedForm) {
  const NoiseModel law = Law(NoiseKind::kLaplace);
  EXPECT_NEAR(law.LogDensity(-0.6, 0.2), -3.0 - std::log(0.4), 1e-14);
  EXPECT_NEAR(law.deviance_mean(), 2.0, 1e-5);  // D = 2 |e|, |e| exponential
  EXPECT_NEAR(law.deviance_sd(), 2.0, 1e-5);
  EXPECT_NEAR(law.log_density_mean(), -1.0 - std::numbers::ln2, 1e-5);
  EXPECT_NEAR(law.information(), 1.0, 1e-3);
  EXPECT_NEAR(law.scale_information(), 1.0, 1e-3);
}

TEST(NoiseModel, MixtureIsTheSumOfItsParts) {
  NoiseSettings s;
  s.kind = NoiseKind::kMixture;
  s.outlier_weight = 0.1;
  s.outlier_scale = 5.0;
  const NoiseModel law(s);
  const auto normal = [](double e, double sd) {
    return std::exp(-0.5 * e * e / (sd * sd)) / (sd * std::sqrt(2.0 * std::numbers::pi));
  };
  for (const double e : {0.0, 0.2, 1.0, 4.0, 9.0})
    EXPECT_NEAR(law.LogDensity(e, 0.7), std::log(0.9 * normal(e, 0.7) + 0.1 * normal(e, 3.5)), 1e-12) << e;
  EXPECT_TRUE(std::isfinite(law.LogDensity(1e4, 1.0)));
  // Between that of the narrow and that of the wide part.
  EXPECT_LT(law.information(), 1.0);
  EXPECT_GT(law.information(), 0.1 / 25.0);
}

TEST(NoiseModel, SquareWeightIsTheScoreOverTheError) {
  for (const NoiseKind kind : kKinds) {
    const NoiseModel law = Law(kind);
    for (const double scale : {0.1, 2.0})
      for (double z = -12.0; z <= 12.0; z += 0.37) {
        // The Laplace law has a corner at zero, where the weight would be infinite: it is bounded near it.
        if (std::fabs(z) < (kind == NoiseKind::kLaplace ? 1.0 : 0.05)) continue;
        const double e = z * scale;
        const double h = 1e-5 * scale;
        const double slope = (law.LogDensity(e + h, scale) - law.LogDensity(e - h, scale)) / (2.0 * h);
        EXPECT_NEAR(law.SquareWeight(e, scale) * scale * scale, -slope / e * scale * scale, 1e-6)
            << static_cast<int>(kind) << " z " << z;
      }
    EXPECT_TRUE(std::isfinite(law.SquareWeight(0.0, 1.0)));
    EXPECT_GT(law.SquareWeight(0.0, 1.0), 0.0);
    EXPECT_GT(law.SquareWeight(1e6, 1.0), 0.0) << "positive, or Gauss-Newton steps the wrong way";
  }
}

}  // namespace
}  // namespace armcmc::noise_model_test
