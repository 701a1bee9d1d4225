#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <memory>

#include "armcmc/expression/compile.hpp"
#include "armcmc/expression/features.hpp"
#include "core/estimator_rig.hpp"
#include "core/expression/plant_words.hpp"
#include "core/expression/tree_walk.hpp"
#include "core/kernel_sets.hpp"

namespace armcmc::tape_test {
namespace {

using expression::CompiledTape;
using expression::CompileTape;
using expression::FeatureMemory;
using expression::FeatureProgram;
using expression::Graph;
using expression::Parse;
using expression::Syntax;
using expression::TapeScalars;

constexpr int kSamples = 4;
constexpr int kParameters = 4;  // K, B, p, tau

double SignalAt(int signal, int n) { return std::sin(1.3 * n + 2.1 * signal) * (1.0 + 0.5 * signal); }
double ParameterOf(int parameter, int lane) {
  return 0.05 + 0.37 * (1 + parameter) + 0.11 * ((lane * (3 + parameter)) % 17);
}

std::map<std::string, double> ValuesAt(int n, int lane) {
  return {{"x", SignalAt(0, n)},
          {"v", SignalAt(1, n)},
          {"u", SignalAt(2, n)},
          {"t", 0.1 * n},
          {"g", 9.81},
          {"L", 1.0},
          {"K", ParameterOf(0, lane)},
          {"B", ParameterOf(1, lane)},
          {"p", ParameterOf(2, lane)},
          {"tau", ParameterOf(3, lane)}};
}

/// A law on its way: text, graph, features, tape.
struct Law {
  explicit Law(const std::string& text) : syntax(Parse(text)) {
    const expression::Scope scope = test::PlantWords();
    node = graph.Lower(syntax, scope, {});
    compiled = CompileTape(&graph, {node}, {.num_parameters = kParameters});
    const FeatureProgram features(graph, compiled.scalars);
    FeatureMemory memory;
    scalars->stride = static_cast<int>(compiled.scalars.size());
    for (int n = 0; n < kSamples; ++n) {
      const double signals[] = {SignalAt(0, n), SignalAt(1, n), SignalAt(2, n)};
      features.Evaluate({signals, 0.1 * n, 0.1}, &memory, scalars->Row(n));
    }
    data->num_samples = kSamples;
    data->tape = data->error_tape = &compiled.tape;
    data->scalars = scalars.get();
    data->weighted = false;
    for (std::size_t n = 0; n < kSamples; ++n) data->sample[n] = static_cast<std::int16_t>(n);
    for (int d = 0; d < kParameters; ++d)
      for (int lane = 0; lane < kTileLanes; ++lane)
        theta.value[static_cast<std::size_t>(d)][static_cast<std::size_t>(lane)] = ParameterOf(d, lane);
  }

  const PredictionTile& Predict(const simd::Kernels& kernels) {
    kernels.predict(-1, *data, theta, tile.get());
    return *tile;
  }

