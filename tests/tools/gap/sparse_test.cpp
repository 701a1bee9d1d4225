#include "sparse.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "tools/gap/gap_rig.hpp"

namespace armcmc::gap::sparse_test {
namespace {

constexpr int kRows = 6000;
constexpr double kNoise = 0.02;

/// What is said of a contact whose force has `extra(x, v)` besides.
std::vector<SparseTerm> Described(const std::function<double(double, double)>& extra) {
  const auto equation = MakeEquation("hunt_crossley");
  Recording recording = test::Measure({}, kRows, kNoise, 5).recording;
  const Vector x = recording.Column("x"), v = recording.Column("v");
  Vector f = recording.Column("f");
  for (Eigen::Index i = 0; i < f.size(); ++i) f[i] += extra(x[i], v[i]);
  Diagnosis diagnosis = CompareOnly(*equation, test::MakeRecording(recording.t, x, v, f));
  // The noise is known here, so that what is added cannot be taken for it.
  diagnosis.wide->fitter = std::make_unique<Fitter>(*equation, diagnosis.wide->signals, test::White(kNoise));
  Fitted base = diagnosis.wide->fitter->Fit({}, diagnosis.wide->finding.base->fit.theta, 30);
  diagnosis.finding.gap = base.squares / (kRows * kNoise * kNoise) - 1.0;
  diagnosis.wide->finding.base->fit = std::move(base);
  return DescribeSparsely(*equation, diagnosis);
}

TEST(DescribeSparsely, FindsTheOneTermThatIsMissing) {
  const auto terms = Described([](double, double v) { return 0.02 * v * std::abs(v); });
  ASSERT_FALSE(terms.empty());
  EXPECT_EQ(terms[0].expression, "v |v|");
  EXPECT_GT(terms[0].share, 0.9);
  ASSERT_EQ(terms.size(), 1u);
  EXPECT_NEAR(terms[0].coefficient, 0.02, 0.001);
}

TEST(DescribeSparsely, SaysInWhichModeATermActs) {
  const auto terms = Described([](double x, double v) { return x > 0.0 ? 0.0 : 0.08 * v * v * v; });
  ASSERT_FALSE(terms.empty());
  EXPECT_EQ(terms[0].expression, "v^3 [free motion]");
  EXPECT_NEAR(terms[0].coefficient, 0.08, 0.004);
}

TEST(DescribeSparsely, SaysNothingOfNoise) {
  EXPECT_TRUE(Described([](double, double) { return 0.0; }).empty());
}

}  // namespace
}  // namespace armcmc::gap::sparse_test
