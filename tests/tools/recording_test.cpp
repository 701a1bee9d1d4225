#include "armcmc/support/recording.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <functional>
#include <random>
#include <sstream>
#include <string>

#include "support/paths.hpp"
#include "support/process.hpp"

namespace armcmc::support::recording_test {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

constexpr double kDt = 0.001;

class RecordingFile : public ::testing::Test {
 protected:
  void SetUp() override {
    Write("plant.toml", R"(schema = 1
name = "axis"
title = "Axis"
output = "F"
law = "M*a + Fv*v"
[signals]
q = { unit = "m", role = "position" }
v = { unit = "m/s", role = "velocity", derivative_of = "q" }
a = { unit = "m/s^2", role = "acceleration", derivative_of = "v" }
F = { unit = "N", role = "force" }
[parameters]
M = { unit = "kg", mean = 90.0, sd = 30.0 }
Fv = { unit = "N s/m", mean = 200.0, sd = 100.0 }
[noise]
std = 1.0
)");
  }
  void Write(const std::string& name, const std::string& text) const { std::ofstream(dir_ / name) << text; }

  /// Columns time_ms, part, pos_mm, volt: a sine of 5 Hz.
  void WriteCsv(
      int rows, const std::function<double(int)>& time_ms = [](int n) { return 1.0 * n; },
      const std::function<const char*(int)>& part = [](int) { return "one"; }) const {
    std::ofstream file(dir_ / "data.csv");
    file.precision(15);
    file << "time_ms,part,pos_mm,volt\n";
    for (int n = 0; n < rows; ++n) {
      const double t = 1e-3 * time_ms(n);
      file << time_ms(n) << ',' << part(n) << ',' << 100.0 * std::sin(2.0 * M_PI * 5.0 * t) << ',' << 0.5 + t << '\n';
    }
  }
  [[nodiscard]] Recording Read(const std::string& more = "", const std::string& columns = kColumns) const {
    Write("recording.toml", "schema = 1\nmodel = \"plant.toml\"\nfile = \"data.csv\"\n" + columns + more);
    return ReadRecording(dir_ / "recording.toml", "");
  }
  [[nodiscard]] std::string ErrorOf(const std::string& more, const std::string& columns = kColumns) const {
    try {
      (void)Read(more, columns);
    } catch (const std::exception& error) {
      return error.what();
    }
    return "no error";
  }

