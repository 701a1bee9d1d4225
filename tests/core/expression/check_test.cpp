#include "armcmc/expression/check.hpp"

#include <gtest/gtest.h>

#include "core/expression/plant_words.hpp"

namespace armcmc::check_test {
namespace {

using expression::Check;
using expression::Error;
using expression::Meaning;
using expression::Parse;
using expression::Scope;
using expression::Syntax;

Meaning MeaningOf(const std::string& text, const std::string& given = "") {
  const Scope scope = test::PlantWords();
  const Syntax syntax = Parse(text);
  if (given.empty()) return Check(syntax, scope);
  const Syntax condition = Parse(given);
  return Check(syntax, scope, &condition);
}

std::string UnitOf(const std::string& text) {
  const Meaning meaning = MeaningOf(text);
  return meaning.unit ? meaning.unit->Text() : "?";
}

TEST(Check, UnitsFollowTheLaw) {
  EXPECT_EQ(UnitOf("K*x + B*v"), "N");
  EXPECT_EQ(UnitOf("sqrt(K*x)^2"), "N");
  EXPECT_EQ(UnitOf("x/(v*tau)"), "1");
  EXPECT_EQ(UnitOf("if(x > 0, K*x, 0)"), "N");
  EXPECT_EQ(UnitOf("integral(v) + lowpass(x, tau) + previous(x) + delay(x, 0.1)"), "m");
  EXPECT_EQ(UnitOf("elapsed() + t"), "s");
  EXPECT_EQ(UnitOf("max(x, 0)^3"), "m^3");
  EXPECT_EQ(UnitOf("x + 1"), "m");
  EXPECT_EQ(UnitOf("2*x"), "m");
}

TEST(Check, UnitsThatCannotBeToldAreLeftAlone) {
  EXPECT_EQ(UnitOf("max(x, 0)^p"), "?");
  EXPECT_EQ(UnitOf("max(x, 0)^p * K + B*v"), "N") << "the sum is what its other part is";
  EXPECT_EQ(UnitOf("g*x"), "?");
  EXPECT_EQ(UnitOf("g + x"), "m");
  for (const char* beside_a_number : {"g + 1", "1 + g", "if(x > 0, x^p, 0)*p", "if(x > 0, 0, g)*p"})
    EXPECT_EQ(UnitOf(beside_a_number), "?") << beside_a_number;
}

struct Wrong {
  const char* text;
  int column;
  const char* says;
};

class WrongMeaning : public testing::TestWithParam<Wrong> {};

TEST_P(WrongMeaning, IsToldWhereAndWhat) {
  try {
    (void)MeaningOf(GetParam().text);
    FAIL() << GetParam().text << " was accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.column(), GetParam().column) << error.what();
    EXPECT_NE(std::string(error.what()).find(GetParam().says), std::string::npos) << error.what();
  }
}

INSTANTIATE_TEST_SUITE_P(Expression, WrongMeaning,
                         testing::Values(Wrong{"K*xx", 3, "unknown name \"xx\""}, Wrong{"K*x + v", 5, "N and m/s"},
                                         Wrong{"1 + sin(x)", 9, "found m"}, Wrong{"x < v", 3, "m and m/s"},
                                         Wrong{"if(x, 1, 2)", 4, "x >= 0"}, Wrong{"x and v > 0", 1, "x >= 0"},
                                         Wrong{"lowpass(x, v)", 12, "time in s"}, Wrong{"exp(K*x)", 5, "found N"},
                                         Wrong{"u^x", 3, "found m"}, Wrong{"x^p", 2, "negative"},
                                         Wrong{"x^1.5", 2, "negative"}, Wrong{"clamp(x, 0, v)", 1, "bound"},
                                         Wrong{"if(x > 0, x, v)", 1, "results of if"},
                                         Wrong{"min(x*K, v)", 1, "N and m/s"}),
                         [](const auto& info) { return "n" + std::to_string(info.index); });

TEST(Check, PowersOfWhatCannotBeNegative) {
  EXPECT_NO_THROW((void)MeaningOf("abs(x)^p"));
  EXPECT_NO_THROW((void)MeaningOf("max(x, 0)^p"));
  EXPECT_NO_THROW((void)MeaningOf("u^2 + u^-1 + u^3"));
  EXPECT_NO_THROW((void)MeaningOf("(x*x)^p"));
  EXPECT_NO_THROW((void)MeaningOf("sqrt(x)^p"));
  EXPECT_NO_THROW((void)MeaningOf("if(x > 0, x^p, 0)"));
  EXPECT_NO_THROW((void)MeaningOf("if(0 < x and v > 0, x^p*v^p, 0)"));
  EXPECT_NO_THROW((void)MeaningOf("max(x - tau*v, 0)^p"));
  EXPECT_NO_THROW((void)MeaningOf("(x - tau*v)^p")) << "depends on a parameter: not a number where it is negative";
  EXPECT_THROW((void)MeaningOf("if(x > 0, 1, x^p)"), Error) << "there it is negative";
  EXPECT_NO_THROW((void)MeaningOf("x^p * (K*x + B*v)", "x >= 0"));
  EXPECT_NO_THROW((void)MeaningOf("x^p", "u != 0 and x > 0.1"));
  EXPECT_THROW((void)MeaningOf("x^p", "v >= 0"), Error);
  EXPECT_THROW((void)MeaningOf("x^p", "x > 0 or v > 0"), Error);
  EXPECT_THROW((void)MeaningOf("x^p", "x >= -1"), Error);
}

TEST(Check, WhatDependsOnWhat) {
  EXPECT_TRUE(MeaningOf("K*x").sampled);
  EXPECT_TRUE(MeaningOf("s + x").sampled);
  EXPECT_FALSE(MeaningOf("x + v*t").sampled);
  EXPECT_TRUE(MeaningOf("g*2").fixed);
  EXPECT_TRUE(MeaningOf("lowpass(x, 0.1)").memory);
  EXPECT_TRUE(MeaningOf("x > 0 or v > 0").condition);
}

}  // namespace
}  // namespace armcmc::check_test
