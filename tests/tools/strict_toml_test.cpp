#include "armcmc/support/strict_toml.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <algorithm>
#include <fstream>
#include <functional>
#include <limits>
#include <string>

#include "support/paths.hpp"

namespace armcmc::support::strict_toml_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr double kInf = std::numeric_limits<double>::infinity();

/// The message of the ConfigError that `call` throws; fails when it throws none.
std::string MessageOf(const std::function<void()>& call) {
  try {
    call();
  } catch (const ConfigError& error) {
    return error.what();
  }
  ADD_FAILURE() << "no ConfigError was thrown";
  return "";
}

StrictTable Toml(std::string_view text) { return StrictTable::FromText(text, "f.toml"); }

TEST(StrictToml, ReadsEveryKindOfValue) {
  auto t = Toml("a = 1.5\nb = 7\nc = true\nd = \"x\"\ne = \"two\"\nf = [1, 2.5]\ng = 3\n");
  EXPECT_EQ(t.Number("a", 0, -kInf, kInf), 1.5);
  EXPECT_EQ(t.Number("g", 0, 0, 10), 3.0) << "an integer is a number";
  EXPECT_EQ(t.Integer("b", 0, 0, 10), 7);
  EXPECT_TRUE(t.Boolean("c", false));
  EXPECT_EQ(t.Text("d", ""), "x");
  EXPECT_EQ(t.Choice("e", "one", {"one", "two"}), "two");
  EXPECT_THAT(t.Numbers("f", {}, 1, 2, -kInf, kInf), ElementsAre(1.0, 2.5));
  EXPECT_TRUE(t.IsText("d"));
  EXPECT_FALSE(t.IsText("b"));
  EXPECT_FALSE(t.IsText("absent"));
  EXPECT_NO_THROW(t.Finish());
}

TEST(StrictToml, AbsentKeysGiveTheFallback) {
  auto t = Toml("");
  EXPECT_EQ(t.Number("a", 2.5, 0, 1), 2.5);
  EXPECT_EQ(t.Integer("b", -1, 0, 1), -1);
  EXPECT_EQ(t.Text("c", "fallback"), "fallback");
  EXPECT_EQ(t.Table("d").Table("e").Number("f", 3.0, 0, 1), 3.0);
  EXPECT_TRUE(t.Tables("g").empty());
  EXPECT_NO_THROW(t.Finish());
}

TEST(StrictToml, RefusesANumberWhereAnIntegerIsWanted) {
  auto t = Toml("a = 3.0\n");
  EXPECT_THAT(MessageOf([&] { t.Integer("a", 0, 0, 10); }),
              HasSubstr("f.toml:1:5: a = 3.0: expected an integer in [0, 10]"));
}

TEST(StrictToml, OutOfRangeNamesFileLineKeyValueAndRange) {
  auto t = Toml("schema = 1\n\n[timing]\nperiod_ms = -3\n");
  EXPECT_EQ(MessageOf([&] { t.Table("timing").Integer("period_ms", 100, 1, 10000); }),
            "f.toml:4:13: timing.period_ms = -3: expected an integer in [1, 10000]");
}

TEST(StrictToml, RefusesNanAndInfinityEvenWithoutBounds) {
  for (const char* value : {"nan", "-nan", "inf", "-inf"}) {
    auto t = Toml(std::string("a = ") + value + "\n");
    EXPECT_THAT(MessageOf([&] { t.Number("a", 0, -kInf, kInf); }), HasSubstr("expected a finite number")) << value;
    EXPECT_THROW(t.RequiredNumber("a", -kInf, kInf), ConfigError) << value;
    auto list = Toml(std::string("a = [1, ") + value + "]\n");
    EXPECT_THROW(list.Numbers("a", {}, 0, 5, -kInf, kInf), ConfigError) << value;
  }
}

