// Logs outlive versions.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "support/paths.hpp"
#include "tools/export/csv_export.hpp"

namespace armcmc::log_export::released_logs_test {
namespace {

double Number(const std::string& text) { return std::strtod(text.c_str(), nullptr); }

/// The log of a text beside this file.
void WriteGoldenLog(const std::string& name, const std::filesystem::path& path) {
  std::ifstream text(test::SourceDir() / "tests/tools/export" / name);
  std::string line, bytes;
  std::getline(text, line);  // a comment
  for (std::string word; text >> word;) {
    if (word[0] == 'z') {
      bytes.append(std::stoul(word.substr(1)), '\0');
    } else {
      for (std::size_t i = 0; i < word.size(); i += 2)
        bytes.push_back(static_cast<char>(std::stoi(word.substr(i, 2), nullptr, 16)));
    }
  }
  std::ofstream(path, std::ios::binary) << bytes;
}

class ReleasedLogs : public CsvExport {
 protected:
  /// The table of a log that holds messages of this channel alone.
  Rows OnlyTable(const std::string& golden_log, const std::string& channel) {
    WriteGoldenLog(golden_log, request_.log);
    const ExportSummary summary = Export();
    EXPECT_EQ(summary.tables.size(), 1u);
    EXPECT_TRUE(summary.foreign.empty());
    return Table(channel);
  }
};

// These bytes were written by the first version.
TEST_F(ReleasedLogs, ALogOfTheFirstReleasedTypesStaysReadable) {
  WriteGoldenLog("golden_log.txt", request_.log);
  const ExportSummary summary = Export();
  EXPECT_EQ(summary.tables.size(), 5u);
  EXPECT_TRUE(summary.foreign.empty());
  EXPECT_FALSE(summary.damage.any());
  const Rows packs = Table("PLANT_PACK"), truth = Table("PLANT_TRUTH"), estimates = Table("EST_ESTIMATE"),
             posteriors = Table("EST_POSTERIOR"), statuses = Table("EST_STATUS");
  ASSERT_EQ(packs.size(), 3u);
  EXPECT_EQ(packs[2].at("x [m]"), "0.5");
  EXPECT_EQ(packs[2].at("f [N]"), "3.5");
  EXPECT_EQ(truth[0].at("theta_true.B [N s m^-(p+1)]"), "2.3");
  EXPECT_EQ(truth[2].at("f_true [N]"), "3.25");
  EXPECT_EQ(estimates[0].at("ar_map.p"), "2.25");
  EXPECT_EQ(estimates[0].at("draws"), "14979");
  EXPECT_EQ(estimates[0].at("zeta"), "") << "infinite";
  EXPECT_EQ(posteriors[0].at("density.p.2"), "1");
  EXPECT_EQ(statuses[0].at("rejected_type"), "7");
  EXPECT_EQ(statuses[0].at("gap_where"), "v < 0");
  EXPECT_NEAR(Number(statuses[0].at("t [s]")), 0.0501, 1e-9);
}

TEST_F(ReleasedLogs, PacksOfADescribedPlantNameTheirColumnsAndStayReadable) {
  const Rows packs = OnlyTable("golden_described_log.txt", "PLANT_PACK_V2");
  ASSERT_EQ(packs.size(), 3u);
  EXPECT_EQ(packs[2].at("F [N]"), "3.5");
  EXPECT_EQ(packs[2].at("q [m]"), "1");
  EXPECT_EQ(packs[2].at("v [m s^-1]"), "0.25");
  EXPECT_EQ(packs[2].at("seq"), "1");
}

TEST_F(ReleasedLogs, WhatIsBelievedAboutChangeStaysReadable) {
  const Rows rows = OnlyTable("golden_change_log.txt", "EST_CHANGE");
  ASSERT_EQ(rows.size(), 1u);
  EXPECT_EQ(rows[0].at("p_persisted.contact"), "0.25");
  EXPECT_EQ(rows[0].at("p_drifted.contact"), "0.625");
  EXPECT_EQ(rows[0].at("p_changed.contact"), "0.125");
  EXPECT_EQ(rows[0].at("drift_rate.contact.K [N m^-p s^-1]"), "0.5");
  EXPECT_EQ(rows[0].at("drift_rate.contact.p [s^-1]"), "0.0625");
}

}  // namespace
}  // namespace armcmc::log_export::released_logs_test
