#include "armcmc/expression/graph.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "armcmc/expression/check.hpp"
#include "armcmc/expression/evaluate.hpp"
#include "core/expression/plant_words.hpp"
#include "core/expression/tree_walk.hpp"

namespace armcmc::graph_test {
namespace {

using expression::Graph;
using expression::GraphNode;
using expression::Op;
using expression::Parse;
using expression::Scope;
using expression::SymbolKind;

/// Lowers a text that its words allow.
int Node(Graph* graph, const std::string& text) {
  const Scope scope = test::PlantWords();
  return graph->Lower(Parse(text), scope, {});
}

double ValueOf(const Graph& graph, int node, const std::map<std::string, double>& values) {
  std::vector<double> made;
  const Scope scope = test::PlantWords();
  for (int n = 0; n <= node; ++n) {
    const GraphNode& at = graph.at(n);
    if (at.op == Op::kNumber) {
      made.push_back(at.value);
    } else if (at.op == Op::kSymbol) {
      for (const auto& symbol : scope.symbols())
        if (symbol.kind == at.kind && symbol.index == at.index) made.push_back(values.at(symbol.name));
    } else {
      const auto argument = [&](std::size_t a) {
        return at.argument[a] < 0 ? 0.0 : made[static_cast<std::size_t>(at.argument[a])];
      };
      made.push_back(expression::Evaluate(at.op, argument(0), argument(1), argument(2)));
    }
  }
  return made.back();
}

TEST(Graph, WhatIsComputedTwiceIsOneNode) {
  Graph graph;
  EXPECT_EQ(Node(&graph, "K*x + B*v"), Node(&graph, "v*B + x*K"));
  const int size = graph.size();
  (void)Node(&graph, "(K*x + B*v)^2 + (K*x + B*v)");
  EXPECT_EQ(graph.size(), size + 3) << "the number 2, the power, the sum";
}

TEST(Graph, NumbersAreFolded) {
  Graph graph;
  EXPECT_EQ(Node(&graph, "2*3 + 4"), graph.Number(10.0));
  EXPECT_EQ(Node(&graph, "g*0 + x*1 - 0"), Node(&graph, "x"));
  EXPECT_EQ(Node(&graph, "x - x"), graph.Number(0.0));
  EXPECT_EQ(Node(&graph, "--x"), Node(&graph, "x"));
  EXPECT_EQ(Node(&graph, "x^0.5"), Node(&graph, "sqrt(x)"));
  EXPECT_EQ(Node(&graph, "if(1 < 2, x, v)"), Node(&graph, "x"));
  EXPECT_EQ(Node(&graph, "lowpass(K, 0.1) + delay(B, 1)"), Node(&graph, "K + B"))
      << "what does not change is not filtered";
  EXPECT_EQ(Node(&graph, "delay(x, 0)"), Node(&graph, "x"));
  EXPECT_EQ(Node(&graph, "-0.0"), graph.Number(0.0));
}

TEST(Graph, KnowsWhatDependsOnWhat) {
  Graph graph;
  const GraphNode law = graph.at(Node(&graph, "K*lowpass(x, 0.1)"));
  EXPECT_TRUE(law.sampled && law.varies && law.memory);
  const GraphNode feature = graph.at(Node(&graph, "x*v"));
  EXPECT_TRUE(!feature.sampled && feature.varies && !feature.memory);
  const GraphNode fixed = graph.at(Node(&graph, "K*B"));
  EXPECT_TRUE(fixed.sampled && !fixed.varies);
  EXPECT_TRUE(graph.DependsOn(Node(&graph, "x*exp(tau*v/x)"), Node(&graph, "tau")));
  EXPECT_FALSE(graph.DependsOn(Node(&graph, "x*exp(tau*v/x)"), Node(&graph, "K")));
}

TEST(Graph, SubstitutionReachesEverything) {
  Graph graph;
  const int law = Node(&graph, "K*x + lowpass(x, tau) + v");
  const int displaced = graph.Substitute(law, {{Node(&graph, "x"), Node(&graph, "x - s")}});
  EXPECT_EQ(displaced, Node(&graph, "K*(x - s) + lowpass(x - s, tau) + v"));
}

class Derivative : public testing::TestWithParam<const char*> {};

/// Central differences know ten digits, complex steps all of them; those only where the function is analytic.
TEST_P(Derivative, IsThatOfDifferencesAndOfComplexSteps) {
  const std::map<std::string, double> at{{"x", 0.7}, {"v", -0.4},  {"u", 0.3}, {"t", 2.0},  {"K", 3.1}, {"B", 1.7},
                                         {"p", 1.6}, {"tau", 0.2}, {"s", 0.9}, {"g", 9.81}, {"L", 1.0}};
  Graph graph;
  const int node = Node(&graph, GetParam());
  const expression::Syntax syntax = Parse(GetParam());
  for (const char* by : {"K", "B", "p", "tau", "s", "x"}) {
    const double exact = ValueOf(graph, graph.Differentiate(node, Node(&graph, by)), at);
    const auto shifted = [&](double h) {
      auto values = at;
      values.at(by) += h;
      return test::TreeWalk<double>(syntax, values).Value();
    };
    const double size = 1.0 + std::fabs(exact);
    EXPECT_NEAR(exact, (shifted(1e-5) - shifted(-1e-5)) / 2e-5, 1e-8 * size) << "by " << by;
    std::map<std::string, std::complex<double>> step(at.begin(), at.end());
    step.at(by) += std::complex<double>(0.0, 1e-30);
    EXPECT_NEAR(exact, test::TreeWalk<std::complex<double>>(syntax, step).Value().imag() / 1e-30, 1e-13 * size)
        << "by " << by;
  }
}

INSTANTIATE_TEST_SUITE_P(Expression, Derivative,
                         testing::Values("x^p*(K + B*v)", "sqrt(K*x)/(tau + s^2)", "exp(-x/tau)*sin(B*s)",
                                         "tanh(v/tau)*K", "log(K) + log2(s) + log10(B*x)",
                                         "atan(K*x) + asin(tau) + acos(tau*x)", "cos(K)*tan(tau)",
                                         "abs(v*K)*sign(v) + max(K*x, B) + min(tau, s)",
                                         "clamp(K*x, 0, 1) + if(K > 2, K^2, B)", "s^-2 + s^3 - K^p", "p^x",
                                         "(K - B*tau)^2 / -(p*K)", "step(x)*K"),
                         [](const auto& info) { return "n" + std::to_string(info.index); });

TEST(Graph, DerivativeOfMemoryPassesThrough) {
  Graph graph;
  const int k = Node(&graph, "K");
  EXPECT_EQ(graph.Differentiate(Node(&graph, "lowpass(K*x, 0.1)"), k), Node(&graph, "lowpass(x, 0.1)"));
  EXPECT_EQ(graph.Differentiate(Node(&graph, "integral(K*x) + previous(B*K*v)"), k),
            Node(&graph, "integral(x) + previous(B*v)"));
  EXPECT_EQ(graph.Differentiate(Node(&graph, "lowpass(x, tau)"), Node(&graph, "tau")), -1) << "not in the language";
  EXPECT_EQ(graph.Differentiate(Node(&graph, "lowpass(x, tau)"), k), graph.Number(0.0));
}

TEST(Graph, DerivativeOfAPowerAtZero) {
  Graph graph;
  const int power = Node(&graph, "max(x, 0)^p");
  const std::map<std::string, double> at{{"x", -1.0}, {"p", 1.5}};
  std::map<std::string, double> all{{"x", -1.0}, {"v", 0.0}, {"u", 0.0},   {"t", 0.0}, {"K", 1.0},
                                    {"B", 1.0},  {"p", 1.5}, {"tau", 1.0}, {"s", 1.0}};
  EXPECT_EQ(ValueOf(graph, graph.Differentiate(power, Node(&graph, "p")), all), 0.0);
}

}  // namespace
}  // namespace armcmc::graph_test
