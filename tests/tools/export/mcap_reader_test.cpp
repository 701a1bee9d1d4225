// Our MCAP files as others read them.

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <string>

#include "armcmc/estimate_t.hpp"
#include "armcmc/posterior_t.hpp"
#include "support/paths.hpp"
#include "support/process.hpp"
#include "tools/csv_rows.hpp"
#include "tools/file_text.hpp"
#include "tools/replay_data.hpp"

namespace armcmc::log_export::mcap_reader_test {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

std::optional<fs::path> FindNode() {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path == nullptr ? "" : path);
  for (std::string folder; std::getline(folders, folder, ':');)
    for (const char* name : {"node", "nodejs"})
      if (const fs::path file = fs::path(folder) / name; access(file.c_str(), X_OK) == 0) return file;
  return std::nullopt;
}

/// Where the configuration has unpacked the reader (McapReader.cmake).
fs::path NodeModules() { return test::Program("").parent_path().parent_path() / "npm/mcap_reader/node_modules"; }

/// A log of two plants with more bytes than a chunk holds.
void WriteLog(const fs::path& path) {
  replay::LogWriter log(path);
  for (int k = 1; k <= 80; ++k) {
    log.Write("PLANT_PACK", replay::ContactPack(k));
    estimate_t e{};
    e.seq = k, e.plant_kind = 1, e.n_params = 3, e.n_modes = 1;
    e.run_id = 9'007'199'254'740'993;  // has more digits than a double
    for (int i = 0; i < 3; ++i) e.ar_map[i] = 1.0 / (k + i), e.q975[i] = -1e-300 * k;
    log.Write("EST_ESTIMATE", e);
    e.n_params = 2;
    e.param_name[0][0] = 'k', e.param_name[1][0] = 'd';
    log.Write("B_EST_ESTIMATE", e);
    posterior_t p{};
    p.plant_kind = 1, p.n_params = 3, p.n_bins = 60, p.known = 1, p.seq = k;
    for (int b = 0; b < 60; ++b) p.density[2][b] = 0.1 * b * k;
    log.Write("EST_POSTERIOR", p);
  }
}

/// The value of a column of the CSV in a message.
const Json& At(const Json& message, const std::string& header) {
  std::istringstream names(header.substr(0, header.find(" [")));
  const Json* at = &message;
  for (std::string name; std::getline(names, name, '.');)
    at = at->is_array() ? &at->at(std::stoul(name)) : &at->at(name);
  return *at;
}

void ExpectEqual(const Json& messages, const std::string& csv, const std::string& topic) {
  const auto rows = test::RowsOf(csv);
  ASSERT_EQ(messages.size(), rows.size()) << topic;
  for (std::size_t n = 0; n < rows.size(); ++n) {
    EXPECT_EQ(messages[n]["sequence"], n);
    const Json message = Json::parse(messages[n]["json"].get<std::string>());
    for (const auto& [header, cell] : rows[n]) {
      if (header == "t [s]") {
        const double ns = std::strtod(messages[n]["log_time"].get<std::string>().c_str(), nullptr);
        const double expected = std::strtod(cell.c_str(), nullptr) * 1e9 + 1'000;  // the first event is at 1 us
        EXPECT_NEAR(ns, expected > 0 ? expected : 0, 1.0) << topic << " " << n;
      } else {
        ASSERT_EQ(At(message, header), Json::parse(cell)) << topic << " " << n << " " << header;
      }
    }
  }
}

TEST(McapReader, TheReferenceReaderFindsTheRowsOfTheCsvWithTheIndexAndWithout) {
  const std::optional<fs::path> node = FindNode();
  if (!node) GTEST_SKIP() << "needs node: apt-get install nodejs";
  if (!fs::exists(NodeModules() / "@mcap/core/package.json"))
    GTEST_SKIP() << "needs @mcap/core of the npm registry, which was not reachable when this build was configured";
  const test::ScratchDir dir;
  WriteLog(dir / "run.lcm");
  for (const std::vector<std::string>& how :
       {std::vector<std::string>{"--out", dir / "tables"}, {"--out", dir / "run.mcap", "--format", "mcap"}}) {
    std::vector<std::string> arguments = {"--data", dir / "run.lcm"};
    arguments.insert(arguments.end(), how.begin(), how.end());
    const test::Outcome o = test::RunProgram(test::Program("armcmc-export"), arguments);
    ASSERT_EQ(o.code, 0) << o.err;
  }
  const test::Outcome o = test::RunProgram(
      *node, {test::SourceDir() / "tests/tools/export/read_mcap.cjs", NodeModules(), dir / "run.mcap"});
  ASSERT_EQ(o.code, 0) << o.err;
  const Json read = Json::parse(o.out);
  const std::map<std::string, std::size_t> counts = {
      {"PLANT_PACK", 8000}, {"EST_ESTIMATE", 80}, {"B_EST_ESTIMATE", 80}, {"EST_POSTERIOR", 80}};
  for (const char* way : {"indexed", "streamed"}) {
    SCOPED_TRACE(way);
    ASSERT_EQ(read[way]["messages"].size(), counts.size());
    for (const auto& [topic, count] : counts) {
      EXPECT_EQ(read[way]["messages"][topic].size(), count);
      ExpectEqual(read[way]["messages"][topic], test::TextOf(dir / ("tables/" + topic + ".csv")), topic);
    }
  }
  const Json& indexed = read["indexed"];
  EXPECT_EQ(indexed["statistics"]["messages"], 8240);
  EXPECT_EQ(indexed["statistics"]["channels"], 4);
  EXPECT_GT(indexed["chunks"], 1);
  EXPECT_EQ(indexed["statistics"]["chunks"], indexed["chunks"]);
  EXPECT_EQ(indexed["library"].get<std::string>().substr(0, 14), "armcmc-export ");
  EXPECT_EQ(indexed["schemas"]["EST_ESTIMATE"]["name"], "armcmc.estimate_t");
  EXPECT_EQ(indexed["schemas"]["EST_ESTIMATE"]["encoding"], "jsonschema");
  EXPECT_EQ(indexed["schemas"]["EST_ESTIMATE"]["message_encoding"], "json");
  EXPECT_EQ(indexed["schemas"]["PLANT_PACK"]["schema"]["properties"]["f"]["description"], "N");
}

}  // namespace
}  // namespace armcmc::log_export::mcap_reader_test
