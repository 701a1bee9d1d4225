#include "armcmc/expression/unit.hpp"

#include <gtest/gtest.h>

namespace armcmc::unit_test {
namespace {

using expression::Error;
using expression::ParseUnit;
using expression::Unit;

TEST(Unit, TheSameQuantityInOtherWords) {
  const auto same = [](const char* a, const char* b) {
    EXPECT_TRUE(ParseUnit(a)->Same(*ParseUnit(b))) << a << " and " << b << " = " << ParseUnit(b)->Text();
  };
  same("N", "kg m/s^2");
  same("N s/m", "kg/s");
  same("Pa", "N/m^2");
  same("sqrt(Pa) s/Pa^2", "s Pa^-1.5");
  same("sqrt(V)/s", "V^(1/2) Hz");
  same("mV", "1e-3 V");
  same("m/s/s", "m s^-2");
  same("J/(kg K)", "m^2/s^2/K");
  same("rad/s", "1/s");
  same("kN*mm", "N m");
  same("N\xc2\xb7m", "J");
  same("m\xc2\xb2", "m^2");
  same("\xc2\xb5m", "um");
  same("-", "1");
  same("mAh", "3.6 C");
  same("kWh", "3.6 MJ");
  same("mmHg", "133.322387415 Pa");
  same("k\xce\xa9", "kOhm");
}

TEST(Unit, OfOtherSizeOrDimension) {
  EXPECT_FALSE(ParseUnit("mm")->Same(*ParseUnit("m")));
  EXPECT_TRUE(ParseUnit("mm")->SameDimension(*ParseUnit("m")));
  EXPECT_FALSE(ParseUnit("N")->SameDimension(*ParseUnit("m")));
  EXPECT_FALSE(ParseUnit("deg")->Same(*ParseUnit("rad")));
  EXPECT_NEAR(ParseUnit("deg")->scale, 0.017453292519943295, 1e-18);
  EXPECT_EQ(ParseUnit("min")->scale, 60.0);
  EXPECT_EQ(ParseUnit("mPa")->scale, 1e-3);
}

TEST(Unit, ThatDependsOnAParameterCannotBeTold) {
  for (const char* text : {"N/m^p", "N s/m^(p+1)", "N m^-p", "(N/m)^n s"}) EXPECT_FALSE(ParseUnit(text)) << text;
}

TEST(Unit, TextReadsBack) {
  for (const char* text : {"N", "m/s", "1", "kg m^2", "sqrt(Pa) s/Pa^2", "mV", "N s/m", "deg"}) {
    const Unit unit = *ParseUnit(text);
    EXPECT_TRUE(ParseUnit(unit.Text())->Same(unit)) << text << " became " << unit.Text();
  }
  EXPECT_EQ(ParseUnit("kg m/s^2")->Text(), "N");
  EXPECT_EQ(ParseUnit("m s^-1")->Text(), "m/s");
}

TEST(Unit, WrongOnesAreToldWhere) {
  const auto column = [](const char* text) {
    try {
      (void)ParseUnit(text);
    } catch (const Error& error) {
      return error.column();
    }
    return 0;
  };
  EXPECT_EQ(column(""), 1);
  EXPECT_EQ(column("Nm"), 1);
  EXPECT_EQ(column("N furlong"), 3);
  EXPECT_EQ(column("N/"), 3);
  EXPECT_EQ(column("m^"), 3);
  EXPECT_EQ(column("sqrt(Pa"), 8);
  EXPECT_EQ(column("N)"), 2);
  EXPECT_EQ(column("m^(1/0)"), 7);
  EXPECT_EQ(column("0"), 2);
}

}  // namespace
}  // namespace armcmc::unit_test
