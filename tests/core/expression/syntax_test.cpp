#include "armcmc/expression/syntax.hpp"

#include <gtest/gtest.h>

#include "core/expression/tree_walk.hpp"

namespace armcmc::syntax_test {
namespace {

using expression::Error;
using expression::Parse;
using expression::UnknownName;

double ValueOf(const std::string& text) {
  const std::map<std::string, double> values{{"x", 3.0}, {"y", -2.0}, {"t", 0.5}};
  const expression::Syntax syntax = Parse(text);
  return test::TreeWalk<double>(syntax, values).Value();
}

TEST(Syntax, PrecedenceIsThatOfMathematics) {
  EXPECT_EQ(ValueOf("1 + 2*3"), 7.0);
  EXPECT_EQ(ValueOf("2 - 3 - 4"), -5.0);
  EXPECT_EQ(ValueOf("12/3/2"), 2.0);
  EXPECT_EQ(ValueOf("-x^2"), -9.0);
  EXPECT_EQ(ValueOf("2^3^2"), 512.0);
  EXPECT_EQ(ValueOf("2^-1"), 0.5);
  EXPECT_EQ(ValueOf("-2*-x"), 6.0);
  EXPECT_EQ(ValueOf("--x"), 3.0);
  EXPECT_EQ(ValueOf("1 < 2 and not 2 < 1"), 1.0);
  EXPECT_EQ(ValueOf("1 > 2 or 3 >= 3 and x != y"), 1.0);
  EXPECT_EQ(ValueOf("not x == y"), 1.0);
}

TEST(Syntax, NumbersAndFunctions) {
  EXPECT_EQ(ValueOf("1e-3 + .5 + 2.5E2"), 250.501);
  EXPECT_EQ(ValueOf("if(x > 0, min(x, 1), max(x, -1))"), 1.0);
  EXPECT_EQ(ValueOf("clamp(x, 0, 2) + step(y) + sign(y) + abs(y)"), 3.0);
  EXPECT_EQ(ValueOf(" ( ( x ) ) "), 3.0);
}

struct Wrong {
  const char* text;
  int column;
  const char* says;
};

class WrongSyntax : public testing::TestWithParam<Wrong> {};

TEST_P(WrongSyntax, IsToldWhereAndWhat) {
  try {
    (void)Parse(GetParam().text);
    FAIL() << GetParam().text << " was read";
  } catch (const Error& error) {
    EXPECT_EQ(error.column(), GetParam().column) << error.what();
    EXPECT_NE(std::string(error.what()).find(GetParam().says), std::string::npos) << error.what();
  }
}

INSTANTIATE_TEST_SUITE_P(
    Expression, WrongSyntax,
    testing::Values(Wrong{"", 1, "empty"}, Wrong{"x +", 4, "found the end"}, Wrong{"x + * y", 5, "found \"*\""},
                    Wrong{"Fv*(v + 1", 10, "to close \"(\" of column 4"}, Wrong{"x) + 1", 2, "without \"(\""},
                    Wrong{"2x", 2, "2*name"}, Wrong{"x y", 3, "before \"y\""}, Wrong{"x ** 2", 3, "^"},
                    Wrong{"a = b", 3, "=="}, Wrong{"a < b < c", 7, "a < b and b < c"},
                    Wrong{"sin(x, y)", 1, "takes 1 argument, found 2"}, Wrong{"min(x)", 1, "takes 2 arguments"},
                    Wrong{"if(x, 1, 2, 3)", 13, "takes 3 arguments"}, Wrong{"elapsed(x)", 1, "no argument"},
                    Wrong{"sin x", 1, "sin(...)"}, Wrong{"sine(x)", 1, "unknown function"}, Wrong{"x + #", 5, "#"},
                    Wrong{"1e999", 1, "range"}, Wrong{"and x", 1, "found \"and\""}, Wrong{"x & y", 3, "write and"},
                    Wrong{"f(", 1, "unknown function"}, Wrong{"max(1,", 7, "found the end"}),
    [](const auto& info) { return "n" + std::to_string(info.index); });

TEST(Syntax, DepthAndLengthAreBounded) {
  EXPECT_THROW((void)Parse(std::string(100, '(') + "x" + std::string(100, ')')), Error);
  EXPECT_THROW((void)Parse(std::string(100, '-') + "x"), Error);
  EXPECT_THROW((void)Parse(std::string(5000, ' ') + "x"), Error);
  std::string sum = "x";
  for (int i = 0; i < 1000; ++i) sum += "+x";
  EXPECT_EQ(ValueOf(sum), 3003.0);
}

TEST(Syntax, NamesThatAreTaken) {
  for (const char* name : {"x", "_a", "Fv2", "lowpass1"}) EXPECT_TRUE(expression::IsFreeName(name)) << name;
  for (const char* name : {"", "1x", "and", "sin", "lowpass", "a-b", "a b"})
    EXPECT_FALSE(expression::IsFreeName(name)) << name;
}

}  // namespace
}  // namespace armcmc::syntax_test
