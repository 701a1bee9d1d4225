#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <lcm/lcm-cpp.hpp>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "armcmc/estimate_t.hpp"
#include "armcmc/estimator_status_t.hpp"
#include "armcmc/log_export/log_export.hpp"
#include "armcmc/posterior_t.hpp"
#include "support/paths.hpp"
#include "support/process.hpp"
#include "tools/export/contact_estimate.hpp"
#include "tools/export/mcap_bytes.hpp"
#include "tools/file_text.hpp"
#include "tools/replay_data.hpp"

namespace armcmc::log_export::mcap_export_test {
namespace {

using mcap_bytes::Fields;
using mcap_bytes::McapMessageRead;
using mcap_bytes::RecordsOf;
using replay::ContactPack;
using replay::LogWriter;
using ::testing::HasSubstr;
using Json = nlohmann::json;

constexpr std::int64_t kStart = 1'700'000'000'000'000;  // us

template <typename Message>
void WriteAt(lcm::LogFile* log, std::int64_t utime, const std::string& channel, const Message& message) {
  std::vector<char> data(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(data.data(), 0, static_cast<int>(data.size()));
  lcm::LogEvent event{};
  event.timestamp = utime;
  event.channel = channel;
  event.datalen = static_cast<std::int32_t>(data.size());
  event.data = data.data();
  log->writeEvent(&event);
}

class McapExport : public ::testing::Test {
 protected:
  McapExport() {
    request_.log = dir_ / "run.lcm";
    request_.out = dir_ / "run.mcap";
    request_.format = ExportFormat::kMcap;
  }
  ExportSummary Export() {
    ExportSummary summary = ExportLog(request_, [](double) {});
    file_ = test::TextOf(request_.out);
    return summary;
  }
  [[nodiscard]] std::vector<McapMessageRead> Messages(const std::string& topic) const {
    std::vector<McapMessageRead> messages = mcap_bytes::MessagesOf(file_);
    std::erase_if(messages, [&](const McapMessageRead& m) { return m.topic != topic; });
    return messages;
  }
  /// By name.
  [[nodiscard]] std::map<std::string, Json> Schemas() const {
    std::map<std::string, Json> schemas;
    for (const auto& record : RecordsOf(file_)) {
      if (record.op != 0x03) continue;
      Fields fields(record.content);
      fields.Bytes(2);
      const std::string name(fields.Sized());
      EXPECT_EQ(fields.Sized(), "jsonschema");
      schemas[name] = Json::parse(fields.Sized());
    }
    return schemas;
  }
  test::Outcome Program(std::vector<std::string> more) {
    more.insert(more.begin(), {"--data", request_.log, "--format", "mcap"});
    return test::RunProgram(test::Program("armcmc-export"), more);
  }
  test::ScratchDir dir_;
  ExportRequest request_;
  std::string file_;
};

TEST_F(McapExport, NamesAreNestedAndUnitsStandInTheSchema) {
  {
    LogWriter log(request_.log);
    for (int k = 1; k <= 2; ++k) log.Write("EST_ESTIMATE", ContactEstimate(k));
  }
  EXPECT_EQ(Export().tables.at(0).rows, 2);
  const std::vector<McapMessageRead> messages = Messages("EST_ESTIMATE");
  ASSERT_EQ(messages.size(), 2u);
  const Json message = Json::parse(messages[1].data);
  EXPECT_EQ(message["seq"], 2);
  EXPECT_EQ(message["ar_map"]["K"].get<double>(), ContactEstimate(2).ar_map[0]) << "to the bit";
  EXPECT_EQ(message["ar_map"]["p"].get<double>(), ContactEstimate(2).ar_map[2]);
  EXPECT_EQ(message["ar_map"].size(), 3u) << "entries past n_params are left out";
  EXPECT_EQ(messages[1].sequence, 1u);
  ASSERT_EQ(Schemas().size(), 1u);
  const Json schema = Schemas().at("armcmc.estimate_t");
  EXPECT_EQ(schema["type"], "object");
  const Json map = schema["properties"]["ar_map"];
  EXPECT_EQ(map["type"], "object");
  EXPECT_EQ(map["properties"]["B"], Json::object({{"description", "N s m^-(p+1)"}, {"type", "number"}}));
  EXPECT_EQ(map["properties"]["p"], Json::object({{"type", "number"}}));
  EXPECT_EQ(schema["properties"]["utime"], Json::object({{"description", "us"}, {"type", "integer"}}));
}

TEST_F(McapExport, HistogramsAreArrays) {
  {
    LogWriter log(request_.log);
    log.Write("EST_ESTIMATE", ContactEstimate(1));
    posterior_t p{};
    p.plant_kind = 1, p.n_params = 3, p.n_bins = 4, p.known = 1, p.hi[1] = 4.0;
    p.density[1][3] = 0.75;
    log.Write("EST_POSTERIOR", p);
  }
  Export();
  const Json message = Json::parse(Messages("EST_POSTERIOR").at(0).data);
  EXPECT_EQ(message["density"]["B"], Json::parse("[0, 0, 0, 0.75]"));
  EXPECT_EQ(message["hi"]["B"], 4.0);
  EXPECT_EQ(
      Schemas().at("armcmc.posterior_t")["properties"]["density"]["properties"]["B"],
      Json::object(
          {{"type", "array"}, {"description", "(N s m^-(p+1))^-1"}, {"items", Json::object({{"type", "number"}})}}));
}

TEST_F(McapExport, WhatIsNotFiniteIsNullAndTextIsText) {
  {
    LogWriter log(request_.log);
    estimate_t e = ContactEstimate(1);
    e.zeta = std::numeric_limits<double>::infinity();
    e.ar_map[1] = std::numeric_limits<double>::quiet_NaN();
    log.Write("EST_ESTIMATE", e);
    estimator_status_t s{};
    std::memcpy(s.gap_where, "v < \"0\"\\", 8);
    log.Write("EST_STATUS", s);
  }
  Export();
  const Json message = Json::parse(Messages("EST_ESTIMATE").at(0).data);
  EXPECT_TRUE(message["zeta"].is_null());
  EXPECT_TRUE(message["ar_map"]["B"].is_null());
  EXPECT_TRUE(message["ar_map"]["K"].is_number());
  EXPECT_EQ(Json::parse(Messages("EST_STATUS").at(0).data)["gap_where"], "v < \"0\"\\");
  EXPECT_EQ(Schemas().at("armcmc.estimator_status_t")["properties"]["gap_where"]["type"], "string");
}

TEST_F(McapExport, TimesAreThoseOfTheLogAndOfTheMessageWhereTheyAgree) {
  {
    lcm::LogFile log(request_.log, "w");
    estimate_t e = ContactEstimate(1);
    e.utime = kStart - 1'234;
    WriteAt(&log, kStart, "EST_ESTIMATE", e);
    e.utime = 0;  // does not say
    WriteAt(&log, kStart + 100'000, "EST_ESTIMATE", e);
    e.utime = kStart - 5'000'000;  // played and recorded again
    WriteAt(&log, kStart + 200'000, "EST_ESTIMATE", e);
  }
  Export();
  const std::vector<McapMessageRead> m = Messages("EST_ESTIMATE");
  ASSERT_EQ(m.size(), 3u);
  EXPECT_EQ(m[0].log_time, 1'700'000'000'000'000'000u);
  EXPECT_EQ(m[0].publish_time, 1'699'999'999'998'766'000u);
  EXPECT_EQ(m[1].log_time, 1'700'000'000'100'000'000u);
  EXPECT_EQ(m[1].publish_time, m[1].log_time);
  EXPECT_EQ(m[2].publish_time, m[2].log_time);
}

TEST_F(McapExport, SamplesHaveAMessageAndATimeEach) {
  {
    lcm::LogFile log(request_.log, "w");
    for (int k = 1; k <= 2; ++k) WriteAt(&log, kStart + k * 100'000, "PLANT_PACK", ContactPack(k));
  }
  EXPECT_EQ(Export().tables.at(0).rows, 200);
  const std::vector<McapMessageRead> m = Messages("PLANT_PACK");
  ASSERT_EQ(m.size(), 200u);
  EXPECT_EQ(m[99].log_time, 1'700'000'000'100'000'000u) << "the last sample of the first pack, when it came";
  for (std::size_t i = 1; i < m.size(); ++i)
    EXPECT_NEAR(static_cast<double>(m[i].log_time - m[i - 1].log_time), 1e6, 2) << i;
  EXPECT_EQ(m[150].publish_time, m[150].log_time);
  const Json row = Json::parse(m[150].data);
  EXPECT_EQ(row["x"].get<double>(), replay::ContactAt(151).x);
  EXPECT_EQ(row["f"].get<double>(), replay::ContactAt(151).f);
  EXPECT_EQ(row["seq"], 2);
}

TEST_F(McapExport, ThereIsNoTimeBeforeZero) {
  {
    LogWriter log(request_.log);  // its clock begins with zero, and the samples of its first pack before
    log.Write("PLANT_PACK", ContactPack(1));
  }
  Export();
  EXPECT_EQ(Messages("PLANT_PACK").front().log_time, 0u);
  EXPECT_EQ(Messages("PLANT_PACK").back().log_time, 1'000u);
}

TEST_F(McapExport, PlantsShareSchemasUnlessTheyDiffer) {
  {
    LogWriter log(request_.log);
    log.Write("A_EST_ESTIMATE", ContactEstimate(1));
    log.Write("B_EST_ESTIMATE", ContactEstimate(1));
    estimate_t other = ContactEstimate(1);
    std::memcpy(other.param_name[0], "k0", 2);
    log.Write("C_EST_ESTIMATE", other);
  }
  Export();
  const std::map<std::string, Json> schemas = Schemas();
  ASSERT_EQ(schemas.size(), 2u);
  EXPECT_TRUE(schemas.at("armcmc.estimate_t")["properties"]["ar_map"]["properties"].contains("K"));
  EXPECT_TRUE(schemas.at("armcmc.estimate_t.C_EST_ESTIMATE")["properties"]["ar_map"]["properties"].contains("k0"));
  EXPECT_TRUE(Json::parse(Messages("C_EST_ESTIMATE").at(0).data)["ar_map"].contains("k0"));
}

TEST_F(McapExport, ForeignChannelsAndDamageAreCountedAndSaid) {
  {
    LogWriter log(request_.log);
    log.Write("PLANT_PACK", ContactPack(1));
    log.Write("PLANT_PACK", ContactEstimate(1));  // another type on our channel
    log.WriteRaw("CAMERA", "no type of ours");
    log.Write("EST_ESTIMATE", ContactEstimate(2));
  }
  const std::string bytes = test::TextOf(request_.log);
  std::ofstream(request_.log, std::ios::binary) << bytes.substr(0, bytes.size() - 10);
  const test::Outcome o = Program({"--out", request_.out});
  ASSERT_EQ(o.code, 0) << o.err;
  EXPECT_THAT(o.out, HasSubstr("foreign: CAMERA, 1 events of type 6e6f207479706520"));
  EXPECT_THAT(o.out, HasSubstr("the log is damaged: cut off at its end"));
  file_ = test::TextOf(request_.out);
  EXPECT_EQ(mcap_bytes::MessagesOf(file_).size(), 100u);
}

TEST_F(McapExport, BadRequestsAreOneLineAndLeaveNothingBehind) {
  {
    LogWriter log(request_.log);
    log.Write("PLANT_PACK", ContactPack(1));
  }
  const std::string log = test::TextOf(request_.log);
  const auto error_of = [&](const std::vector<std::string>& more) {
    const test::Outcome o = Program(more);
    EXPECT_EQ(o.code, 2);
    EXPECT_EQ(std::count(o.err.begin(), o.err.end(), '\n'), 1) << o.err;
    return o.err;
  };
  EXPECT_THAT(error_of({"--out", dir_.path()}), HasSubstr("is a folder, expected the name of the MCAP file to write"));
  EXPECT_THAT(error_of({"--out", request_.log}), HasSubstr("run.lcm: is the log itself"));
  EXPECT_THAT(error_of({"--out", request_.out, "--histograms", "long"}), HasSubstr("--histograms long"));
  EXPECT_THAT(error_of({"--out", request_.out, "--channels", "EST_ESTIMATE"}), HasSubstr("it has PLANT_PACK"));
  EXPECT_EQ(test::TextOf(request_.log), log);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(dir_.path()), {}), 1) << "the log alone";
}

}  // namespace
}  // namespace armcmc::log_export::mcap_export_test
