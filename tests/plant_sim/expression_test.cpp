// The simulated plant's own reading of the expression language.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "armcmc/plant_sim/expression/expression.hpp"
#include "armcmc/plant_sim/expression/jet.hpp"

namespace armcmc::plant_sim::expression_test {
namespace {

using expression::Expression;
using expression::Jet;
using testing::HasSubstr;

double Value(const std::string& text) { return Expression(text, {}).Evaluate({}, 0.0); }

TEST(PlantExpression, BindsAsTheLanguageSays) {
  EXPECT_EQ(Value("1 + 2*3 - 4/2"), 5.0);
  EXPECT_EQ(Value("8 - 3 - 2"), 3.0);
  EXPECT_EQ(Value("2^3^2"), 512.0) << "right associative";
  EXPECT_EQ(Value("-2^2"), -4.0) << "^ binds more than the sign";
  EXPECT_EQ(Value("2^-1"), 0.5);
  EXPECT_EQ(Value("2*-3"), -6.0);
  EXPECT_EQ(Value("(1 + 2)*3"), 9.0);
  EXPECT_EQ(Value("1e-3 + .5 + 2."), 2.501);
  EXPECT_EQ(Value("1 < 2 and not 3 <= 2 or 0"), 1.0);
  EXPECT_EQ(Value("not 1 == 1"), 0.0) << "not binds less than ==";
  EXPECT_EQ(Value("0 and 0 or 1"), 1.0);
  EXPECT_EQ(Value("1 + 1 > 1"), 1.0);
  EXPECT_EQ(Value("2 != 2"), 0.0);
}

TEST(PlantExpression, HasTheFunctionsOfTheLanguage) {
  EXPECT_EQ(Value("abs(-2) + sign(-3) + sign(0) + sqrt(9)"), 4.0);
  EXPECT_EQ(Value("min(1, 2) + 10*max(1, 2) + 100*clamp(5, 0, 3)"), 321.0);
  EXPECT_EQ(Value("step(0) + step(-1e-9)"), 1.0);
  EXPECT_EQ(Value("if(2 > 1, 5, 1/0)"), 5.0);
  EXPECT_DOUBLE_EQ(Value("exp(log(3)) + log2(8) + log10(1000)"), 9.0);
  EXPECT_DOUBLE_EQ(Value("sin(1)^2 + cos(1)^2 + tan(0.5)/tan(0.5)"), 2.0);
  EXPECT_DOUBLE_EQ(Value("asin(0.5) + acos(0.5) + 2*atan(1) + tanh(0)"), std::numbers::pi);
  EXPECT_TRUE(std::isnan(Value("(0 - 2)^0.5")));
  EXPECT_EQ(Value("(0 - 2)^3"), -8.0);
}

TEST(PlantExpression, SaysWhereItIsWrong) {
  const auto expect = [](const std::string& text, int column, const std::string& words) {
    try {
      static_cast<void>(Expression(text, {"x", "t"}));
      ADD_FAILURE() << text;
    } catch (const expression::Error& error) {
      EXPECT_EQ(error.column(), column) << text;
      EXPECT_THAT(error.what(), HasSubstr(words)) << text;
    }
  };
  expect("x + y", 5, "\"y\"");
  expect("x +", 4, "the end");
  expect("x * (2 + t", 11, "\")\"");
  expect("2 x", 3, "expected an operator");
  expect("sinus(x)", 1, "sinus");
  expect("1 + min(x)", 5, "2 arguments, not 1");
  expect("0 < x < 1", 7, "and");
  expect("x $ 2", 3, "$");
  expect("and", 1, "and");
  expect("", 1, "the end");
  expect("1e999", 1, "double");
  expect(std::string(1000, '('), 202, "deeply");
  expect(std::string(1000, '-') + "x", 202, "deeply");
}

/// Outputs at samples 0.1 s apart.
std::vector<double> Samples(const std::string& text, const std::vector<double>& x) {
  Expression expression(text, {"x"});
  std::vector<double> out;
  for (std::size_t n = 0; n < x.size(); ++n) out.push_back(expression.Evaluate({x[n]}, n == 0 ? 0.0 : 0.1));
  return out;
}

TEST(PlantExpression, RemembersExactlyWhatIsLinearBetweenSamples) {
  const std::vector<double> ramp = {1.0, 1.3, 1.6, 1.9, 2.2};  // 1 + 3 t
  EXPECT_THAT(Samples("previous(x)", ramp), testing::ElementsAre(1.0, 1.0, 1.3, 1.6, 1.9));
  EXPECT_THAT(Samples("elapsed()", ramp), testing::Pointwise(testing::DoubleNear(1e-15), {0.0, 0.1, 0.2, 0.3, 0.4}));
  for (std::size_t n = 0; n < ramp.size(); ++n) {
    const double t = 0.1 * static_cast<double>(n);
    EXPECT_NEAR(Samples("integral(x)", ramp)[n], t + 1.5 * t * t, 1e-15);
    // tau y' = 1 + 3 t - y, y(0) = 1: closed form.
    EXPECT_NEAR(Samples("lowpass(x, 0.25)", ramp)[n], 1.0 + 3.0 * (t - 0.25 + 0.25 * std::exp(-t / 0.25)), 1e-14);
    EXPECT_NEAR(Samples("delay(x, 0.15)", ramp)[n], t < 0.15 ? 1.0 : 1.0 + 3.0 * (t - 0.15), 1e-14);
  }
  EXPECT_EQ(Samples("delay(x, 0 - 1)", ramp), ramp);
  EXPECT_EQ(Samples("lowpass(x, 0)", ramp), ramp);
  // A branch that is not taken follows the time, too.
  EXPECT_NEAR(Samples("if(x > 2, integral(x), 0)", ramp)[4], 0.4 + 1.5 * 0.16, 1e-15);
}

TEST(PlantExpression, RemembersExactlyWhatIsHeldBetweenSamples) {
  const std::vector<double> x = {1.0, 2.0, 4.0, 3.0, 5.0};
  const auto samples = [&x](const std::string& text) {
    Expression expression(text, {"x"}, {true});
    std::vector<double> out;
    for (std::size_t n = 0; n < x.size(); ++n) out.push_back(expression.Evaluate({x[n]}, n == 0 ? 0.0 : 0.1));
    return out;
  };
  const auto near = [](const std::vector<double>& values) {
    return testing::Pointwise(testing::DoubleNear(1e-14), values);
  };
  EXPECT_THAT(samples("integral(2*x)"), near({0.0, 0.2, 0.6, 1.4, 2.0}));
  EXPECT_THAT(samples("delay(x, 0.15)"), near({1.0, 1.0, 1.0, 2.0, 4.0}));
  EXPECT_THAT(samples("delay(x, 0.2)"), near({1.0, 1.0, 1.0, 2.0, 4.0}));
  const double decay = std::exp(-0.1 / 0.25);
  const std::vector<double> y = samples("lowpass(x, 0.25)"), late = samples("integral(delay(x, 0.05))");
  for (std::size_t n = 1; n < x.size(); ++n) {
    EXPECT_NEAR(y[n], y[n - 1] * decay + x[n - 1] * (1.0 - decay), 1e-14);
    EXPECT_NEAR(late[n] - late[n - 1], 0.05 * (x[n - 1] + x[n > 1 ? n - 2 : 0]), 1e-14) << "half of either";
  }
  EXPECT_THAT(samples("integral(x + elapsed())"), near({0.0, 0.155, 0.47, 0.845, 1.28})) << "is not held";
}

TEST(PlantExpression, DerivativesOfTimeAreThoseOfCentralDifferences) {
  for (const char* text :
       {"3*t^3 - t/2 + 7", "sin(2*t)*exp(-t)", "1/(1 + t^2)", "sqrt(1 + t)", "log(2 + t) + log2(3 + t) + log10(4 + t)",
        "tanh(t) + atan(2*t) + tan(t/2)", "asin(t/3) - acos(t/2)", "(1 + t)^(t/2)", "t^2", "abs(-t)*2", "min(t, 5)*t",
        "clamp(t, 0, 9)^2", "if(t > 0, cos(t), 1)", "2^t"}) {
    Expression expression(text, {"t"});
    const double t = 0.7, h = 1e-3;
    const auto at = [&](double shift) { return expression::Differentiate(expression.tree(), {t + shift}, 0); };
    const Jet jet = at(0.0), before = at(-h), after = at(h);
    EXPECT_DOUBLE_EQ(jet[0], expression.Evaluate({t}, 0.0)) << text;
    // The error of a central difference is h^2 / 6 times the next but one derivative.
    for (std::size_t k = 1; k < jet.size(); ++k)
      EXPECT_NEAR(jet[k], (after[k - 1] - before[k - 1]) / (2.0 * h), 2e-5 * (1.0 + std::abs(jet[k]))) << text << k;
  }
  const Expression square("t^2", {"t"});
  EXPECT_EQ(expression::Differentiate(square.tree(), {0.0}, 0), (Jet{0.0, 0.0, 2.0, 0.0}));
  const Expression memory("1 + integral(t)", {"t"});
  EXPECT_THROW(static_cast<void>(expression::Differentiate(memory.tree(), {0.0}, 0)), expression::Error);
}

}  // namespace
}  // namespace armcmc::plant_sim::expression_test
