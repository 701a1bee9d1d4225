#pragma once

#include <gtest/gtest.h>

#include <map>
#include <string>
#include <vector>

#include "armcmc/log_export/log_export.hpp"
#include "support/paths.hpp"
#include "support/process.hpp"
#include "tools/csv_rows.hpp"
#include "tools/file_text.hpp"

namespace armcmc::log_export {

using Rows = std::vector<std::map<std::string, std::string>>;

/// A log and the tables that are made from it.
class CsvExport : public ::testing::Test {
 protected:
  CsvExport() { request_.log = dir_ / "run.lcm", request_.out = dir_ / "tables"; }
  ExportSummary Export() {
    return ExportLog(request_, [](double) {});
  }
  Rows Table(const std::string& channel) { return test::RowsOf(test::TextOf(request_.out / (channel + ".csv"))); }
  test::Outcome Program(std::vector<std::string> more) {
    more.insert(more.begin(), {"--data", request_.log, "--out", request_.out});
    return test::RunProgram(test::Program("armcmc-export"), more);
  }
  test::ScratchDir dir_;
  ExportRequest request_;
};

}  // namespace armcmc::log_export