  Syntax syntax;
  Graph graph;
  int node = -1;
  CompiledTape compiled;
  std::unique_ptr<TapeScalars> scalars = std::make_unique<TapeScalars>();
  std::unique_ptr<ModeData> data = std::make_unique<ModeData>();
  std::unique_ptr<PredictionTile> tile = std::make_unique<PredictionTile>();
  ThetaTile theta{};
};

/// Largest change of the tree's value when its inputs change by some 1e-13 of themselves: what rounding may do. Not a
/// number where that decides whether there is a value.
double Sensitivity(const Syntax& syntax, const std::map<std::string, double>& values, double value) {
  double largest = 0.0;
  for (int k = 0; k < 6; ++k) {
    auto shifted = values;
    int sign = k;
    for (auto& [name, v] : shifted) v *= 1.0 + 1e-13 * (((sign = sign * 5 + 3) % 7) - 3);
    const double other = test::TreeWalk<double>(syntax, shifted).Value();
    if (std::isfinite(value) != std::isfinite(other)) return std::nan("");
    if (std::isfinite(value)) largest = std::fmax(largest, std::fabs(other - value));
  }
  return largest;
}

enum class Without { kChecked, kSkipped };

/// The first value that is not the tree's, of all instruction sets; empty where there is none.
/// @param without_value  Where a part of the tree is not finite: zero times what is not a number is zero for the graph.
std::string DifferenceFromTree(const std::string& text, Without without_value) {
  Law law(text);
  std::ostringstream said;
  for (const simd::Kernels* kernels : test::RunnableKernels()) {
    const PredictionTile& tile = law.Predict(*kernels);
    for (int n = 0; n < kSamples; ++n) {
      for (int lane = 0; lane < kTileLanes; lane += 11) {
        const auto values = ValuesAt(n, lane);
        const test::TreeWalk<double> tree(law.syntax, values);
        const double expected = tree.Value();
        if (tree.overflowed() && without_value == Without::kSkipped) continue;
        const double found = tile.value[static_cast<std::size_t>(n)][static_cast<std::size_t>(lane)];
        const double rounding = Sensitivity(law.syntax, values, expected);
        // Powers end where exponents of doubles do: those beyond are of another size, not of another sign.
        if (std::isnan(rounding) || std::fabs(expected) > 1e150) continue;
        const bool same = std::isfinite(expected)
                              ? std::fabs(found - expected) <= 3e-13 * (1.0 + std::fabs(expected)) + 10.0 * rounding
                              : !(std::fabs(found) < 1e100);
        if (same) continue;
        said << text << " is " << found << ", expected " << expected << " within " << rounding << " (" << kernels->name
             << ", sample " << n << ", lane " << lane << ')';
        return said.str();
      }
    }
  }
  return "";
}

TEST(Tape, EveryFunctionIsWhatTheTreeSays) {
  for (const char* text : {"K",
                           "2.5",
                           "x",
                           "-K",
                           "K + B",
                           "K - B",
                           "K*B",
                           "K/B",
                           "x/K",
                           "K/3",
                           "K^2",
                           "K^-3",
                           "K^7",
                           "K^0.5",
                           "K^p",
                           "abs(x)^p",
                           "K^x",
                           "(K - 1)^p",
                           "abs(K - 1)",
                           "sign(K - 1)",
                           "sign(K - K)",
                           "sqrt(K)",
                           "sqrt(K - 1)",
                           "exp(K*x)",
                           "exp(-300*K)",
                           "log(K)",
                           "log(K - 1)",
                           "log2(K)",
                           "log10(K)",
                           "sin(10*K)",
                           "cos(10*K)",
                           "tan(K)",
                           "sin(1e5*K)",
                           "asin(x*K/4)",
                           "acos(x*K/4)",
                           "asin(K)",
                           "atan(K*x)",
                           "atan(20*x*K)",
                           "tanh(K*x)",
                           "tanh(9*K)",
                           "min(K, B)",
                           "max(K, x)",
                           "clamp(K, 0.5, B)",
                           "step(K - 1)",
                           "if(K < B, x, v)",
                           "if(K <= B and x > 0, K, B)",
                           "if(not K == B or x > v, K, 1)",
                           "if(x != 0, K, B)",
                           "max(x, 0)^p",
                           "(K < B) + (x < K)"})
    EXPECT_EQ(DifferenceFromTree(text, Without::kChecked), "");
}

TEST(Tape, LawsAreWhatTheTreeSays) {
  for (const char* text : {"max(x, 0)^p * (K + B*v)", "K*x + B*v + p", "v*(K + B*(x - g)) + tau*x*v",
                           "K*tanh(v/tau) + B*x^3 + p*x", "(K*x + B)*(p*v + tau)*(K + 1)", "(u - B*v - K*x)/p",
                           "K*x*v*u/(1 + exp(-tau*x))", "g*sin(x)*K + B*v*abs(v) - tau",
                           "(K + B*x)*(K + B*x) + sin(K + B*x)", "K*B*p*tau", "K*(B + p)*x - (B + p)*v + 0*K"})
    EXPECT_EQ(DifferenceFromTree(text, Without::kChecked), "");
}

/// A random expression, small ones first. Every choice is a statement of its own: the order of what is chosen is the
/// same for all compilers.
rc::Gen<std::string> AnyExpression(int depth) {
  return rc::gen::exec([depth]() -> std::string {
    const int kind = depth == 0 ? *rc::gen::inRange(0, 3) : *rc::gen::inRange(0, 12);
    const auto inner = [depth] { return *AnyExpression(depth - 1); };
    const auto one_of = [](std::vector<std::string> words) { return *rc::gen::elementOf(std::move(words)); };
    if (kind == 0) return one_of({"0", "1", "2", "0.5", "3.75", "1e-2", "g", "L"});
    if (kind == 1) return one_of({"x", "v", "u", "t"});
    if (kind == 2) return one_of({"K", "B", "p", "tau"});
    const std::string first = inner();
    if (kind == 7) {
      const std::string f = one_of({"sin", "cos", "tanh", "atan", "exp", "abs", "sign", "step", "-"});
      return f + '(' + first + ')';
    }
    if (kind == 8) {
      const std::string f = one_of({"sqrt", "log", "log2", "asin", "acos", "tan", "log10"});
      return f + '(' + first + ')';
    }
    if (kind == 10) return '(' + first + ")^" + one_of({"2", "3", "-1", "0.5", "p", "(K/2)", "100"});
    const std::string second = inner();
    if (kind < 7) return '(' + first + one_of({" + ", " - ", "*", "*", "/"}) + second + ')';
    if (kind == 9) return one_of({"min(", "max("}) + first + ", " + second + ')';
    const std::string relation = one_of({" < ", " <= ", " != "});
    const std::string third = inner();
    return "if(" + first + relation + second + ", " + third + ", " + inner() + ')';
  });
}

TEST(Tape, TenThousandExpressionsAreWhatTheTreeSays) {
  rc::detail::TestParams params;
  params.maxSuccess = 10'000;
  params.seed = 20'261'125;
  const auto result = rc::detail::checkTestable(
      [] {
        const std::string text = *AnyExpression(4);
        RC_ASSERT(DifferenceFromTree(text, Without::kSkipped) == "");
      },
      rc::detail::TestMetadata{}, params);
  std::ostringstream said;
  rc::detail::printResultMessage(result, said);
  EXPECT_TRUE(result.is<rc::detail::SuccessResult>()) << said.str();
}

// Half of the lanes take the hardware's root, the others products.
TEST(Tape, RootsOfAnySizeInEveryLane) {
  using Limits = std::numeric_limits<double>;
  const std::vector<double> numbers = {0.0,
                                       5e-324,
                                       1e-310,
                                       3e-300,
                                       2.2e-308,
                                       1e-200,
                                       0.3,
                                       0.25,
                                       1.0,
                                       2.0,
                                       3.9,
                                       1e-290,
                                       7.0,
                                       1e17,
                                       1e200,
                                       1.7e308,
                                       -1.0,
                                       -1e-300,
                                       Limits::infinity(),
                                       Limits::quiet_NaN(),
                                       5.0};
  Law law("sqrt(K)");
  for (std::size_t turn = 0; turn < numbers.size(); ++turn) {
    for (std::size_t lane = 0; lane < kTileLanes; ++lane)
      law.theta.value[0][lane] = numbers[(turn + 5 * lane) % numbers.size()] * (1.0 + 0.01 * static_cast<double>(lane));
    for (const simd::Kernels* kernels : test::RunnableKernels()) {
      const PredictionTile& tile = law.Predict(*kernels);
      for (std::size_t lane = 0; lane < kTileLanes; ++lane) {
        const double x = law.theta.value[0][lane], found = tile.value[0][lane];
        if (std::isfinite(std::sqrt(x))) {
          EXPECT_NEAR(found, std::sqrt(x), 5e-16 * std::sqrt(x) + 1e-140) << kernels->name << lane << " " << x;
        } else {
          EXPECT_TRUE(test::SameBits(std::fabs(found), std::fabs(std::sqrt(x)))) << kernels->name << lane << " " << x;
        }
      }
    }
  }
}

TEST(Tape, SameBitsOnEveryFusedInstructionSet) {
  const auto sets = test::FusedKernels();
  if (sets.size() < 2) GTEST_SKIP() << "this CPU has one of them only";
  for (const char* text :
       {"max(x, 0)^p * (K + B*v)", "sin(K*x)*exp(-v/tau) + atan(B)/tanh(p*x) + log(K)^p + sqrt(B + x)"}) {
    Law law(text);
    const PredictionTile first = law.Predict(*sets[0]);
    for (const simd::Kernels* kernels : sets) {
      const PredictionTile& other = law.Predict(*kernels);
      for (std::size_t n = 0; n < kSamples; ++n)
        for (std::size_t lane = 0; lane < kTileLanes; ++lane)
          EXPECT_EQ(std::bit_cast<std::uint64_t>(other.value[n][lane]),
                    std::bit_cast<std::uint64_t>(first.value[n][lane]))
              << text;
    }
  }
}

struct Scored {
  const char* text;
  expression::TapeShape shape;
};

class Score : public testing::TestWithParam<Scored> {};

TEST_P(Score, IsThatOfThePredictions) {
  Law law(GetParam().text);
  EXPECT_EQ(law.compiled.tape.shape, GetParam().shape);
  const NoiseModel noise(NoiseSettings{.std = 0.5});
  alignas(64) std::array<double, kTileLanes> log_scale{};
  log_scale.fill(std::log(0.5));
  // With a bound on the exponent powers are shorter, and a little less exact.
  for (const double largest_exponent : {1e300, 20.0}) {
    law.compiled.tape.largest_exponent = largest_exponent;
    for (const bool weighted : {false, true}) {
      law.data->weighted = weighted;
      for (std::size_t n = 0; n < kSamples; ++n)
        law.data->weight[n] = weighted ? 1.0 / (1.0 + static_cast<double>(n)) : 1.0;
      for (const simd::Kernels* kernels : test::RunnableKernels()) {
        const PredictionTile tile = law.Predict(*kernels);
        alignas(64) std::array<double, kTileLanes> score{};
        kernels->score(-1, noise, *law.data, law.theta, log_scale.data(), law.tile.get(), score.data());
        for (std::size_t lane = 0; lane < kTileLanes; ++lane) {
          double expected = 0.0;  // here the tape is law - target: its target is 0
          for (std::size_t n = 0; n < kSamples; ++n)
            expected += noise.LogDensity(tile.value[n][lane] * law.data->weight[n], 0.5);
          const double tolerance = largest_exponent > 100.0 ? 1e-12 : 1e-9;
          EXPECT_NEAR(score[lane], expected, tolerance * (1.0 + std::fabs(expected))) << kernels->name << " " << lane;
        }
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    Tape, Score,
    testing::Values(Scored{"K*x", expression::TapeShape::kLinear},
                    Scored{"K*x + B - u", expression::TapeShape::kLinear},
                    Scored{"K*x + B*v - p*u", expression::TapeShape::kLinear},
                    Scored{"K*x + B*v - p*u + tau*x*v - sin(x)", expression::TapeShape::kLinear},
                    Scored{"max(x, 0)^p * (K + B*v) - u", expression::TapeShape::kPower},
                    Scored{"max(x, 0)^p * K - u", expression::TapeShape::kPower},
                    Scored{"abs(v)^p * (K*u + B*v) + tau*x - u", expression::TapeShape::kPower},
                    Scored{"abs(v)^(2*p) * (K*u + x) - tau*x", expression::TapeShape::kPower},
                    Scored{"K*max(x, 0)^p + B*v*abs(x)^tau - u", expression::TapeShape::kPower},
                    Scored{"K*abs(x)^p + (B*v + u)*abs(v)^tau + p*x - u", expression::TapeShape::kPower},
                    Scored{"K*abs(x)^p + B*abs(v)^p + tau", expression::TapeShape::kPower},
                    Scored{"K*abs(x)^p + B*abs(x)^p*v - u", expression::TapeShape::kPower},
                    Scored{"K*abs(x)^p + B*abs(v)^p + tau*abs(u)^p - u", expression::TapeShape::kGeneral},
                    Scored{"K*x*sin(B) - u", expression::TapeShape::kGeneral},
                    Scored{"abs(v)^p * abs(x)^tau + K", expression::TapeShape::kGeneral},
                    Scored{"abs(v)^p * (K*sin(B) + x) - u", expression::TapeShape::kGeneral}),
    [](const auto& info) { return "n" + std::to_string(info.index); });

TEST(Tape, IsAsShortAsTheLawAllows) {
  EXPECT_EQ(Law("K*x + B*v + p").compiled.tape.size(), 2) << "one sum of two terms";
  EXPECT_EQ(Law("max(x, 0)^p * (K + B*v)").compiled.tape.size(), 3) << "a power, a sum, a product";
  EXPECT_EQ(Law("v*(K + B*(x - g))").compiled.tape.size(), 2) << "v and v (x - g) are features";
  const Law once("exp(K*B)*x");
  EXPECT_EQ(once.compiled.tape.once, 2) << "what needs no sample is computed once";
}

TEST(Tape, LimitsAreErrorsThatSaySo) {
  std::string many = "K*x";
  for (int k = 0; k < 60; ++k) many += " + B*sin(" + std::to_string(k + 2) + "*x)";
  EXPECT_NO_THROW(Law{many}) << "one feature: the sum";
  std::string scalars = "K";
  for (int k = 0; k < 60; ++k) scalars += " + sin(B*(x + " + std::to_string(k + 1) + "))";
  EXPECT_THROW(Law{scalars}, std::length_error);
  EXPECT_THROW(Law{"lowpass(K*x, 0.1)"}, std::invalid_argument);
  EXPECT_THROW(Law{"lowpass(x, tau)"}, std::invalid_argument);
}

}  // namespace
}  // namespace armcmc::tape_test