TEST(StrictToml, WrongTypesAreNamed) {
  auto t = Toml("a = \"1\"\nb = 1\nc = [1]\n");
  EXPECT_THAT(MessageOf([&] { t.Number("a", 0, 0, 1); }), HasSubstr("expected a number"));
  EXPECT_THAT(MessageOf([&] { t.Text("b", ""); }), HasSubstr("f.toml:2:5: b = 1: expected a string in quotes"));
  EXPECT_THAT(MessageOf([&] { t.Boolean("b", false); }), HasSubstr("expected true or false"));
  EXPECT_THAT(MessageOf([&] { t.Table("b"); }), HasSubstr("expected a table, [b]"));
  EXPECT_THAT(MessageOf([&] { t.Tables("c"); }), HasSubstr("expected an array of tables, [[c]]"));
  EXPECT_THAT(MessageOf([&] { t.Numbers("c", {}, 2, 3, 0, 1); }), HasSubstr("an array of 2 to 3 numbers"));
}

TEST(StrictToml, ChoiceListsTheAllowedWordsAndTheNearest) {
  auto t = Toml("kind = \"gausian\"\n");
  const std::string message = MessageOf([&] { t.Choice("kind", "gaussian", {"gaussian", "laplace"}); });
  EXPECT_THAT(message, HasSubstr("one of gaussian, laplace"));
  EXPECT_THAT(message, HasSubstr("did you mean gaussian?"));
}

TEST(StrictToml, MissingRequiredKeysNameTheirTableAndALikelyTypo) {
  auto t = Toml("\n[model]\nnme = \"x\"\n");
  auto model = t.Table("model");
  const std::string message = MessageOf([&] { model.RequiredText("name"); });
  EXPECT_THAT(message, HasSubstr("f.toml:3:7: model.name is missing"));
  EXPECT_THAT(message, HasSubstr("model.nme is set; is it a typo?"));
  EXPECT_THROW(t.RequiredNumber("a", 0, 1), ConfigError);
  EXPECT_THROW(t.RequiredInteger("a", 0, 1), ConfigError);
  EXPECT_THROW(t.RequiredChoice("a", {"x"}), ConfigError);
}

TEST(StrictToml, AMissingKeyOfATableThatIsMisspeltNamesTheTable) {
  StrictTable root = Toml("a = 1\n[noize]\nstd = 1.0\n");
  StrictTable noise = root.Table("noise");
  EXPECT_EQ(MessageOf([&] { noise.RequiredNumber("std", 0.0, 1.0); }),
            "f.toml:2:1: noise.std is missing: expected a number in [0, 1] (noize is set; is it a typo?)");
}

TEST(StrictToml, FinishNamesTheFirstUnknownKeyItsLineAndTheNearest) {
  auto t = Toml("[timing]\nperiod_ms = 5\nperiod_mss = 6\n[other]\nx = 1\n");
  auto timing = t.Table("timing");
  timing.Integer("period_ms", 0, 0, 10);
  EXPECT_EQ(MessageOf([&] { t.Finish(); }), "f.toml:3:14: timing.period_mss: unknown key (did you mean period_ms?)");
}

TEST(StrictToml, FinishListsTheKnownKeysWhenNoneIsNear) {
  auto t = Toml("zebra = 1\n");
  t.Number("threshold", 0, 0, 1);
  EXPECT_EQ(MessageOf([&] { t.Finish(); }), "f.toml:1:9: zebra: unknown key; known at the top level: threshold");
}

TEST(StrictToml, FinishRejectsTablesThatWereNeverHandedOut) {
  auto t = Toml("[known]\n[unknown.below]\nx = 1\n");
  t.Table("known");
  EXPECT_THAT(MessageOf([&] { t.Finish(); }), HasSubstr("unknown: unknown key"));
}

TEST(StrictToml, FinishSeesTablesHandedOutTwiceAsOne) {
  auto t = Toml("[a]\nx = 1\ny = 2\n");
  t.Table("a").Number("x", 0, 0, 10);
  EXPECT_THROW(t.Finish(), ConfigError);
  t.Table("a").Number("y", 0, 0, 10);
  EXPECT_NO_THROW(t.Finish());
}

TEST(StrictToml, FinishLooksIntoArraysOfTables) {
  auto t = Toml("[[change]]\nat = 1\n[[change]]\nat = 2\natt = 3\n");
  for (StrictTable& change : t.Tables("change")) change.RequiredNumber("at", 0, 10);
  EXPECT_THAT(MessageOf([&] { t.Finish(); }), HasSubstr("f.toml:5:7: change[1].att: unknown key (did you mean at?)"));
}

