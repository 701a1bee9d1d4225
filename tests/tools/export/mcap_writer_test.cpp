#include "armcmc/log_export/mcap_writer.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "armcmc/support/program.hpp"
#include "support/paths.hpp"
#include "tools/export/mcap_bytes.hpp"
#include "tools/file_text.hpp"

// Record layouts as the specification has them: https://mcap.dev/spec.
namespace armcmc::log_export::mcap_writer_test {
namespace {

using mcap_bytes::Fields;
using mcap_bytes::kMagicSize;
using mcap_bytes::McapRecord;
using mcap_bytes::RecordsOf;
using ::testing::ElementsAre;

constexpr std::uint8_t kHeader = 0x01, kFooter = 0x02, kSchema = 0x03, kChannel = 0x04, kMessage = 0x05, kChunk = 0x06,
                       kMessageIndex = 0x07, kChunkIndex = 0x08, kStatistics = 0x0B, kSummaryOffset = 0x0E,
                       kDataEnd = 0x0F;

std::vector<std::uint8_t> Ops(const std::vector<McapRecord>& records) {
  std::vector<std::uint8_t> ops;
  ops.reserve(records.size());
  for (const McapRecord& record : records) ops.push_back(record.op);
  return ops;
}

class Mcap : public ::testing::Test {
 protected:
  /// Two channels of one schema; messages of 100 bytes, alternating, each 10 ns later than the one before but for the
  /// last, which is the earliest.
  void WriteFile(int messages, std::size_t chunk_bytes) {
    McapWriter writer(path_, "a library", chunk_bytes);
    const std::uint16_t schema = writer.AddSchema("a name", "jsonschema", "{}");
    EXPECT_EQ(schema, 1) << "zero means: without a schema";
    EXPECT_EQ(writer.AddChannel(schema, "one", "json"), 0);
    EXPECT_EQ(writer.AddChannel(schema, "two", "json"), 1);
    for (int i = 0; i < messages; ++i) {
      McapMessage message;
      message.channel = static_cast<std::uint16_t>(i % 2);
      message.sequence = static_cast<std::uint32_t>(i);
      message.log_time_ns = i + 1 == messages ? 500 : 1000 + 10 * static_cast<std::uint64_t>(i);
      message.publish_time_ns = 7;
      const std::string data(100, static_cast<char>('a' + i));
      message.data = data;
      writer.Write(message);
    }
    writer.Close();
    file_ = test::TextOf(path_);
  }
  [[nodiscard]] McapRecord Footer() const {
    constexpr std::size_t kFooterSize = 1 + 8 + 8 + 8 + 4;
    return RecordsOf(file_, file_.size() - kMagicSize - kFooterSize, file_.size() - kMagicSize).at(0);
  }
  [[nodiscard]] std::string_view Part(std::size_t from, std::size_t until) const {
    return std::string_view(file_).substr(from, until - from);
  }
  test::ScratchDir dir_;
  std::filesystem::path path_ = dir_ / "a.mcap";
  std::string file_;
};

TEST(Crc32, IsTheOneOfZlib) {
  EXPECT_EQ(Crc32("123456789"), 0xCBF43926U) << "the check value of CRC-32/ISO-HDLC";
  EXPECT_EQ(Crc32(""), 0U);
  EXPECT_EQ(Crc32("6789", Crc32("12345")), 0xCBF43926U) << "continued";
}

TEST_F(Mcap, BeginsAndEndsWithTheMagicAndHasItsRecordsInOrder) {
  WriteFile(3, 1U << 20U);
  const std::string magic = "\x89MCAP0\r\n";
  EXPECT_EQ(file_.substr(0, 8), magic);
  EXPECT_EQ(file_.substr(file_.size() - 8), magic);
  EXPECT_THAT(Ops(RecordsOf(file_)),
              ElementsAre(kHeader, kSchema, kChannel, kChannel, kChunk, kMessageIndex, kMessageIndex, kDataEnd, kSchema,
                          kChannel, kChannel, kStatistics, kChunkIndex, kSummaryOffset, kSummaryOffset, kSummaryOffset,
                          kSummaryOffset, kFooter));
  Fields header(RecordsOf(file_).front().content);
  EXPECT_EQ(header.Sized(), "");
  EXPECT_EQ(header.Sized(), "a library");
  EXPECT_TRUE(header.done());
}

TEST_F(Mcap, SchemasAndChannelsSayWhatWasAdded) {
  WriteFile(1, 1U << 20U);
  const std::vector<McapRecord> records = RecordsOf(file_);
  Fields schema(records.at(1).content);
  EXPECT_EQ(schema.Take<std::uint16_t>(), 1);
  EXPECT_EQ(schema.Sized(), "a name");
  EXPECT_EQ(schema.Sized(), "jsonschema");
  EXPECT_EQ(schema.Sized(), "{}");
  EXPECT_TRUE(schema.done());
  Fields channel(records.at(3).content);
  EXPECT_EQ(channel.Take<std::uint16_t>(), 1);
  EXPECT_EQ(channel.Take<std::uint16_t>(), 1);
  EXPECT_EQ(channel.Sized(), "two");
  EXPECT_EQ(channel.Sized(), "json");
  EXPECT_EQ(channel.Sized(), "");
  EXPECT_TRUE(channel.done());
}

TEST_F(Mcap, ChecksumsCoverDataChunkAndSummary) {
  WriteFile(5, 250);
  for (const McapRecord& record : RecordsOf(file_)) {
    Fields fields(record.content);
    if (record.op == kDataEnd) {
      EXPECT_EQ(fields.Take<std::uint32_t>(), Crc32(Part(0, record.at)));
      EXPECT_TRUE(fields.done());
    }
    if (record.op == kChunk) {
      fields.Bytes(24);
      const auto crc = fields.Take<std::uint32_t>();
      fields.Sized();
      EXPECT_EQ(crc, Crc32(fields.Bytes(fields.Take<std::uint64_t>())));
      EXPECT_TRUE(fields.done());
    }
  }
  Fields footer(Footer().content);
  const auto summary_start = footer.Take<std::uint64_t>();
  footer.Take<std::uint64_t>();
  EXPECT_EQ(footer.Take<std::uint32_t>(), Crc32(Part(summary_start, file_.size() - kMagicSize - 4)));
}

TEST_F(Mcap, TheSummaryIsFoundFromTheFooterAndItsGroupsFromTheirOffsets) {
  WriteFile(5, 250);
  ASSERT_EQ(Footer().op, kFooter);
  Fields footer(Footer().content);
  const auto summary_start = footer.Take<std::uint64_t>(), offsets_start = footer.Take<std::uint64_t>();
  EXPECT_THAT(Ops(RecordsOf(file_, summary_start, offsets_start)),
              ElementsAre(kSchema, kChannel, kChannel, kStatistics, kChunkIndex, kChunkIndex, kChunkIndex));
  std::map<std::uint8_t, std::size_t> members;
  std::uint64_t next = summary_start;
  for (const McapRecord& record : RecordsOf(file_, offsets_start, Footer().at)) {
    Fields offset(record.content);
    const auto op = offset.Take<std::uint8_t>();
    const auto start = offset.Take<std::uint64_t>(), length = offset.Take<std::uint64_t>();
    EXPECT_EQ(start, next) << "groups have no gaps";
    next = start + length;
    for (const McapRecord& member : RecordsOf(file_, start, start + length)) {
      EXPECT_EQ(member.op, op);
      ++members[op];
    }
  }
  EXPECT_EQ(next, offsets_start);
  EXPECT_EQ(members,
            (std::map<std::uint8_t, std::size_t>{{kSchema, 1}, {kChannel, 2}, {kStatistics, 1}, {kChunkIndex, 3}}));
}

TEST_F(Mcap, EveryMessageIsFoundThroughTheIndexOfItsChunk) {
  WriteFile(5, 250);  // two messages of 131 bytes fill a chunk
  std::vector<std::string> found;
  std::vector<std::uint64_t> first_times, last_times;
  for (const McapRecord& record : RecordsOf(file_)) {
    if (record.op != kChunkIndex) continue;
    Fields index(record.content);
    first_times.push_back(index.Take<std::uint64_t>());
    last_times.push_back(index.Take<std::uint64_t>());
    const auto start = index.Take<std::uint64_t>(), length = index.Take<std::uint64_t>();
    const McapRecord chunk = RecordsOf(file_, start, start + length).at(0);
    ASSERT_EQ(chunk.op, kChunk);
    Fields fields(chunk.content);
    EXPECT_EQ(fields.Take<std::uint64_t>(), first_times.back());
    EXPECT_EQ(fields.Take<std::uint64_t>(), last_times.back());
    const auto size = fields.Take<std::uint64_t>();
    fields.Bytes(4);
    fields.Sized();
    const std::string_view records = fields.Bytes(fields.Take<std::uint64_t>());
    EXPECT_EQ(records.size(), size);
    Fields places(index.Sized());
    const auto indexes_length = index.Take<std::uint64_t>();
    EXPECT_EQ(RecordsOf(file_, start + length, start + length + indexes_length).back().op, kMessageIndex);
    EXPECT_EQ(index.Sized(), "");
    EXPECT_EQ(index.Take<std::uint64_t>(), size);
    EXPECT_EQ(index.Take<std::uint64_t>(), size);
    EXPECT_TRUE(index.done());
    while (!places.done()) {
      const auto channel = places.Take<std::uint16_t>();
      const auto at = places.Take<std::uint64_t>();
      const McapRecord place = RecordsOf(file_, at, start + length + indexes_length).at(0);
      ASSERT_EQ(place.op, kMessageIndex);
      Fields entries(place.content);
      EXPECT_EQ(entries.Take<std::uint16_t>(), channel);
      Fields list(entries.Sized());
      while (!list.done()) {
        const auto time = list.Take<std::uint64_t>(), offset = list.Take<std::uint64_t>();
        const McapRecord message = RecordsOf(records, offset, records.size()).at(0);
        ASSERT_EQ(message.op, kMessage);
        Fields m(message.content);
        EXPECT_EQ(m.Take<std::uint16_t>(), channel);
        const auto sequence = m.Take<std::uint32_t>();
        EXPECT_EQ(m.Take<std::uint64_t>(), time);
        EXPECT_EQ(m.Take<std::uint64_t>(), 7U);
        EXPECT_EQ(m.rest(), std::string(100, static_cast<char>('a' + sequence)));
        found.push_back(std::to_string(sequence) + "@" + std::to_string(time));
      }
    }
  }
  EXPECT_THAT(found, ElementsAre("0@1000", "1@1010", "2@1020", "3@1030", "4@500"));
  EXPECT_THAT(first_times, ElementsAre(1000, 1020, 500));
  EXPECT_THAT(last_times, ElementsAre(1010, 1030, 500));
}

TEST_F(Mcap, StatisticsCountEverything) {
  WriteFile(5, 250);
  for (const McapRecord& record : RecordsOf(file_)) {
    if (record.op != kStatistics) continue;
    Fields s(record.content);
    EXPECT_EQ(s.Take<std::uint64_t>(), 5U) << "messages";
    EXPECT_EQ(s.Take<std::uint16_t>(), 1) << "schemas";
    EXPECT_EQ(s.Take<std::uint32_t>(), 2U) << "channels";
    EXPECT_EQ(s.Take<std::uint32_t>(), 0U) << "attachments";
    EXPECT_EQ(s.Take<std::uint32_t>(), 0U) << "metadata";
    EXPECT_EQ(s.Take<std::uint32_t>(), 3U) << "chunks";
    EXPECT_EQ(s.Take<std::uint64_t>(), 500U) << "the earliest, although it was the last";
    EXPECT_EQ(s.Take<std::uint64_t>(), 1030U);
    Fields counts(s.Sized());
    EXPECT_TRUE(s.done());
    std::map<std::uint16_t, std::uint64_t> by_channel;
    while (!counts.done()) {
      const auto channel = counts.Take<std::uint16_t>();
      by_channel[channel] = counts.Take<std::uint64_t>();
    }
    EXPECT_EQ(by_channel, (std::map<std::uint16_t, std::uint64_t>{{0, 3}, {1, 2}}));
    return;
  }
  ADD_FAILURE() << "no statistics";
}

TEST_F(Mcap, AFileWithoutMessagesIsComplete) {
  WriteFile(0, 250);
  EXPECT_THAT(Ops(RecordsOf(file_)),
              ElementsAre(kHeader, kSchema, kChannel, kChannel, kDataEnd, kSchema, kChannel, kChannel, kStatistics,
                          kSummaryOffset, kSummaryOffset, kSummaryOffset, kFooter));
}

TEST_F(Mcap, AFileThatCannotBeWrittenIsSaid) {
  EXPECT_THROW(McapWriter(dir_ / "none/a.mcap", "a library"), support::InputError);
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "needs /dev/full";
  McapWriter writer("/dev/full", "a library");
  EXPECT_THROW(writer.Close(), std::runtime_error);
}

}  // namespace
}  // namespace armcmc::log_export::mcap_writer_test
