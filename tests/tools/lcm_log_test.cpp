#include "armcmc/support/lcm_log.hpp"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <algorithm>
#include <fstream>
#include <lcm/lcm-cpp.hpp>
#include <string>
#include <vector>

#include "armcmc/support/program.hpp"
#include "support/paths.hpp"
#include "tools/file_text.hpp"

namespace armcmc::support::lcm_log_test {
namespace {

constexpr int kDataSize = 100;
constexpr std::size_t kEventSize = 28 + 4 + kDataSize;  // the channel is "PACK"

class LcmLog : public ::testing::Test {
 protected:
  /// A log of n events, written by the library; the data of event i are all i.
  void Write(int n) {
    lcm::LogFile log(path_, "w");
    for (int i = 0; i < n; ++i) {
      std::vector<char> data(kDataSize, static_cast<char>(i));
      lcm::LogEvent event{};
      event.timestamp = 1000 + i;
      event.channel = "PACK";
      event.datalen = kDataSize;
      event.data = data.data();
      ASSERT_EQ(log.writeEvent(&event), 0);
    }
  }
  std::string Bytes() const { return test::TextOf(path_); }
  void Put(const std::string& bytes) const { std::ofstream(path_, std::ios::binary) << bytes; }

  struct Result {
    std::vector<int> events;
    LcmLogDamage damage;
  };
  Result Read() const {
    Result result;
    LcmLogReader reader(path_);
    LcmLogEvent event;
    while (reader.Next(&event)) {
      EXPECT_EQ(event.channel, "PACK");
      EXPECT_EQ(event.data.size(), static_cast<std::size_t>(kDataSize));
      EXPECT_EQ(event.utime, 1000 + event.number);
      if (!event.data.empty()) {
        EXPECT_EQ(event.data.front(), event.number);
      }
      result.events.push_back(static_cast<int>(event.number));
    }
    result.damage = reader.damage();
    return result;
  }

