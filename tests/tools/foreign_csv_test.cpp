// CSV tables as PlotJuggler, pandas and spreadsheets write them.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <string>
#include <vector>

#include "armcmc/support/csv.hpp"
#include "armcmc/support/program.hpp"
#include "armcmc/support/recording.hpp"
#include "support/paths.hpp"
#include "support/process.hpp"
#include "tools/csv_rows.hpp"
#include "tools/file_text.hpp"
#include "tools/replay_data.hpp"

namespace armcmc::support::foreign_csv_test {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// Seconds since 1970 in decimals, n intervals of 10^-digits s after half past some hour.
std::string Epoch(int n, int digits) {
  const int per_second = static_cast<int>(std::lround(std::pow(10.0, digits)));
  const int ticks = per_second / 2 + n;
  char text[40];
  std::snprintf(text, sizeof text, "%d.%0*d", 1'700'000'000 + ticks / per_second, digits, ticks % per_second);
  return text;
}

class ForeignCsv : public ::testing::Test {
 protected:
  CsvSamples Read(const std::string& text, bool skip_bad = false) const {
    std::ofstream(dir_ / "d.csv", std::ios::binary) << text;
    return ReadCsv(dir_ / "d.csv", {{"t", "x"}, {}, skip_bad});
  }
  [[nodiscard]] std::string ErrorOf(const std::string& text) const {
    try {
      (void)Read(text);
    } catch (const InputError& error) {
      return error.what();
    }
    ADD_FAILURE() << "no InputError was thrown";
    return "";
  }
  test::ScratchDir dir_;
};

TEST_F(ForeignCsv, SemicolonsAndTabsSeparateWhereTheyDoInTheHeader) {
  EXPECT_THAT(Read("t;x;\"a;b\"\n0;1.5;2\n1; 2.5 ;3\n").columns[1], ElementsAre(1.5, 2.5));
  EXPECT_THAT(Read("a\tt\tx\n\t0\t1.5\nword\t1\t2.5\n").columns[1], ElementsAre(1.5, 2.5))
      << "with an empty first cell";
  EXPECT_THAT(Read("a\tt\tx\n\t\"0\"\t1.5\n").columns[1], ElementsAre(1.5)) << "a quoted one behind an empty one";
  EXPECT_THAT(Read("\"t\";\"x\";\"a, b, and c\"\n0;1.5;2\n").columns[1], ElementsAre(1.5)) << "commas in a name";
  EXPECT_THAT(Read("t,x,\"a;b;c;d\"\n0,1.5,2\n").columns[1], ElementsAre(1.5));
}

TEST_F(ForeignCsv, ADecimalCommaIsRefusedWithWhatToDo) {
  EXPECT_THAT(ErrorOf("t;x\n0;1,5\n"),
              HasSubstr("d.csv:2: x = 1,5: expected a number with a point as decimal separator"));
}

TEST_F(ForeignCsv, SpacesAsSeparatorsAreRefused) {
  EXPECT_THAT(ErrorOf("t x\n0 1\n"), HasSubstr("separated by spaces, expected commas, semicolons or tabs"));
}

TEST_F(ForeignCsv, WindowsLineEndsAndAByteOrderMarkDoNotCount) {
  EXPECT_THAT(Read("\xEF\xBB\xBFt;x\r\n0;1\r\n1;2\r\n").columns[1], ElementsAre(1, 2));
}

TEST_F(ForeignCsv, TheTimeIsFoundUnderTheNamesThatOthersGiveIt) {
  for (const char* name : {"__time", "time", "t [s]"}) {
    const CsvSamples s = Read(std::string(name) + ",x\n0,1\n1,2\n");
    EXPECT_THAT(s.columns[0], ElementsAre(0, 1));
    EXPECT_THAT(s.notes, ElementsAre(std::string("column t is missing: the time is ") + name));
  }
  const CsvSamples s = Read("__time,t,x\n7,0,1\n8,1,2\n");
  EXPECT_THAT(s.columns[0], ElementsAre(0, 1)) << "t itself goes first";
  EXPECT_TRUE(s.notes.empty());
  EXPECT_THAT(ErrorOf("Time,x\n0,1\n"), HasSubstr("column t is missing"));
}

TEST_F(ForeignCsv, TimesSince1970CountFromTheFirstAndKeepTheirInterval) {
  std::string text = "__time,x\n";
  for (int n = 0; n < 2000; ++n) text += Epoch(n, 3) + ",0\n";
  const CsvSamples s = Read(text);
  EXPECT_EQ(s.columns[0][0], 0.0);
  // A double has 2.4e-7 s between two neighbours there.
  for (std::size_t n = 1; n < 2000; ++n)
    EXPECT_NEAR(s.columns[0][n], 1e-3 * static_cast<double>(n), 1e-15 * static_cast<double>(n + 1));
  EXPECT_THAT(s.notes, Contains("times count from the first one, 1700000000.5 s"));
}

TEST_F(ForeignCsv, IntervalsFarBelowTheResolutionOfTheirTimeAreKept) {
  std::string text = "__time,x\n";
  for (int n = 0; n < 50; ++n) text += Epoch(n, 7) + ",0\n";
  const CsvSamples s = Read(text);
  for (std::size_t n = 1; n < 50; ++n) EXPECT_NEAR(s.columns[0][n], 1e-7 * static_cast<double>(n), 1e-15);
}

TEST_F(ForeignCsv, TimesBelowThreeYearsStayAsTheyAre) {
  const CsvSamples s = Read("t,x\n99999999.5,1\n100000000.5,2\n");
  EXPECT_THAT(s.columns[0], ElementsAre(99999999.5, 100000000.5));
  EXPECT_TRUE(s.notes.empty());
  EXPECT_THAT(Read("t,x\n-1700000000.25,1\n-1700000000.125,2\n").columns[0], ElementsAre(0, 0.125));
  EXPECT_THAT(Read("t,x\n1.7e9,1\n1700000000.125,2\n").columns[0], ElementsAre(0, 0.125));
}

TEST_F(ForeignCsv, ABlankCellIsRefusedWithWhatToDo) {
  EXPECT_THAT(ErrorOf("t,x\n0,1\n1,\n"), AllOf(HasSubstr("d.csv:3: x = (empty)"), HasSubstr("[rows] blanks")));
}

class ForeignRecording : public ::testing::Test {
 protected:
  ForeignRecording() {
    Write("plant.toml", R"(schema = 1
name = "axis"
output = "F"
law = "a + b*u"
[signals]
u = { unit = "V", role = "drive" }
F = { unit = "N", role = "force" }
[parameters]
a = { unit = "N", mean = 0.0, sd = 1.0 }
b = { unit = "N/V", mean = 0.0, sd = 1.0 }
[noise]
std = 1.0
)");
  }
  void Write(const std::string& name, const std::string& text) const {
    std::ofstream(dir_ / name, std::ios::binary) << text;
  }
  [[nodiscard]] Recording Read(const std::string& csv, const std::string& columns) const {
    Write("data.csv", csv);
    Write("recording.toml", "schema = 1\nmodel = \"plant.toml\"\nfile = \"data.csv\"\n" + columns);
    return ReadRecording(dir_ / "recording.toml", "");
  }
  [[nodiscard]] std::string ErrorOf(const std::string& csv, const std::string& columns) const {
    try {
      (void)Read(csv, columns);
    } catch (const std::exception& error) {
      return error.what();
    }
    return "no error";
  }
  test::ScratchDir dir_;
};

constexpr const char* kJointColumns =
    "[columns]\nt = \"__time\"\nu = \"/joint/position[0]\"\nF = { column = \"ar_map.K [N m^-p]\", scale = 2.0 }\n";

TEST_F(ForeignRecording, NamesWithSlashesDotsBracketsAndUnitsAreColumnsLikeAnyOther) {
  std::string csv = "\xEF\xBB\xBF\"__time\";\"/joint/position[0]\";\"ar_map.K [N m^-p]\"\r\n";
  for (int n = 0; n < 20; ++n) csv += Epoch(n, 3) + ";" + std::to_string(n) + ";" + std::to_string(10 + n) + "\r\n";
  const Recording r = Read(csv, kJointColumns);
  ASSERT_EQ(r.num_rows(), 20u);
  EXPECT_EQ(r.dt, 0.001);
  EXPECT_EQ(r.t[19], 0.019);
  EXPECT_EQ(r.signals[0].value[7], 7.0);
  EXPECT_EQ(r.signals[1].value[7], 34.0);
  EXPECT_THAT(r.notes, Contains("times count from the first one, 1700000000.5 s"));
}

TEST_F(ForeignRecording, TheTimeNeedNotBeNamed) {
  std::string csv = "__time,u,F\n";
  for (int n = 0; n < 20; ++n) csv += Epoch(n, 3) + ",1," + std::to_string(n) + "\n";
  EXPECT_EQ(Read(csv, "").dt, 0.001);
}

TEST_F(ForeignRecording, AnExpressionNeedsNamesWithoutSlashes) {
  const std::string error =
      ErrorOf("__time,/joint/u,F\n0,1,2\n", "[columns]\nt = \"__time\"\nu = { value = \"2*/joint/u\" }\n");
  EXPECT_THAT(error, HasSubstr("recording.toml:6:"));
  EXPECT_EQ(std::count(error.begin(), error.end(), '\n'), 0);
}

TEST_F(ForeignRecording, NanosecondsSince1970KeepTheirInterval) {
  std::string csv = "stamp,u,F\n";
  for (int n = 0; n < 30; ++n)
    csv += std::to_string(1'700'000'000'123'456'789 + 10'000LL * n) + ",1," + std::to_string(n) + "\n";
  const Recording r = Read(csv, "[columns]\nt = { column = \"stamp\", scale = 1e-9 }\n");
  EXPECT_EQ(r.dt, 1e-5) << "a double has 256 ns between two neighbours there";
  EXPECT_EQ(r.num_rows(), 30u);
  EXPECT_THAT(r.notes, ElementsAre(HasSubstr("times count from the first one, 1700000000.1234")))
      << "and nothing is interpolated";
}

TEST_F(ForeignRecording, FromAndUntilAreTimesAsTheFileHasThem) {
  std::string csv = "__time,u,F\n";
  for (int n = 0; n < 200; ++n) csv += Epoch(n, 3) + ",1," + std::to_string(n) + "\n";
  const Recording r = Read(csv, "[rows]\nfrom_s = 1700000000.5495\n[held_out]\nfrom_s = 1700000000.6495\n");
  ASSERT_EQ(r.num_rows(), 150u);
  EXPECT_EQ(r.signals[1].value.front(), 50.0);
  EXPECT_EQ(r.held_out[99], 0);
  EXPECT_EQ(r.held_out[100], 1);
}

/// F = 3 t every 2 ms, and u = 5 t every 3 ms with 0.5 ms between: no row has both.
std::string TwoTopics() {
  struct Row {
    double t;
    std::string text;
  };
  std::vector<Row> rows;
  char text[80];
  for (int n = 0; n < 60; ++n) {
    std::snprintf(text, sizeof text, "%.4f,,%.4f\n", 1.7e9 + 0.002 * n, 0.006 * n);
    rows.push_back({0.002 * n, text});
  }
  for (int n = 0; n < 40; ++n) {
    std::snprintf(text, sizeof text, "%.4f,%.4f,\n", 1.7e9 + 0.003 * n + 0.0005, 5.0 * (0.003 * n + 0.0005));
    rows.push_back({0.003 * n + 0.0005, text});
  }
  std::sort(rows.begin(), rows.end(), [](const Row& a, const Row& b) { return a.t < b.t; });
  std::string csv = "__time,u,F\n";
  for (const Row& row : rows) csv += row.text;
  return csv;
}

TEST_F(ForeignRecording, BlankCellsAreRefusedUnlessTheFileSaysWhatBecomesOfThem) {
  EXPECT_THAT(ErrorOf(TwoTopics(), ""), AllOf(HasSubstr("data.csv:2: u = (empty): expected a finite number"),
                                              HasSubstr("[rows] blanks = \"skip\" or \"interpolate\"")));
  EXPECT_THAT(ErrorOf(TwoTopics(), "[rows]\nblanks = \"hold\"\n"), HasSubstr("blanks"));
}

TEST_F(ForeignRecording, RowsWithBlankCellsAreSkippedOnRequest) {
  std::string csv = "__time,u,F,other\n";
  for (int n = 0; n < 40; ++n) {
    csv += Epoch(2 * n, 3) + ",1," + std::to_string(n) + ",\n";
    csv += Epoch(2 * n + 1, 3) + ",,,7\n";
  }
  const Recording r = Read(csv, "[rows]\nblanks = \"skip\"\n");
  EXPECT_EQ(r.num_rows(), 40u);
  EXPECT_EQ(r.dt, 0.002);
  EXPECT_THAT(r.notes, Contains("40 rows with blank cells are left out"));
  EXPECT_THAT(ErrorOf(TwoTopics(), "[rows]\nblanks = \"skip\"\n"), HasSubstr("uses 0 rows"));
}

TEST_F(ForeignRecording, BlankCellsAreInterpolatedBetweenTheRowsAroundButNotOfTheOutput) {
  const Recording r = Read(TwoTopics(), "[rows]\nblanks = \"interpolate\"\n");
  EXPECT_EQ(r.dt, 0.002);
  ASSERT_EQ(r.num_rows(), 58u) << "of 60: the first and the last have no u around them";
  for (std::size_t n = 0; n < r.num_rows(); ++n) {
    const double t = 0.002 * static_cast<double>(n + 1);
    EXPECT_NEAR(r.signals[0].value[n], 5.0 * t, 1e-9) << n;
    EXPECT_NEAR(r.signals[1].value[n], 3.0 * t, 1e-9) << n;
  }
  EXPECT_THAT(r.notes, Contains("42 rows with blank cells are left out"));
  EXPECT_THAT(r.notes, Contains("58 blank cells are interpolated"));
}

TEST_F(ForeignRecording, NothingIsInterpolatedOverAGap) {
  std::string csv = "t,u,F\n";
  char text[60];
  for (int n = 0; n < 200; ++n) {
    const bool gap = n > 80 && n < 120;
    std::snprintf(text, sizeof text, "%.3f,%s,%d\n", 0.001 * n, gap || n % 2 == 1 ? "" : "1", n);
    csv += text;
  }
  const Recording r = Read(csv, "[rows]\nblanks = \"interpolate\"\n");
  EXPECT_EQ(r.num_rows(), 199u - 39u);
  EXPECT_EQ(r.runs.size(), 2u);
}

TEST_F(ForeignRecording, TheSameDataGiveTheSameEstimatesToTheProgram) {
  std::string plain = "t,u,F\n",
              foreign = "\xEF\xBB\xBF\"__time\";\"/joint/position[0]\";\"ar_map.K [N m^-p]\";\"other\"\r\n";
  for (int n = 0; n < 600; ++n) {
    char text[120];
    const double u = std::sin(0.05 * n), f = 1.0 + 0.5 * u + 0.1 * std::sin(12.9898 * n * n);
    std::snprintf(text, sizeof text, "%.3f,%.9f,%.9f\n", 0.001 * n, u, f);
    plain += text;
    std::snprintf(text, sizeof text, "%s;%.9f;%.9f;\r\n", Epoch(n, 3).c_str(), u, f);
    foreign += text;
  }
  Write("plain.csv", plain);
  Write("foreign.csv", foreign);
  Write("foreign.toml", std::string("schema = 1\nmodel = \"plant.toml\"\nfile = \"foreign.csv\"\n") +
                            "[columns]\nt = \"__time\"\nu = \"/joint/position[0]\"\nF = \"ar_map.K [N m^-p]\"\n");
  const auto estimates = [&](const std::vector<std::string>& data, const std::string& out) {
    std::vector<std::string> arguments = {"--out", dir_ / out};
    arguments.insert(arguments.end(), data.begin(), data.end());
    const test::Outcome o = test::RunProgram(test::Program("armcmc-replay"), arguments);
    EXPECT_EQ(o.code, 0) << o.err;
    EXPECT_THAT(o.out, HasSubstr("gap between model and plant: not judged, since too few packs were usable: "
                                 "a verdict takes 120 blocks of data in one run, each of a pack of 0.1 s or more"));
    return test::TextOf(dir_ / out);
  };
  const std::string expected = estimates({"--model", dir_ / "plant.toml", "--data", dir_ / "plain.csv"}, "a.csv");
  const std::string from_recording = estimates({"--recording", dir_ / "foreign.toml"}, "b.csv");
  ASSERT_EQ(test::RowsOf(expected).size(), 6u);
  const auto a = test::RowsOf(expected), b = test::RowsOf(from_recording);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t n = 0; n < a.size(); ++n) {
    for (const auto& [name, cell] : a[n]) {
      if (name == "t") continue;
      EXPECT_EQ(cell, b[n].at(name)) << name;
    }
  }
}

TEST_F(ForeignRecording, ThePlantPlaysIt) {
  std::string csv = "__time\t/joint/position[0]\tar_map.K [N m^-p]\n";
  for (int n = 0; n < 300; ++n) csv += Epoch(n, 3) + "\t1\t" + std::to_string(n) + "\n";
  (void)Read(csv, kJointColumns);
  const test::Outcome o = test::RunProgram(test::Program("armcmc-plant"), {"--recording", dir_ / "recording.toml",
                                                                           "--lcm-url", "memq://", "--speed", "100"});
  EXPECT_EQ(o.code, 0) << o.err;
  EXPECT_THAT(o.out, HasSubstr("3 of 3 packs sent"));
}

}  // namespace
}  // namespace armcmc::support::foreign_csv_test
