#include "armcmc/expression/linearity.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "armcmc/expression/check.hpp"
#include "core/expression/plant_words.hpp"

namespace armcmc::linearity_test {
namespace {

using expression::Graph;
using expression::SymbolKind;

/// In K and B, by the form of the text.
bool LinearInKAndB(const std::string& text) {
  Graph graph;
  const expression::Scope scope = test::PlantWords();
  const int node = graph.Lower(expression::Parse(text), scope, {});
  const std::vector<int> symbols{graph.Symbol(SymbolKind::kParameter, 0), graph.Symbol(SymbolKind::kParameter, 1)};
  return expression::IsLinear(graph, node, symbols);
}

TEST(IsLinear, WhereParametersAreMultipliedByWhatIsKnown) {
  for (const char* text : {"K*x + B*v", "x^p * (K*x + B*v)", "-(K*x) / exp(p) - 3*B*v", "u", "p^2 + sin(p*t)",
                           "if(x > 0, K*x, B*v)", "lowpass(x, 0.1)*K", "K*sign(v) + B*abs(v)", "(K + K)*x - K*x/2"})
    EXPECT_TRUE(LinearInKAndB(text)) << text;
}

TEST(IsLinear, NotWhereTheyBendOrMeet) {
  for (const char* text : {"K^2*x", "K*B*x", "x/K", "abs(K)*x", "exp(K*x)", "max(K*x, B*v)", "if(K*x > 1, x, v)",
                           "step(K*x - 1)*v + B*v", "sign(K - 2)*x", "K*x^B", "sqrt(K*K)*x", "lowpass(K*x, 0.1)"})
    EXPECT_FALSE(LinearInKAndB(text)) << text;
}

TEST(IsLinear, NothingIsKnownOfStates) { EXPECT_FALSE(LinearInKAndB("K*s")); }

/// Of laws in K, B, p.
LinearPart PartOf(const std::vector<std::string>& texts) {
  Graph graph;
  const expression::Scope scope = test::PlantWords();
  std::vector<int> laws;
  laws.reserve(texts.size());
  for (const std::string& text : texts) laws.push_back(graph.Lower(expression::Parse(text), scope, {}));
  return expression::FindLinearPart(&graph, laws, 3);
}

TEST(FindLinearPart, TakesAsFewCurvedParametersAsItCan) {
  LinearPart part = PartOf({"K*x + B*v + p*t"});
  EXPECT_EQ(part.num_linear, 3);
  EXPECT_EQ(part.curved, -1);
  part = PartOf({"(K + B*v)*x^p"});
  EXPECT_EQ(part.num_linear, 2);
  EXPECT_EQ(part.curved, 2);
  EXPECT_EQ(part.second, -1);
  part = PartOf({"K*x^B + exp(p*v)"});
  EXPECT_EQ(part.num_linear, 1);
  EXPECT_EQ(part.curved, 1);
  EXPECT_EQ(part.second, 2);
  EXPECT_EQ(part.NeedOf(0), LinearPart::kSecond);
  EXPECT_EQ(part.NeedOf(1), LinearPart::kCurved);
  part = PartOf({"K*x + sin(p*v)*x^2 - 3*tanh(B*v)/x", "x^p"});
  EXPECT_EQ(part.num_linear, 0) << "what stands without a factor needs both";
}

TEST(FindLinearPart, NoFunctionMayNeedBothCurvedParameters) {
  for (const char* text : {"K*x^p*v^B", "K*x + x^p*v^B", "K*x^(p*B)", "K*x^(p + B)"})
    EXPECT_EQ(PartOf({text}).num_linear, 0) << text;
  // Neither law has both, one by one.
  EXPECT_EQ(PartOf({"K*x^p + B"}).num_linear, 2);
  EXPECT_EQ(PartOf({"K*x^p", "K*x^B"}).num_linear, 0);
  EXPECT_EQ(PartOf({"K*x^p + tanh(B*v)", "K*v^p"}).num_linear, 1);
}

}  // namespace
}  // namespace armcmc::linearity_test
