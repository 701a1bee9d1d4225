#include "armcmc/log_export/log_export.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <limits>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "armcmc/estimate_t.hpp"
#include "armcmc/estimator_status_t.hpp"
#include "armcmc/log_export/columns.hpp"
#include "armcmc/log_export/meaning.hpp"
#include "armcmc/posterior_t.hpp"
#include "armcmc/support/program.hpp"
#include "support/paths.hpp"
#include "support/process.hpp"
#include "tools/csv_rows.hpp"
#include "tools/export/contact_estimate.hpp"
#include "tools/export/csv_export.hpp"
#include "tools/file_text.hpp"
#include "tools/replay_data.hpp"

namespace armcmc::log_export::csv_export_test {
namespace {

using replay::ContactPack;
using replay::LogWriter;
using test::TextOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

double Number(const std::string& text) { return std::strtod(text.c_str(), nullptr); }

/// A mismatch that is infinite in the first pack, as where nothing is known before it.
estimate_t EstimateWithMismatch(std::int64_t seq) {
  estimate_t e = ContactEstimate(seq);
  e.draws_by_mode[0] = 1'000;
  e.zeta = seq == 1 ? std::numeric_limits<double>::infinity() : 0.5;
  return e;
}

TEST(Meaning, EveryNumberOfEveryTypeHasItsPlaceInTheTable) {
  for (const MessageType& type : ReleasedTypes()) {
    ASSERT_TRUE(Meanings().contains(type.name)) << type.name << ": add it to lcm_types/columns.toml";
    const TypeMeaning& meaning = Meanings().at(type.name);
    for (const MessageField& field : type.fields) {
      ASSERT_TRUE(meaning.fields.contains(field.name))
          << type.name << "." << field.name << ": add it to lcm_types/columns.toml";
      EXPECT_EQ(meaning.fields.at(field.name).axes.size(), field.dims.size()) << type.name << "." << field.name;
    }
    for (const auto& [name, unused] : meaning.fields) EXPECT_NE(type.Find(name), nullptr) << type.name << "." << name;
    for (const std::string& name : meaning.repeat) EXPECT_NE(type.Find(name), nullptr) << type.name << "." << name;
  }
}

TEST(Meaning, UnitsHaveNoSlashWhichPlotJugglerTakesForAFolder) {
  EXPECT_EQ(ColumnUnit("N/m^p"), "N m^-p");
  EXPECT_EQ(ColumnUnit("N s/m^(p+1)"), "N s m^-(p+1)");
  EXPECT_EQ(ColumnUnit("m/s"), "m s^-1");
  EXPECT_EQ(ColumnUnit("sqrt(Pa) s/Pa^2"), "sqrt(Pa) s Pa^-2");
  EXPECT_EQ(ColumnUnit("rad/(s V)"), "rad (s V)^-1");
  EXPECT_EQ(ColumnUnit("N/(m/s)"), "N (m s^-1)^-1");
  EXPECT_EQ(ColumnUnit("1/(s V)"), "(s V)^-1");
  EXPECT_EQ(ColumnUnit("1/s"), "s^-1");
  EXPECT_EQ(ColumnUnit("-"), "");
  EXPECT_EQ(ColumnUnit("us"), "us");
}

TEST(Columns, AnActuatorWithEffectsIsFittedToThePressureRate) {
  const std::vector<MessageType>& types = ReleasedTypes();
  ChannelScan channel;
  for (const MessageType& type : types)
    if (type.name == "estimate_t") channel.type = &type;
  ASSERT_NE(channel.type, nullptr);
  const auto holds = [&](const PlantScan& plant, const std::string& header) {
    const std::vector<Column> columns = ColumnsOf(channel, plant);
    return std::any_of(columns.begin(), columns.end(), [&](const Column& c) { return c.header == header; });
  };
  PlantScan plant;
  plant.plant_kind = 2;
  plant.parameters = {"g", "theta2", "theta1"};
  plant.units = {"sqrt(Pa) s/Pa", "sqrt(Pa) s/Pa^2", "sqrt(Pa) s/Pa"};
  EXPECT_TRUE(holds(plant, "y_rmse [sqrt(Pa)]"));
  plant.parameters.emplace_back("leak_rate");
  plant.units.emplace_back("1/s");
  EXPECT_TRUE(holds(plant, "y_rmse [Pa s^-1]"));
  EXPECT_TRUE(holds(plant, "noise_std [Pa s^-1]"));
  plant.plant_kind = 1;  // a contact's is a force, whatever it is made of
  plant.parameters = {"K", "B", "p", "force_bias_force"};
  plant.units = {"N/m^p", "N s/m^(p+1)", "-", "N"};
  EXPECT_TRUE(holds(plant, "y_rmse [N]"));
}

TEST_F(CsvExport, EstimatesHaveTheNamesAndUnitsOfTheirParameters) {
  {
    LogWriter log(request_.log);
    for (int k = 1; k <= 3; ++k) log.Write("EST_ESTIMATE", EstimateWithMismatch(k));
  }
  const ExportSummary summary = Export();
  ASSERT_EQ(summary.tables.size(), 1u);
  EXPECT_EQ(summary.tables[0].rows, 3);
  const Rows rows = Table("EST_ESTIMATE");
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_EQ(TextOf(request_.out / "EST_ESTIMATE.csv").substr(0, 8), "\"t [s]\",");
  EXPECT_EQ(rows[0].at("t [s]"), "0");
  EXPECT_NEAR(Number(rows[2].at("t [s]")), 2e-6, 1e-12) << "the log writer counts microseconds";
  EXPECT_EQ(Number(rows[2].at("ar_map.K [N m^-p]")), EstimateWithMismatch(3).ar_map[0]) << "to the bit";
  EXPECT_EQ(Number(rows[2].at("ar_map.B [N s m^-(p+1)]")), EstimateWithMismatch(3).ar_map[1]);
  EXPECT_EQ(Number(rows[2].at("ar_map.p")), EstimateWithMismatch(3).ar_map[2]);
  EXPECT_EQ(rows[1].at("draws_by_mode.contact"), "1000");
  EXPECT_EQ(rows[0].at("zeta"), "") << "infinite";
  EXPECT_EQ(rows[1].at("zeta"), "0.5");
  EXPECT_EQ(rows[0].at("run_id"), "77");
  EXPECT_TRUE(rows[0].contains("y_pred [N]"));
  EXPECT_FALSE(rows[0].contains("ar_map.parameter3")) << "entries past n_params are left out";
  EXPECT_EQ(TextOf(request_.out / "EST_ESTIMATE.csv").find('/'), std::string::npos);
}

// DetectDelimiter in plotjuggler_plugins/DataLoadCSV/csv_parser.cpp, PlotJuggler 3.17: of the characters outside quotes
// in the header, the most frequent separates; runs of spaces count once.
TEST_F(CsvExport, PlotJugglerFindsTheSeparatorInTheHeader) {
  {
    LogWriter log(request_.log);
    log.Write("EST_ESTIMATE", EstimateWithMismatch(1));
    log.Write("PLANT_PACK", ContactPack(1));
    posterior_t p{};
    p.plant_kind = 1, p.n_params = 3, p.n_bins = 4, p.known = 1;
    log.Write("EST_POSTERIOR", p);
  }
  for (const bool long_histograms : {false, true}) {
    request_.long_histograms = long_histograms;
    Export();
    for (const char* channel : {"EST_ESTIMATE", "PLANT_PACK", "EST_POSTERIOR"}) {
      const std::string text = TextOf(request_.out / (std::string(channel) + ".csv"));
      std::map<char, int> outside;
      bool quoted = false;
      char before = '\0';
      for (const char c : text.substr(0, text.find('\n'))) {
        if (c == '"') quoted = !quoted;
        if (!quoted && (c != ' ' || before != ' ')) ++outside[c];
        before = quoted ? '"' : c;
      }
      for (const char other : {' ', ';', '\t'}) EXPECT_GT(outside[','], outside[other]) << channel << ": " << text;
    }
  }
}

// DetectColumnType in plotjuggler_plugins/DataLoadCSV/timestamp_parsing.cpp: the first cell that is not empty decides.
// It is a number of digits and a point; some versions take an exponent, and every version "inf" and "nan", for text.
// Digits alone within 1.4e9 to 2e9 are a time in seconds, of which the decimals below are cut off.
TEST_F(CsvExport, PlotJugglerTakesEveryColumnOfNumbersForNumbers) {
  const double first[] = {1e-300, -2.5e-7, 1.5e9, 3e22};
  {
    LogWriter log(request_.log);
    log.Write("EST_STATUS", estimator_status_t{});  // the estimates begin 1 us later
    for (int k = 1; k <= 3; ++k) {
      estimate_t e = EstimateWithMismatch(k);
      e.lambda = std::nan("");
      for (std::size_t i = 0; i < 3; ++i) e.sd[i] = first[i] * k;
      e.y_pred = first[3];
      if (k == 1) e.y_lo = -std::numeric_limits<double>::infinity();
      log.Write("EST_ESTIMATE", e);
    }
  }
  Export();
  const Rows rows = Table("EST_ESTIMATE");
  ASSERT_EQ(rows.size(), 3u);
  for (const auto& entry : rows[0]) {
    const std::string& name = entry.first;
    const auto numbered =
        std::find_if(rows.begin(), rows.end(), [&](const auto& row) { return !row.at(name).empty(); });
    if (numbered == rows.end()) continue;
    const std::string cell = numbered->at(name);
    EXPECT_THAT(cell, ::testing::MatchesRegex("-?[0-9]+(\\.[0-9]+)?")) << name;
    if (cell.find('.') == std::string::npos && !name.ends_with("utime") && !name.ends_with("[us]")) {
      EXPECT_LT(cell.size(), 10u) << name;
    }
    for (const auto& row : rows) {
      const std::string& text = row.at(name);
      EXPECT_TRUE(text.empty() || std::isfinite(Number(text))) << name << ": " << text;
    }
  }
  EXPECT_EQ(rows[0].at("sd.p"), "1500000000.0");
  EXPECT_EQ(rows[1].at("sd.p"), "3e+09") << "the rest is short";
  EXPECT_EQ(Number(rows[0].at("sd.K [N m^-p]")), first[0]) << "to the bit";
  EXPECT_EQ(Number(rows[0].at("sd.B [N s m^-(p+1)]")), first[1]);
  EXPECT_EQ(Number(rows[0].at("y_pred [N]")), first[3]);
  EXPECT_EQ(rows[0].at("y_lo [N]"), "");
  for (const auto& row : rows) EXPECT_EQ(row.at("lambda"), "");
}

TEST_F(CsvExport, SamplesOfAPackHaveARowAndATimeEach) {
  {
    LogWriter log(request_.log);
    log.Write("EST_STATUS", estimator_status_t{});
    for (int k = 1; k <= 2; ++k) log.Write("PLANT_PACK", ContactPack(k));
  }
  EXPECT_EQ(Export().tables.at(1).rows, 200);
  const Rows rows = Table("PLANT_PACK");
  ASSERT_EQ(rows.size(), 200u);
  EXPECT_NEAR(Number(rows[99].at("t [s]")), 1e-6, 1e-12) << "the first pack is in the log 1 us after the status";
  for (std::size_t i = 1; i < rows.size(); ++i)
    EXPECT_NEAR(Number(rows[i].at("t [s]")) - Number(rows[i - 1].at("t [s]")), 0.001, 1e-12) << i;
  EXPECT_EQ(Number(rows[150].at("x [m]")), replay::ContactAt(151).x);
  EXPECT_EQ(Number(rows[150].at("v [m s^-1]")), replay::ContactAt(151).v);
  EXPECT_EQ(Number(rows[150].at("f [N]")), replay::ContactAt(151).f);
  EXPECT_EQ(rows[150].at("seq"), "2");
}

TEST_F(CsvExport, SamplesThatPacksShareHaveOneRow) {
  {
    LogWriter log(request_.log);
    for (int k = 1; k <= 21; ++k) {  // a pack every 10 samples
      data_pack_t pack = ContactPack(1);
      pack.seq = k;
      for (int n = 0; n < 100; ++n) {
        const replay::ContactSample s = replay::ContactAt(10 * (k - 1) + 1 + n);
        pack.u[n][0] = s.x;
        pack.u[n][1] = s.v;
        pack.y[n] = s.f;
        pack.t_last_s = s.t;
      }
      log.Write("PLANT_PACK", pack);
      if (k % 5 == 0) log.Write("PLANT_PACK", pack);  // twice: as it came
    }
  }
  request_.channels = {"PLANT_PACK"};
  Export();
  Rows rows = Table("PLANT_PACK");
  EXPECT_EQ(rows.size(), 300u + 4 * 100u);
  std::erase_if(
      rows, [seen = std::set<std::string>()](const auto& row) mutable { return !seen.insert(row.at("f [N]")).second; });
  ASSERT_EQ(rows.size(), 300u);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    EXPECT_EQ(Number(rows[i].at("f [N]")), replay::ContactAt(static_cast<int>(i) + 1).f) << i;
    if (i > 0) {
      EXPECT_NEAR(Number(rows[i].at("t [s]")) - Number(rows[i - 1].at("t [s]")), 0.001, 1e-12) << i;
    }
  }
}

TEST_F(CsvExport, PosteriorsAreWideOrLong) {
  {
    LogWriter log(request_.log);
    log.Write("EST_ESTIMATE", EstimateWithMismatch(1));
    posterior_t p{};
    p.plant_kind = 1, p.n_params = 3, p.n_bins = 4, p.seq = 1;
    log.Write("EST_POSTERIOR", p);  // nothing is known yet
    p.known = 1, p.seq = 2;
    p.lo[1] = 2.0, p.hi[1] = 4.0;
    p.density[1][3] = 0.75;
    log.Write("EST_POSTERIOR", p);
  }
  Export();
  Rows rows = Table("EST_POSTERIOR");
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[1].at("density.B.3 [(N s m^-(p+1))^-1]"), "0.75");
  EXPECT_EQ(rows[1].at("hi.B [N s m^-(p+1)]"), "4");
  EXPECT_FALSE(rows[1].contains("density.B.4 [(N s m^-(p+1))^-1]")) << "bins past n_bins are left out";
  request_.long_histograms = true;
  Export();
  rows = Table("EST_POSTERIOR");
  ASSERT_EQ(rows.size(), 12u) << "three parameters, four bins";
  const auto& row = rows[7];
  EXPECT_EQ(row.at("parameter"), "B");
  EXPECT_EQ(row.at("unit"), "N s m^-(p+1)");
  EXPECT_EQ(row.at("bin"), "3");
  EXPECT_EQ(row.at("from"), "3.5");
  EXPECT_EQ(row.at("to"), "4");
  EXPECT_EQ(row.at("density"), "0.75");
}