  test::ScratchDir dir_;
  std::string path_ = dir_ / "run.lcm";
};

std::vector<int> AllBut(int n, std::vector<int> missing) {
  std::vector<int> numbers;
  for (int i = 0; i < n; ++i)
    if (std::find(missing.begin(), missing.end(), i) == missing.end()) numbers.push_back(i);
  return numbers;
}

TEST_F(LcmLog, ReadsWhatTheLibraryWrote) {
  Write(20);
  const Result r = Read();
  EXPECT_EQ(r.events, AllBut(20, {}));
  EXPECT_FALSE(r.damage.any());
}

TEST_F(LcmLog, AHalfWrittenLastEventIsLeftOutAndSaid) {
  Write(5);
  Put(Bytes().substr(0, 5 * kEventSize - 7));
  const Result r = Read();
  EXPECT_EQ(r.events, AllBut(5, {4}));
  EXPECT_TRUE(r.damage.cut_off);
}

TEST_F(LcmLog, ADamagedHeaderCostsItsEventAlone) {
  Write(10);
  std::string bytes = Bytes();
  bytes[3 * kEventSize] = 0;       // sync word
  bytes[6 * kEventSize + 20] = 1;  // channel length
  Put(bytes);
  const Result r = Read();
  EXPECT_EQ(r.events, AllBut(10, {3, 6}));
  EXPECT_EQ(r.damage.resyncs, 2u);
  EXPECT_EQ(r.damage.missing_events, 2);
}

TEST_F(LcmLog, ADamagedDataLengthDoesNotSwallowTheEventsBehindIt) {
  Write(10);
  std::string bytes = Bytes();
  bytes[3 * kEventSize + 26] = 2;  // 100 -> 612: four more events
  Put(bytes);
  Result r = Read();
  EXPECT_EQ(r.events, AllBut(10, {3}));
  EXPECT_EQ(r.damage.missing_events, 1);
  bytes[3 * kEventSize + 24] = 0x7f;  // two gigabytes: past the end of the file
  Put(bytes);
  r = Read();
  EXPECT_EQ(r.events, AllBut(10, {3}));
  EXPECT_FALSE(r.damage.cut_off);
}

TEST_F(LcmLog, JunkBetweenEventsIsSkipped) {
  Write(4);
  const std::string bytes = Bytes();
  Put("junk" + bytes.substr(0, 2 * kEventSize) + "more junk" + bytes.substr(2 * kEventSize));
  const Result r = Read();
  EXPECT_EQ(r.events, AllBut(4, {}));
  EXPECT_EQ(r.damage.resyncs, 2u);
  EXPECT_EQ(r.damage.skipped_bytes, 13u);
  EXPECT_EQ(r.damage.missing_events, 0);
}

TEST_F(LcmLog, ADamagedNumberCostsNothingAndIsCounted) {
  Write(10);
  std::string bytes = Bytes();
  bytes[3 * kEventSize + 4] = 0x40;  // highest byte
  bytes[6 * kEventSize + 11] ^= 1;   // lowest byte: 6 -> 7
  bytes[9 * kEventSize + 5] = 1;     // of the last event
  Put(bytes);
  const Result r = Read();
  EXPECT_EQ(r.events, AllBut(10, {}));
  EXPECT_EQ(r.damage.wrong_numbers, 3);
  EXPECT_EQ(r.damage.missing_events, 0);
  EXPECT_EQ(r.damage.resyncs, 0u);
}

TEST_F(LcmLog, TwoLogsInOneFileAreNoDamage) {
  Write(4);
  const std::string bytes = Bytes();
  Put(bytes + bytes);
  LcmLogReader reader(path_);
  LcmLogEvent event;
  int n = 0;
  while (reader.Next(&event)) ++n;
  EXPECT_EQ(n, 8);
  EXPECT_FALSE(reader.damage().any());
}

TEST_F(LcmLog, ACutAnywhereKeepsEveryEventInFrontOfIt) {
  Write(4);
  const std::string clean = Bytes();
  for (std::size_t size = kEventSize; size < clean.size(); ++size) {
    Put(clean.substr(0, size));
    const Result r = Read();
    EXPECT_EQ(r.events.size(), size / kEventSize) << size;
    EXPECT_EQ(r.damage.cut_off, size % kEventSize != 0) << size;
    EXPECT_EQ(r.damage.skipped_bytes, size % kEventSize) << size;
  }
}

// Sync word, number, time, both lengths, channel and data of one event, every bit of every byte.
TEST_F(LcmLog, EveryFlippedBitCostsAtMostItsEventAndTheLossIsCounted) {
  constexpr int kEvents = 6;
  Write(kEvents);
  const std::string clean = Bytes();
  for (std::size_t at = 2 * kEventSize; at < 3 * kEventSize; ++at) {
    for (const int bit : {0, 2, 5, 7}) {
      std::string bytes = clean;
      bytes[at] = static_cast<char>(static_cast<unsigned char>(bytes[at]) ^ (1U << bit));
      Put(bytes);
      LcmLogReader reader(path_);
      LcmLogEvent event;
      int n = 0;
      while (reader.Next(&event)) ++n;
      const LcmLogDamage& damage = reader.damage();
      EXPECT_GE(n, kEvents - 1) << at << ' ' << bit;
      EXPECT_EQ(n + damage.missing_events, kEvents) << at << ' ' << bit;
      EXPECT_LE(damage.skipped_bytes, kEventSize) << at << ' ' << bit;
      EXPECT_FALSE(damage.cut_off) << at << ' ' << bit;
      // Time, name and data have no check; the other fields have.
      const std::size_t field = at - 2 * kEventSize;
      EXPECT_EQ(damage.any(), field < 12 || (field >= 20 && field < 28) || n < kEvents) << at << ' ' << bit;
    }
  }
}

TEST_F(LcmLog, DamageIsSaidInWords) {
  EXPECT_EQ(ToString(LcmLogDamage{}), "");
  EXPECT_EQ(ToString(LcmLogDamage{2, 1310, 1, 3, true}),
            "2 places skipped (1310 bytes), 1 event missing, 3 events with a wrong number, cut off at its end");
  EXPECT_EQ(ToString(LcmLogDamage{0, 17, 0, 0, true}), "cut off at its end (17 bytes)");
}

TEST_F(LcmLog, ASyncWordInTheDataIsData) {
  {
    lcm::LogFile log(path_, "w");
    for (int i = 0; i < 3; ++i) {
      std::string data("x\xED\xA1\xDA\x01", 5);
      data.resize(65, '\0');
      lcm::LogEvent event{};
      event.channel = "PACK";
      event.datalen = static_cast<std::int32_t>(data.size());
      event.data = data.data();
      log.writeEvent(&event);
    }
  }
  LcmLogReader reader(path_);
  LcmLogEvent event;
  int n = 0;
  while (reader.Next(&event)) ++n;
  EXPECT_EQ(n, 3);
  EXPECT_FALSE(reader.damage().any());
}

TEST_F(LcmLog, FilesThatAreNoLogAreErrors) {
  Put("t,x,v,f\n0,1,2,3\n");
  EXPECT_THROW(LcmLogReader{path_}, InputError);
  Put("");
  EXPECT_THROW(LcmLogReader{path_}, InputError);
  EXPECT_THROW(LcmLogReader{dir_ / "none.lcm"}, InputError);
  EXPECT_THROW(LcmLogReader{dir_.path()}, InputError);
}

// Whatever happens to one byte, the reader ends, and loses no more than the event hit and the one before it.
TEST_F(LcmLog, OneDamagedByteCostsAtMostTwoEvents) {
  Write(12);
  const std::string clean = Bytes();
  EXPECT_TRUE(rc::check([&] {
    std::string bytes = clean;
    const auto at = *rc::gen::inRange<std::size_t>(0, bytes.size());
    bytes[at] = static_cast<char>(*rc::gen::inRange(0, 256));
    Put(bytes);
    LcmLogReader reader(path_);
    LcmLogEvent event;
    int n = 0;
    while (reader.Next(&event)) ++n;
    RC_ASSERT(n >= 10);
    RC_ASSERT(n <= 12);
  }));
}

TEST_F(LcmLog, AnyBytesAtAllAreReadToTheEnd) {
  EXPECT_TRUE(rc::check([&] {
    auto bytes =
        *rc::gen::container<std::string>(rc::gen::elementOf(std::string("\xED\xA1\xDA\x01\0\0\0\0\x01\x02P", 11)));
    Put(std::string("\xED\xA1\xDA\x01", 4) + bytes);
    LcmLogReader reader(path_);
    LcmLogEvent event;
    while (reader.Next(&event)) {
      RC_ASSERT(!event.channel.empty());
    }
    RC_ASSERT(reader.progress() == 1.0);
  }));
}

}  // namespace
}  // namespace armcmc::support::lcm_log_test
