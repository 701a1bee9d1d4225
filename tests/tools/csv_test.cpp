#include "armcmc/support/csv.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <bit>
#include <clocale>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <random>
#include <string>

#include "armcmc/support/program.hpp"
#include "support/paths.hpp"

namespace armcmc::support::csv_test {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

class Csv : public ::testing::Test {
 protected:
  CsvSamples Read(const std::string& text, bool skip_bad = false) {
    std::ofstream(dir_ / "d.csv", std::ios::binary) << text;
    return ReadCsv(dir_ / "d.csv", {{"t", "x", "v"}, {{"v", "x"}}, skip_bad});
  }
  std::string ErrorOf(const std::string& text, bool skip_bad = false) {
    try {
      Read(text, skip_bad);
    } catch (const InputError& error) {
      return error.what();
    }
    ADD_FAILURE() << "no InputError was thrown";
    return "";
  }
  test::ScratchDir dir_;
};

TEST_F(Csv, FindsColumnsByNameInAnyOrderAndIgnoresOthers) {
  const CsvSamples s = Read("v,extra,x,t\n3,word,2,1\n6,,5,4\n");
  EXPECT_THAT(s.columns, ElementsAre(ElementsAre(1, 4), ElementsAre(2, 5), ElementsAre(3, 6)));
  EXPECT_TRUE(s.notes.empty());
}

TEST_F(Csv, TakesCommentsBlankLinesSpacesQuotesAndWindowsLineEnds) {
  const CsvSamples s =
      Read("\xEF\xBB\xBF# made by a logger\r\n\r\n\"t\", x ,v\r\n 1 ,\t+2,3e0\r\n# half time\r\n2,3,4\r\n");
  EXPECT_THAT(s.columns, ElementsAre(ElementsAre(1, 2), ElementsAre(2, 3), ElementsAre(3, 4)));
}

TEST_F(Csv, EveryBadRowIsAnErrorWithItsLine) {
  EXPECT_THAT(ErrorOf("t,x,v\n0,1,2\n1,nan,2\n2,1,2\n"), AllOf(HasSubstr("d.csv:3: x = nan"), HasSubstr("--skip-bad")));
  EXPECT_THAT(ErrorOf("t,x,v\n0,inf,2\n"), HasSubstr("d.csv:2: x = inf: expected a finite number"));
  EXPECT_THAT(ErrorOf("t,x,v\n0,,2\n"), HasSubstr("d.csv:2: x = (empty)"));
  EXPECT_THAT(ErrorOf("t,x,v\n0,1e999,2\n"), HasSubstr("expected a finite number"));
  EXPECT_THAT(ErrorOf("t,x,v\n0,abc,2\n"), HasSubstr("x = abc: expected a number"));
  EXPECT_THAT(ErrorOf("t,x,v\n0,1.5x,2\n"), HasSubstr("x = 1.5x: expected a number"));
  EXPECT_THAT(ErrorOf("t,x,v\n0,1,2\n1,2\n"), HasSubstr("d.csv:3: has 2 fields, expected 3"));
  EXPECT_THAT(ErrorOf("t,x,v\n0,1,2\n1,1,2\n1,1,2\n"), HasSubstr("d.csv:4: t = 1: expected more than 1"));
}

TEST_F(Csv, AFileCutInsideANumberIsAnErrorAlthoughItParses) {
  EXPECT_THAT(ErrorOf("t,x,v\n0,1,2.5\n1,2,3.2"), HasSubstr("d.csv:3: the last line has no line end"));
}

TEST_F(Csv, EmptyAndUselessFilesAreErrors) {
  EXPECT_THAT(ErrorOf(""), HasSubstr("is empty, expected a header line t,x,v"));
  EXPECT_THAT(ErrorOf("# only\n"), HasSubstr("is empty"));
  EXPECT_THAT(ErrorOf("t,x,v\n"), HasSubstr("holds no valid row"));
  EXPECT_THROW((void)ReadCsv(dir_ / "none.csv", {{"t"}, {}, false}), InputError);
  EXPECT_THROW((void)ReadCsv(dir_.path(), {{"t"}, {}, false}), InputError);
}

TEST_F(Csv, MissingOrDoubleColumnsAreNamed) {
  EXPECT_THAT(ErrorOf("t,X,v\n0,1,2\n"),
              AllOf(HasSubstr("d.csv:1: column x is missing"), HasSubstr("did you mean X?")));
  EXPECT_THAT(ErrorOf("t,x,v,x\n0,1,2,3\n"), HasSubstr("column x appears twice"));
}

TEST_F(Csv, SkipBadCountsByCauseAndSaysSo) {
  const CsvSamples s =
      Read("t,x,v\n0,1,1\n1,nan,1\n2,1,1\n1.5,1,1\n3,1\n4,1,1\n5,oops,1\n6,1,1\n7,1,1\n8,1,1\n9,1,1", true);
  EXPECT_THAT(s.columns[0], ElementsAre(0, 2, 4, 6, 7, 8));
  EXPECT_EQ(s.bad.non_finite, 1u);
  EXPECT_EQ(s.bad.not_increasing, 1u);
  EXPECT_EQ(s.bad.malformed, 3u);
  ASSERT_EQ(s.notes.size(), 1u);
  EXPECT_THAT(s.notes[0], HasSubstr("skipped 5 bad rows: 3 malformed, 1 not finite, 1 with a time"));
}

TEST_F(Csv, WhatComesAfterTheTimeThatIsAskedForIsNotLookedAt) {
  std::ofstream(dir_ / "runs.csv") << "t,x\n0,1\n1,2\n2,3\n0,4\nnot a number\n";
  CsvRequest request;
  request.columns = {"t", "x"};
  request.until = 1.0;
  EXPECT_THAT(ReadCsv(dir_ / "runs.csv", request).columns[1], ElementsAre(1, 2));
  request.until = 2.0;
  EXPECT_THROW((void)ReadCsv(dir_ / "runs.csv", request), InputError);
}

TEST_F(Csv, SkipBadGivesUpWhenMostRowsAreBad) {
  EXPECT_THAT(ErrorOf("t,x,v\n1,1,1\n0,1,1\n0,1,1\n", true), HasSubstr("2 rows are bad and only 1 good"));
}

TEST_F(Csv, DerivesAMissingColumnByCentralDifferencesAndSaysSo) {
  const CsvSamples s = Read("t,x\n0,0\n1,1\n2,4\n4,16\n");  // x = t^2
  EXPECT_THAT(s.columns[2], ElementsAre(1.0, 2.0, 5.0, 6.0));
  EXPECT_THAT(s.notes, ElementsAre(HasSubstr("column v is missing: derived from x")));
}

TEST_F(Csv, DerivesFromANoisyColumnByAFilterWithoutDelayUpToTheEndsAndOverGaps) {
  std::ofstream file(dir_ / "noisy.csv");
  file.precision(15);
  file << "t,x\n";
  std::mt19937_64 generator(3);
  std::normal_distribution<double> noise(0.0, 1e-4);
  const auto place = [](double t) { return 0.1 * std::sin(6.0 * t + 0.4); };
  for (int n = 0; n < 2000; ++n) {
    if (n >= 700 && n < 800) continue;
    const double t = 1e-3 * n;
    file << t << ',' << place(t) + noise(generator) << '\n';
  }
  file.close();
  CsvRequest request;
  request.columns = {"t", "x", "v"};
  request.derived = {{"v", "x"}};
  const CsvSamples s = ReadCsv(dir_ / "noisy.csv", request);
  EXPECT_THAT(s.notes, ElementsAre(testing::ContainsRegex("column v is missing: derived from x, .* Hz, chosen by the "
                                                          "noise")));
  ASSERT_EQ(s.num_rows(), 1900u);
  // Differences of neighbours would be off by 0.07.
  for (std::size_t n = 0; n < s.num_rows(); ++n)
    EXPECT_NEAR(s.columns[2][n], 0.6 * std::cos(6.0 * s.columns[0][n] + 0.4), 0.03) << n;
}

TEST_F(Csv, DerivingNeedsTwoRows) { EXPECT_THAT(ErrorOf("t,x\n0,0\n"), HasSubstr("one row is too few to derive v")); }

TEST_F(Csv, ReadsNumbersTheSameInEveryLocale) {
  const char* changed = std::setlocale(LC_ALL, "de_DE.UTF-8");
  const CsvSamples s = Read("t,x,v\n0.5,1.25,-1e-3\n");
  std::setlocale(LC_ALL, "C");
  EXPECT_THAT(s.columns, ElementsAre(ElementsAre(0.5), ElementsAre(1.25), ElementsAre(-1e-3)))
      << (changed == nullptr ? "(that locale is not installed)" : "");
}

TEST_F(Csv, EveryFiniteDoubleSurvivesWritingAndReading) {
  EXPECT_TRUE(rc::check([this](std::uint64_t bits) {
    const double value = std::bit_cast<double>(bits);
    RC_PRE(std::isfinite(value));
    const CsvSamples s = Read("t,x,v\n0," + ExactNumber(value) + ",0\n");
    RC_ASSERT(std::bit_cast<std::uint64_t>(s.columns[1][0]) == bits);
    RC_ASSERT(std::bit_cast<std::uint64_t>(std::strtod(ExactNumber(value).c_str(), nullptr)) == bits);
  }));
}

}  // namespace
}  // namespace armcmc::support::csv_test
