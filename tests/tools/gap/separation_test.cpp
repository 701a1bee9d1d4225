// Which parameters a fit does not separate, and what it determines of them.
#include "armcmc/gap/separation.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace armcmc::test::separation_test {
namespace {

using gap::FittedParameter;
using gap::Matrix;
using gap::Separate;
using gap::Separation;
using gap::Vector;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

/// Posterior covariance of linear measurements with noise 1 and a prior of standard deviation `prior`.
Matrix CovarianceOf(const Matrix& jacobian, double prior) {
  Matrix information = jacobian.transpose() * jacobian;
  information.diagonal().array() += 1.0 / (prior * prior);
  return information.inverse();
}

TEST(Separate, ASumAndADifferenceDetermineBoth) {
  Matrix jacobian(2, 2);
  jacobian << 10.0, 10.0, 10.0, -10.0;
  const Separation separation = Separate({{"a", "N", 1.0}, {"b", "N", 2.0}}, CovarianceOf(jacobian, 100.0));
  EXPECT_THAT(separation.confounded_with, ElementsAre(IsEmpty(), IsEmpty()));
  EXPECT_THAT(separation.combinations, IsEmpty());
}

TEST(Separate, FrictionInBothDirectionsTwiceIsKnownByItsSums) {
  // A force against the motion that is F on its own, plus Fp forwards and Fm backwards; d is something else.
  Matrix jacobian(3, 4);
  jacobian << 20.0, 20.0, 0.0, 0.0, 20.0, 0.0, 20.0, 0.0, 0.0, 0.0, 0.0, 20.0;
  const Separation separation =
      Separate({{"F", "N", 13.0}, {"Fp", "N", 7.0}, {"Fm", "N", 6.0}, {"d", "N", 5.0}}, CovarianceOf(jacobian, 30.0));
  EXPECT_THAT(separation.confounded_with,
              ElementsAre(ElementsAre("Fp", "Fm"), ElementsAre("F"), ElementsAre("F"), IsEmpty()));
  ASSERT_THAT(separation.combinations, SizeIs(2));
  EXPECT_EQ(separation.combinations[0].text, "Fp + F");
  EXPECT_NEAR(separation.combinations[0].value, 20.0, 1e-9);
  EXPECT_NEAR(separation.combinations[0].sd, 0.05, 0.001);
  EXPECT_EQ(separation.combinations[0].unit, "N");
  EXPECT_EQ(separation.combinations[1].text, "Fm + F");
  EXPECT_NEAR(separation.combinations[1].value, 19.0, 1e-9);
}

TEST(Separate, ThreeOfWhichOnlyTheSumActs) {
  const Separation separation =
      Separate({{"a", "V", 1.0}, {"b", "V", 2.0}, {"c", "V", 4.0}}, CovarianceOf(Matrix::Constant(1, 3, 50.0), 10.0));
  ASSERT_THAT(separation.combinations, SizeIs(1));
  EXPECT_EQ(separation.combinations[0].text, "c + a + b");
  EXPECT_THAT(separation.combinations[0].parameters, ElementsAre("c", "a", "b"));
  EXPECT_NEAR(separation.combinations[0].value, 7.0, 1e-9);
  EXPECT_NEAR(separation.combinations[0].sd, 0.02, 0.001);
  EXPECT_THAT(separation.confounded_with[1], ElementsAre("a", "c"));
}

TEST(Separate, CoefficientsAreAsLongAsTheyMustBe) {
  Matrix jacobian(1, 2);
  jacobian << 30.0, 30.0 * 0.41234;
  const Separation separation = Separate({{"a", "N", 1.0}, {"b", "m", -2.0}}, CovarianceOf(jacobian, 10.0));
  ASSERT_THAT(separation.combinations, SizeIs(1));
  const gap::Combination& c = separation.combinations[0];
  // b + a / 0.41234 = b + 2.4252 a: rounding by 0.005 adds 0.02 to a standard deviation of 0.08, since a is +- 3.8.
  EXPECT_EQ(c.text, "b + 2.43 a");
  EXPECT_NEAR(c.value, -2.0 + 2.43, 1e-9);
  EXPECT_NEAR(c.sd, 1.0 / (30.0 * 0.41234), 0.01);
}

TEST(Separate, LogarithmsMakeAProduct) {
  // log k + 2 log T is measured: k T^2.
  Matrix jacobian(1, 2);
  jacobian << 100.0, 200.0;
  const Separation separation = Separate({{"k", "N/m", 3.0, true}, {"T", "s", 0.5, true}}, CovarianceOf(jacobian, 2.0));
  ASSERT_THAT(separation.combinations, SizeIs(1));
  const gap::Combination& c = separation.combinations[0];
  EXPECT_EQ(c.text, "T * k^0.5");
  EXPECT_EQ(c.unit, "s (N/m)^0.5");
  EXPECT_NEAR(c.value, 0.5 * std::sqrt(3.0), 1e-9);
  EXPECT_NEAR(c.sd, c.value / 200.0, 0.02 * c.value / 200.0);
}

TEST(Separate, ALogarithmInASumIsTakenAboutTheFit) {
  // F + 4 log(v): d v = v d log(v).
  Matrix jacobian(1, 2);
  jacobian << 50.0, 200.0;
  const Separation separation = Separate({{"F", "N", 3.0}, {"v", "m/s", 0.2, true}}, CovarianceOf(jacobian, 3.0));
  ASSERT_THAT(separation.combinations, SizeIs(1));
  const gap::Combination& c = separation.combinations[0];
  EXPECT_EQ(c.text, "v + 0.05 F");
  EXPECT_NEAR(c.value, 0.2 + 0.05 * 3.0, 1e-9);
  EXPECT_NEAR(c.sd, 0.2 / 200.0, 1e-5);
}

TEST(Separate, WhatIsKnownToHalfItsValueNeedsNoCombination) {
  const auto sum = [](double a, double b) {
    return Separate({{"a", "N", a}, {"b", "N", b}}, CovarianceOf(Matrix::Constant(1, 2, 1000.0), 1.0));
  };
  EXPECT_THAT(sum(100.0, 50.0).combinations, IsEmpty());
  // One that is much smaller is not known, and what it is confounded with is said of it alone.
  const Separation small = sum(100.0, 1.0);
  EXPECT_THAT(small.confounded_with, ElementsAre(IsEmpty(), ElementsAre("a")));
  EXPECT_THAT(small.combinations, SizeIs(1));
}

TEST(Separate, ASumOfManySaysLessThanTheStandardDeviation) {
  std::vector<FittedParameter> parameters;
  for (const char* name : {"a", "b", "c", "d"}) parameters.push_back({name, "V", 1.0});
  const Separation separation = Separate(parameters, CovarianceOf(Matrix::Constant(1, 4, 50.0), 10.0));
  EXPECT_THAT(separation.combinations, IsEmpty());
  EXPECT_THAT(separation.confounded_with, ::testing::Each(IsEmpty()));
}

TEST(Separate, WhatIsHeldFixedTakesNoPart) {
  Matrix covariance = Matrix::Zero(3, 3);
  covariance(0, 0) = covariance(2, 2) = 4.0;
  covariance(0, 2) = covariance(2, 0) = -3.999;
  const Separation separation = Separate({{"a", "N", 1.0}, {"held", "N", 0.0}, {"c", "N", 1.0}}, covariance);
  EXPECT_THAT(separation.confounded_with, ElementsAre(ElementsAre("c"), IsEmpty(), ElementsAre("a")));
  EXPECT_THAT(Separate({}, Matrix()).combinations, IsEmpty());
  covariance(0, 0) = std::nan("");
  EXPECT_THAT(Separate({{"a", "N", 1.0}, {"held", "N", 0.0}, {"c", "N", 1.0}}, covariance).combinations, IsEmpty());
}

}  // namespace
}  // namespace armcmc::test::separation_test