  static constexpr const char* kColumns =
      "[columns]\nt = { column = \"time_ms\", scale = 1e-3 }\nq = { column = \"pos_mm\", scale = 1e-3 }\n"
      "F = { column = \"volt\", scale = 4.0, offset = -1.0 }\n";
  test::ScratchDir dir_;
};

TEST_F(RecordingFile, ScalesColumnsAndMakesDerivativesWithoutDelay) {
  WriteCsv(1000);
  const Recording r = Read("[derivatives]\nbandwidth_hz = 60\n");
  ASSERT_EQ(r.num_rows(), 1000u);
  EXPECT_EQ(r.plant, "axis");
  EXPECT_EQ(r.output, 3u);
  EXPECT_DOUBLE_EQ(r.dt, kDt);
  EXPECT_THAT(r.runs, ElementsAre(0u));
  EXPECT_NEAR(r.signals[3].value[100], 4.0 * 0.6 - 1.0, 1e-12);
  const double w = 2.0 * M_PI * 5.0;
  for (std::size_t n = 100; n < 900; ++n) {
    const double t = kDt * static_cast<double>(n);
    EXPECT_NEAR(r.signals[0].value[n], 0.1 * std::sin(w * t), 1e-12);
    EXPECT_NEAR(r.signals[1].value[n], 0.1 * w * std::cos(w * t), 0.01 * 0.1 * w) << n;
    EXPECT_NEAR(r.signals[2].value[n], -0.1 * w * w * std::sin(w * t), 0.01 * 0.1 * w * w) << n;
  }
  EXPECT_EQ(r.held_out[699], 0);
  EXPECT_EQ(r.held_out[700], 1) << "the last 30 % where nothing is said";
}

TEST_F(RecordingFile, DerivativesHoldToTheEndsOfARun) {
  // Both ends in the middle of a turn, where the acceleration is large.
  constexpr int kStart = 40;
  WriteCsv(960, [](int n) { return 1.0 * (n + kStart); });
  const double w = 2.0 * M_PI * 5.0;
  for (const char* bandwidth : {"", "[derivatives]\nbandwidth_hz = 40\n"}) {
    const Recording r = Read(bandwidth);
    for (std::size_t n = 0; n < r.num_rows(); ++n) {
      const double t = kDt * static_cast<double>(n + kStart);
      EXPECT_NEAR(r.signals[1].value[n], 0.1 * w * std::cos(w * t), 0.01 * 0.1 * w) << n << ' ' << bandwidth;
      EXPECT_NEAR(r.signals[2].value[n], -0.1 * w * w * std::sin(w * t), 0.05 * 0.1 * w * w) << n << ' ' << bandwidth;
    }
  }
}

TEST_F(RecordingFile, AFilteredOutputKnowsTheNoiseThatTheFilterLetThrough) {
  const auto force = [](int n) { return 20.0 * std::sin(2.0 * M_PI * 1.5e-3 * n); };
  std::mt19937_64 random(3);
  std::normal_distribution<double> noise(0.0, 0.3);
  std::ofstream file(dir_ / "data.csv");
  file.precision(15);
  file << "t,q,F\n";
  for (int n = 0; n < 6000; ++n)
    file << 1e-3 * n << ',' << 0.1 * std::sin(2e-3 * n) << ',' << force(n) + noise(random) << '\n';
  file.close();
  const std::string columns = "[columns]\nt = { column = \"t\" }\nq = { column = \"q\" }\nF = { column = \"F\" }\n";
  const Recording r = Read("[derivatives]\nbandwidth_hz = 40\nfiltered_with = [\"F\"]\n", columns);
  double square = 0.0;
  for (int n = 100; n < 5900; ++n)
    square += std::pow(r.signals[3].value[static_cast<std::size_t>(n)] - force(n), 2) / 5800.0;
  EXPECT_NEAR(r.smoothed_noise, 0.3 * std::sqrt(2.0 * 40.0 * 1e-3), 0.01);
  EXPECT_NEAR(r.smoothed_noise, std::sqrt(square), 0.2 * std::sqrt(square));
  EXPECT_EQ(Read("[derivatives]\nbandwidth_hz = 40\n", columns).smoothed_noise, 0.0) << "not filtered";
}

TEST_F(RecordingFile, AColumnMayBeAnExpression) {
  WriteCsv(200);
  const Recording r = Read("",
                           "[columns]\nt = { value = \"time_ms/1000\" }\nq = { value = \"-(pos_mm + volt)*1e-3\" }\n"
                           "F = \"volt\"\n");
  EXPECT_NEAR(r.signals[0].value[50], -1e-3 * (100.0 * std::sin(2.0 * M_PI * 0.25) + 0.55), 1e-12);
  EXPECT_NEAR(r.signals[3].value[50], 0.55, 1e-12);
  EXPECT_THAT(
      ErrorOf("", "[columns]\nt = { value = \"tme_ms\" }\nq = \"pos_mm\"\nF = \"volt\"\n"),
      AllOf(HasSubstr("recording.toml:5:16: columns.t.value = \"tme_ms\": unknown name \"tme_ms\" (did you mean "
                      "time_ms?); columns of "),
            HasSubstr("that an expression can name: time_ms")));
  EXPECT_THAT(ErrorOf("", "[columns]\nt = { value = \"tme(time_ms)\" }\nq = \"pos_mm\"\nF = \"volt\"\n"),
              AllOf(HasSubstr("unknown function \"tme\""), Not(HasSubstr("did you mean"))));
}

TEST_F(RecordingFile, SegmentsAndGapsAreRuns) {
  // Time starts again in the second part; in that a gap of 50 samples.
  WriteCsv(
      600, [](int n) { return n < 300   ? n
                              : n < 450 ? n - 300
                                        : n - 250; },
      [](int n) { return n < 300 ? "up" : "down"; });
  const Recording r = Read("[rows]\nsegment_column = \"part\"\n[held_out]\nsegments = [\"down\"]\n");
  EXPECT_THAT(r.runs, ElementsAre(0u, 300u, 450u));
  EXPECT_EQ(r.held_out[299], 0);
  EXPECT_EQ(r.held_out[300], 1);
  EXPECT_DOUBLE_EQ(r.t[300], 0.0);
  EXPECT_THAT(ErrorOf(""), HasSubstr("data.csv:302: t = 0: expected more than 0.299"));
  EXPECT_THAT(ErrorOf("[rows]\nonly = { part = [\"up\"] }\n"), StartsWith("no error"));
}

TEST_F(RecordingFile, SaysThatMemoryBeginsEachRunAtRest) {
  const auto gap = [](int n) { return n < 300 ? n : n + 100; };
  const auto begins = ::testing::Contains(HasSubstr("lowpass() begins each run at rest"));
  WriteCsv(600, gap);
  EXPECT_THAT(Read().notes, ::testing::Not(begins));
  std::stringstream plant;
  plant << std::ifstream(dir_ / "plant.toml").rdbuf();
  std::string text = plant.str();
  Write("plant.toml", text.replace(text.find("Fv*v"), 4, "lowpass(Fv*v, 0.1)"));
  EXPECT_THAT(Read().notes, begins);
  WriteCsv(600);
  EXPECT_THAT(Read().notes, ::testing::Not(begins)) << "one run";
}

TEST_F(RecordingFile, SaysThatABandwidthAboveHalfTheSampleRateFiltersNothing) {
  WriteCsv(600);
  EXPECT_THAT(Read("[derivatives]\nbandwidth_hz = 500\n").notes,
              ::testing::Contains(HasSubstr("not below half the sample rate, 500 Hz")));
  EXPECT_THAT(Read("[derivatives]\nbandwidth_hz = 499\n").notes,
              ::testing::Not(::testing::Contains(HasSubstr("half"))));
}

TEST_F(RecordingFile, SaysWhereASignalWithoutAColumnBelongs) {
  WriteCsv(100);
  EXPECT_THAT(ErrorOf("", "[columns]\nt = \"time_ms\"\nq = \"pos_mm\"\n"),
              HasSubstr("recording.toml:4:1: columns.F: which"));
  EXPECT_THAT(ErrorOf("", "[columns]\nq = \"pos_mm\"\nF = \"volt\"\n"),
              HasSubstr("recording.toml:4:1: columns.t: which"));
  EXPECT_THAT(ErrorOf("[rows]\nfrom = 95\n"), HasSubstr("recording.toml:8:1: rows: uses 5 rows of the 100 of"));
}

TEST_F(RecordingFile, UnevenTimeIsInterpolated) {
  WriteCsv(500, [](int n) { return n + (n % 2 == 0 ? 0.0 : 0.2); });
  const Recording r = Read("[derivatives]\nbandwidth_hz = 60\n");
  for (std::size_t n = 50; n < 400; ++n)
    EXPECT_NEAR(r.signals[0].value[n], 0.1 * std::sin(2.0 * M_PI * 5.0 * r.t[n]), 1e-4);
  EXPECT_THAT(r.notes, ::testing::Contains(HasSubstr("time is uneven")));
}

TEST_F(RecordingFile, KnowsWhatInterpolationDoesToNoise) {
  constexpr int kRows = 20'000;
  std::mt19937 random(5);
  std::normal_distribution<double> noise;
  std::uniform_real_distribution<double> jitter(-0.3, 0.3);
  {
    std::ofstream file(dir_ / "data.csv");
    file.precision(12);
    file << "time_ms,pos_mm,volt\n";
    for (int n = 0; n < kRows; ++n) file << n + jitter(random) << ",1," << noise(random) << '\n';
  }
  const Recording r = Read();
  const std::vector<double>& y = r.signals[3].value;  // 4 V/V: a standard deviation of 4
  double square = 0.0, third = 0.0;
  for (std::size_t n = 3; n < y.size(); ++n) {
    square += std::pow(y[n] + 1.0, 2);
    third += std::pow(y[n] - 3.0 * y[n - 1] + 3.0 * y[n - 2] - y[n - 3], 2) / 20.0;
  }
  const auto count = static_cast<double>(y.size() - 3);
  EXPECT_LT(r.noise_in_differences, 0.9 * r.noise_in_samples);
  EXPECT_NEAR(r.noise_in_samples, std::sqrt(square / count) / 4.0, 0.02);
  EXPECT_NEAR(r.noise_in_differences, std::sqrt(third / count) / 4.0, 0.02);
  WriteCsv(500);
  EXPECT_EQ(Read().noise_in_samples, 1.0);
  EXPECT_EQ(Read().noise_in_differences, 1.0);
}

TEST_F(RecordingFile, RowsAreThoseThatAreAskedFor) {
  WriteCsv(1000);
  EXPECT_EQ(Read("[rows]\nfrom = 100\nuntil = 400\n").num_rows(), 300u);
  EXPECT_NEAR(Read("[rows]\nfrom_s = 0.2\nuntil_s = 0.5\n").t.front(), 0.2, 1e-12);
  const Recording every = Read("[rows]\nevery = 5\n");
  EXPECT_EQ(every.num_rows(), 200u);
  EXPECT_DOUBLE_EQ(every.dt, 0.005);
  EXPECT_THAT(Read("[rows]\ndrop = [[0, 15], [500, 600]]\n").runs, ElementsAre(0u, 485u));
  const Recording held = Read("[held_out]\nrows = [[10, 20], [900, 1000]]\n");
  EXPECT_EQ(std::count(held.held_out.begin(), held.held_out.end(), 1), 110);
  EXPECT_THAT(held.notes, Not(testing::Contains(HasSubstr("clipped"))));
  const Recording clipped = Read("[held_out]\nrows = [[10, 20], [900, 1001]]\n");
  EXPECT_EQ(std::count(clipped.held_out.begin(), clipped.held_out.end(), 1), 110);
  EXPECT_THAT(clipped.notes, testing::Contains(AllOf(HasSubstr("recording.toml:9:8: held_out.rows = "),
                                                     HasSubstr("900 to 1000: clipped at the last row"),
                                                     HasSubstr("data.csv has the rows 0 to 999"))));
  const Recording columns = Read("[held_out.columns]\nF = { column = \"volt\", scale = 2.0 }\n");
  ASSERT_EQ(columns.num_rows(), 2000u);
  EXPECT_NEAR(columns.signals[3].value[1000], 1.0, 1e-12);
  EXPECT_EQ(columns.held_out[999] + 2 * columns.held_out[1000], 2);
}

TEST_F(RecordingFile, AWrongUnitIsAnErrorThatNamesIt) {
  WriteCsv(1000);
  const std::string columns(kColumns);
  {
    std::ifstream in(dir_ / "data.csv");
    std::ofstream out(dir_ / "with_v.csv");
    std::string line;
    std::getline(in, line);
    out << line << ",vel\n";
    for (int n = 0; std::getline(in, line); ++n)
      out << line << ',' << 0.1 * 2.0 * M_PI * 5.0 * std::cos(2.0 * M_PI * 5.0 * 1e-3 * n) << '\n';
  }
  std::filesystem::rename(dir_ / "with_v.csv", dir_ / "data.csv");
  EXPECT_THAT(ErrorOf("", columns + "v = { column = \"vel\" }\n"), StartsWith("no error"));
  EXPECT_THAT(ErrorOf("", columns + "v = { column = \"vel\", scale = 1000 }\n"),
              testing::AllOf(HasSubstr("columns.v"), HasSubstr("the derivative of q"), HasSubstr("thousandths")));
  EXPECT_THAT(ErrorOf("", columns + "v = { column = \"vel\", scale = -1 }\n"), HasSubstr("likely its sign"));
}

TEST_F(RecordingFile, MistakesAreErrorsWithTheirPlace) {
  WriteCsv(1000);
  EXPECT_THAT(ErrorOf("[rows]\nform = 3\n"), testing::AllOf(HasSubstr("recording.toml:9"), HasSubstr("from")));
  EXPECT_THAT(ErrorOf("", "[columns]\nt = \"time_ms\"\nQ = \"pos_mm\"\nF = \"volt\"\n"), HasSubstr("not a signal"));
  EXPECT_THAT(ErrorOf("", "[columns]\nt = \"time_ms\"\nq = \"pos_m\"\nF = \"volt\"\n"),
              HasSubstr("did you mean pos_mm"));
  EXPECT_THAT(ErrorOf("", "[columns]\nq = \"pos_mm\"\nF = \"volt\"\n"), HasSubstr("rate_hz"));
  EXPECT_THAT(ErrorOf("[held_out]\nfrom = 0\n"), HasSubstr("nothing is left to fit to"));
  std::filesystem::remove(dir_ / "data.csv");
  EXPECT_THAT(ErrorOf(""), HasSubstr("--data-dir"));
  Write("data.csv", "time_ms,part,pos_mm,volt\n0,a,1,2\n1,a,nan,2\n");
  EXPECT_THAT(ErrorOf(""), HasSubstr("data.csv:3: pos_mm = nan: expected a finite number"));
}

TEST_F(RecordingFile, AMistakeInAColumnStandsWhereItIs) {
  WriteCsv(1000);
  const std::string time = "[columns]\nt = \"time_ms\"\nF = \"volt\"\n";
  EXPECT_THAT(ErrorOf("", time + "q = { value = \"0.001*pos_mm + speed\" }\n"),
              testing::AllOf(HasSubstr("recording.toml:7:31: columns.q.value"), HasSubstr("speed")));
  EXPECT_THAT(ErrorOf("", time + "q = { column = \"pos\" }\n"), HasSubstr("recording.toml:7:16: columns.q.column"));
  EXPECT_THAT(ErrorOf("[rows]\nsegment_column = \"run\"\n"), HasSubstr("rows.segment_column"));
  EXPECT_THAT(ErrorOf("[rows]\nonly = { part = [\"two\"] }\n"), HasSubstr("no row has \"two\"; available: one"));
  EXPECT_THAT(ErrorOf("[rows]\nsegment_column = \"part\"\n[held_out]\nsegments = [\"onne\"]\n"),
              HasSubstr("did you mean one"));
  EXPECT_THAT(ErrorOf("[held_out]\nfrom = 5000\n"), HasSubstr("holds out no row that is used"));
  EXPECT_THAT(
      ErrorOf("[held_out]\nrows = [[10, 20], [1000, 1100]]\n"),
      AllOf(HasSubstr("recording.toml:9:8: held_out.rows = "), HasSubstr("1000 to 1099: there are no such rows")));
  EXPECT_THAT(ErrorOf("[rows]\nfrom = 10\nfrom_s = 0.1\n"), HasSubstr("a row or a time, not both"));
  Write("data.csv", "time_ms;part;pos_mm;volt\n0;a;1,5;2\n");
  EXPECT_THAT(ErrorOf(""), HasSubstr("data.csv:2: pos_mm = 1,5: expected a finite number with a point as decimal"));
}

TEST_F(RecordingFile, RowsThatAreLeftOutNeedNotBeReadable) {
  WriteCsv(1000);
  std::string text;
  {
    std::ifstream in(dir_ / "data.csv");
    std::string line;
    for (int n = -1; std::getline(in, line); ++n) {
      if (n == 0) text += "ms,\"a, b\",mm,V\n";  // units, and a text with a comma in it
      text += line + '\n';
    }
    text += "1000,one,12";  // cut off
  }
  Write("data.csv", text);
  EXPECT_THAT(ErrorOf(""), testing::AllOf(HasSubstr("data.csv:2: time_ms = ms"), HasSubstr("drop = [[0, 1]]")));
  EXPECT_THAT(ErrorOf("[rows]\ndrop = [[0, 1]]\n"), HasSubstr("cut off here; [rows] drop = [[1001, 1002]]"));
  EXPECT_EQ(Read("[rows]\nfrom = 1\nuntil = 1001\n").num_rows(), 1000u);
}

TEST_F(RecordingFile, CellsMayBeInQuotes) {
  WriteCsv(
      1000, [](int n) { return 1.0 * n; }, [](int n) { return n < 600 ? "\"one, two\"" : "\"three\""; });
  EXPECT_EQ(Read("[rows]\nonly = { part = [\"one, two\"] }\n").num_rows(), 600u);
}

TEST(RecordingFiles, ThoseThatComeAlongAreRead) {
  ARMCMC_REQUIRE_DATA("measured/emps_estimation.csv");
  const auto data = test::FindData("measured/emps_estimation.csv")->parent_path();
  for (const char* name : {"emps_estimation", "cascaded_tanks", "afm_indentation_zebrafish", "brfd_friction_backlash",
                           "pneumatic_seal_friction"}) {
    const Recording r = ReadRecording(test::SourceDir() / "tools/gap/recordings" / (std::string(name) + ".toml"), data);
    EXPECT_GT(r.num_rows(), 1000u) << name;
    EXPECT_GT(std::count(r.held_out.begin(), r.held_out.end(), 1), 100) << name;
    for (const RecordedSignal& signal : r.signals) EXPECT_EQ(signal.value.size(), r.num_rows()) << name;
  }
}

TEST(RecordingFiles, TheExcerptComesWithItsData) {
  const Recording r =
      ReadRecording(test::SourceDir() / "tools/gap/recordings/excerpt/emps_excerpt.toml", std::filesystem::path());
  EXPECT_EQ(r.num_rows(), 9000u);
  EXPECT_NEAR(r.dt, 2e-3, 1e-6);
}

TEST(RecordingFiles, ReplayEstimatesFromOne) {
  ARMCMC_REQUIRE_DATA("measured/emps_estimation.csv");
  const test::ScratchDir dir;
  const auto data = test::FindData("measured/emps_estimation.csv")->parent_path();
  const test::Outcome o =
      test::RunProgram(test::Program("armcmc-replay"),
                       {"--recording", (test::SourceDir() / "tools/gap/recordings/emps_estimation.toml").string(),
                        "--data-dir", data.string(), "--out", (dir / "estimates.csv").string()},
                       std::chrono::minutes(2));
  ASSERT_EQ(o.code, 0) << o.err;
  EXPECT_THAT(o.out, HasSubstr("248 packs (24.8 s)"));
  EXPECT_THAT(o.out, HasSubstr("v is derived from q, 40 Hz"));
}

TEST_F(RecordingFile, TwoOfOnePlantAreJoinedAsRuns) {
  WriteCsv(400);
  const Recording first = Read();
  WriteCsv(200);
  const Recording second = Read();
  const Recording both = Joined(first, second);
  ASSERT_EQ(both.num_rows(), first.num_rows() + second.num_rows());
  EXPECT_THAT(both.runs, ElementsAre(0u, first.num_rows()));
  EXPECT_EQ(both.signals[0].value[first.num_rows()], second.signals[0].value[0]);
  EXPECT_EQ(both.held_out[first.num_rows() - 1], first.held_out.back());
  EXPECT_EQ(both.t[first.num_rows()], second.t[0]);
  EXPECT_THAT(both.notes.back(), HasSubstr("judged together"));

  Recording other = first;
  other.dt *= 2.0;
  EXPECT_THROW(static_cast<void>(Joined(other, second)), std::runtime_error);
  other = first;
  other.fingerprint += 1;
  EXPECT_THROW(static_cast<void>(Joined(other, second)), std::runtime_error);
}

}  // namespace
}  // namespace armcmc::support::recording_test