TEST_F(CsvExport, EveryPlantHasTablesOfItsOwn) {
  {
    LogWriter log(request_.log);
    log.Write("A_EST_ESTIMATE", EstimateWithMismatch(1));
    estimate_t other = EstimateWithMismatch(1);
    std::memcpy(other.param_name[0], "k0", 2);
    log.Write("B_EST_ESTIMATE", other);
    log.Write("B_PLANT_PACK", ContactPack(1));
  }
  EXPECT_EQ(Export().tables.size(), 3u);
  EXPECT_TRUE(Table("A_EST_ESTIMATE")[0].contains("ar_map.K [N m^-p]"));
  EXPECT_TRUE(Table("B_EST_ESTIMATE")[0].contains("ar_map.k0 [N m^-p]"));
  request_.prefix = "B_";
  EXPECT_EQ(Export().tables.size(), 2u);
  request_.channels = {"EST_ESTIMATE"};
  const ExportSummary summary = Export();
  ASSERT_EQ(summary.tables.size(), 1u);
  EXPECT_EQ(summary.tables[0].channel.name, "B_EST_ESTIMATE");
  EXPECT_EQ(summary.left_out, 2);
}

TEST_F(CsvExport, ForeignChannelsAndDamageAreCountedAndSaid) {
  {
    LogWriter log(request_.log);
    log.Write("PLANT_PACK", ContactPack(1));
    log.Write("PLANT_PACK", EstimateWithMismatch(1));  // another type on our channel
    log.Write("PLANT_PACK", ContactPack(2));
    log.WriteRaw("CAMERA", "no type of ours");
    log.WriteRaw("CAMERA", "x");
    log.Write("EST_ESTIMATE", EstimateWithMismatch(2));
  }
  std::string bytes = TextOf(request_.log);
  std::ofstream(request_.log, std::ios::binary) << bytes.substr(0, bytes.size() - 10);
  const test::Outcome o = Program({});
  ASSERT_EQ(o.code, 0) << o.err;
  EXPECT_THAT(o.out, HasSubstr("foreign: CAMERA, 2 events of type 6e6f207479706520"));
  EXPECT_THAT(o.out, HasSubstr("the log is damaged: cut off at its end (1526 bytes)"));
  const Rows rows = Table("PLANT_PACK");
  EXPECT_EQ(rows.size(), 200u);
  std::string line = o.out.substr(o.out.find("\nPLANT_PACK"));
  std::istringstream words(line);
  std::vector<std::string> cells{std::istream_iterator<std::string>(words), {}};
  cells.resize(5);
  EXPECT_THAT(cells, ElementsAre("PLANT_PACK", "data_pack_t", "2", "200", "1"));
}

TEST_F(CsvExport, BadInputIsOneLine) {
  {
    LogWriter log(request_.log);
    log.Write("PLANT_PACK", ContactPack(1));
  }
  test::Outcome o = Program({"--channels", "EST_ESTIMATE,PLANT_PACK"});
  EXPECT_EQ(o.code, 2);
  EXPECT_THAT(o.err, HasSubstr("holds nothing readable on channel EST_ESTIMATE; it has PLANT_PACK"));
  o = Program({"--histograms", "tall"});
  EXPECT_EQ(o.code, 2);
  request_.log = dir_ / "none.lcm";
  o = Program({});
  EXPECT_EQ(o.code, 2);
  EXPECT_EQ(std::count(o.err.begin(), o.err.end(), '\n'), 1) << o.err;
}

}  // namespace
}  // namespace armcmc::log_export::csv_export_test