TEST(StrictToml, HasDoesNotMakeAKeyKnown) {
  auto t = Toml("x = 1\n");
  EXPECT_TRUE(t.Has("x"));
  EXPECT_THROW(t.Finish(), ConfigError);
}

TEST(StrictToml, KeysLeftToOthersAreNotChecked) {
  auto t = Toml("[rt]\nanything = 1\n");
  t.LeaveToOthers("rt");
  EXPECT_NO_THROW(t.Finish());
}

TEST(StrictToml, ATableOfWhichSomeKeysAreReadCanBeLeftToOthers) {
  auto t = Toml("[rt]\nknown = 1\nanything = 1\n");
  EXPECT_EQ(t.Table("rt").Integer("known", 0, 0, 9), 1);
  EXPECT_THROW(t.Finish(), ConfigError);
  t.LeaveToOthers("rt");
  EXPECT_NO_THROW(t.Finish());
}

TEST(StrictToml, KeysComeInTheOrderOfTheFile) {
  EXPECT_THAT(Toml("zeta = 1\nalpha = 2\n[mid]\n").Keys(), ElementsAre("zeta", "alpha", "mid"));
}

TEST(StrictToml, SyntaxErrorsNameLineAndColumn) {
  EXPECT_THAT(MessageOf([] { Toml("a = 1\nb = = 2\n"); }), HasSubstr("f.toml:2:"));
  EXPECT_THROW(Toml("a = 1\na = 2\n"), ConfigError) << "a key twice";
  EXPECT_THROW(Toml("a = \"\xff\"\n"), ConfigError) << "not UTF-8";
}

TEST(StrictToml, UnreadableFilesAreNamed) {
  const test::ScratchDir dir;
  EXPECT_THAT(MessageOf([&] { StrictTable::FromFile(dir / "none.toml"); }), HasSubstr("none.toml: cannot be read"));
  EXPECT_THAT(MessageOf([&] { StrictTable::FromFile(dir.path()); }), HasSubstr("is a folder"));
  std::ofstream(dir / "some.toml") << "a = 1\n";
  EXPECT_EQ(StrictTable::FromFile(dir / "some.toml").RequiredInteger("a", 0, 9), 1);
}

TEST(StrictToml, ErrorStandsAtThePlaceOfTheKey) {
  auto t = Toml("[a]\nlower = 5\n");
  EXPECT_STREQ(t.Table("a").Error("lower", "expected less than upper").what(),
               "f.toml:2:9: a.lower = 5: expected less than upper");
}

TEST(StrictToml, ErrorInATextStandsAtItsCharacter) {
  auto t = Toml("[a]\nlaw = \"K*xx\"\nlong = \"\"\"\nK*\nxx\"\"\"\n");
  EXPECT_STREQ(t.Table("a").ErrorInText("law", 3, "unknown name").what(),
               "f.toml:2:10: a.law = \"K*xx\": unknown name");
  EXPECT_THAT(t.Table("a").ErrorInText("long", 4, "unknown name").what(), testing::StartsWith("f.toml:3:8: a.long"))
      << "of a text over several lines its beginning";
}

TEST(StrictToml, TablesOutliveTheRoot) {
  const auto sub = [] { return Toml("[a]\nx = 4\n").Table("a"); };
  StrictTable table = sub();
  EXPECT_EQ(table.RequiredInteger("x", 0, 9), 4);
}

TEST(StrictToml, ANumberIsAcceptedExactlyWhenItIsInRange) {
  EXPECT_TRUE(rc::check([](std::int64_t value, std::int64_t a, std::int64_t b) {
    const std::int64_t lo = std::min(a, b), hi = std::max(a, b);
    auto t = Toml("k = " + std::to_string(value) + "\n");
    bool accepted = true;
    try {
      RC_ASSERT(t.Integer("k", 0, lo, hi) == value);
    } catch (const ConfigError&) {
      accepted = false;
    }
    RC_ASSERT(accepted == (lo <= value && value <= hi));
  }));
}

}  // namespace
}  // namespace armcmc::support::strict_toml_test
