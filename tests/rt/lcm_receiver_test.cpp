#include "armcmc/rt/lcm_receiver.hpp"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "armcmc/rt/channel_filter.hpp"
#include "armcmc/rt/clock.hpp"
#include "armcmc/rt/lcm_publisher.hpp"
#include "armcmc/rt/pack_codec.hpp"
#include "armcmc/rt/pipeline.hpp"
#include "plants/hunt_crossley/model.hpp"
#include "support/paths.hpp"
#include "test_bus.hpp"
#include "test_packs.hpp"

namespace armcmc::rt::lcm_receiver_test {
namespace {

using test::kLong;

std::vector<std::uint8_t> Wire(std::uint32_t magic, const std::string& channel, std::size_t payload) {
  std::vector<std::uint8_t> bytes(8 + channel.size() + 1 + payload, 0);
  for (std::size_t i = 0; i < 4; ++i) bytes[i] = static_cast<std::uint8_t>(magic >> (24U - 8U * i));
  std::copy(channel.begin(), channel.end(), bytes.begin() + 8);
  return bytes;
}

TEST(ParseDatagram, TellsChannelsFragmentsAndJunkApart) {
  std::span<const std::uint8_t> payload;
  EXPECT_EQ(ParseDatagram(Wire(0x4c433032, "PACK", 5), "PACK", &payload), DatagramKind::kOurs);
  EXPECT_EQ(payload.size(), 5U);
  EXPECT_EQ(ParseDatagram(Wire(0x4c433032, "PACKS", 5), "PACK", &payload), DatagramKind::kForeign);
  EXPECT_EQ(ParseDatagram(Wire(0x4c433032, "PAC", 5), "PACK", &payload), DatagramKind::kForeign);
  EXPECT_EQ(ParseDatagram(Wire(0x4c433033, "PACK", 5), "PACK", &payload), DatagramKind::kFragment);
  EXPECT_EQ(ParseDatagram(Wire(0x12345678, "PACK", 5), "PACK", &payload), DatagramKind::kMalformed);
  EXPECT_EQ(ParseDatagram({}, "PACK", &payload), DatagramKind::kMalformed);
  auto unterminated = Wire(0x4c433032, "PACK", 0);
  unterminated.pop_back();
  EXPECT_EQ(ParseDatagram(unterminated, "PACK", &payload), DatagramKind::kMalformed);
  EXPECT_EQ(ParseDatagram(Wire(0x4c433032, "PACK", 0), "PACK", &payload), DatagramKind::kOurs);
  EXPECT_EQ(payload.size(), 0U);
}

class LcmReceiverTest : public ::testing::Test {
 protected:
  void SetUp() override {
    ARMCMC_REQUIRE_MULTICAST();
    receiver_ = std::make_unique<LcmReceiver>(ParseLcmUrl(bus_.url()), std::vector<std::string>{"PLANT_PACK"});
    peer_ = std::make_unique<test::Peer>(bus_.url());
  }

  void Publish(const char* channel, const std::vector<std::uint8_t>& bytes) { peer_->Publish(channel, bytes); }

  void SendRaw(const std::vector<std::uint8_t>& bytes, const char* group = nullptr) {
    const LcmUrl url = ParseLcmUrl(bus_.url());
    const int fd = socket(AF_INET, SOCK_DGRAM, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(url.port);
    address.sin_addr = url.group;
    if (group != nullptr) inet_pton(AF_INET, group, &address.sin_addr);
    const unsigned char ttl = 0;
    setsockopt(fd, IPPROTO_IP, IP_MULTICAST_TTL, &ttl, sizeof ttl);
    ASSERT_EQ(sendto(fd, bytes.data(), bytes.size(), 0, reinterpret_cast<const sockaddr*>(&address), sizeof address),
              static_cast<ssize_t>(bytes.size()));
    close(fd);
  }

  bool Receive(Datagram* datagram) {
    const Nanos end = MonotonicNow() + kLong;
    while (MonotonicNow() < end) {
      if (receiver_->TryReceive(datagram)) return true;
      if (!receiver_->WaitUntil(end)) return false;
    }
    return false;
  }

  armcmc::test::TestBus bus_;
  std::unique_ptr<LcmReceiver> receiver_;
  std::unique_ptr<test::Peer> peer_;
};

TEST_F(LcmReceiverTest, HearsAPackThatLiblcmPublished) {
  const Nanos before = MonotonicNow();
  Publish("PLANT_PACK", test::Encode(test::ValidPack(7)));
  Datagram datagram;
  ASSERT_TRUE(Receive(&datagram));
  PackCodec codec({HuntCrossley::kInfo.plant, 2});
  EXPECT_EQ(codec.Decode(datagram.payload), RejectCause::kNone);
  EXPECT_EQ(codec.seq(), 7);
  EXPECT_LE(datagram.arrival_ns, MonotonicNow());
  EXPECT_GE(datagram.arrival_ns, before - 10 * kNanosPerMilli) << "two clocks are compared: some slack";
}

TEST_F(LcmReceiverTest, SkipsAndCountsOtherChannelsFragmentsAndJunk) {
  Publish("EST_STATUS", {1, 2, 3});
  Publish("PLANT_PACK_2", {1, 2, 3});
  Publish("PLANT_PACK", std::vector<std::uint8_t>(150'000));  // three fragments
  SendRaw({1, 2, 3});
  Publish("PLANT_PACK", {42});
  Datagram datagram;
  ASSERT_TRUE(Receive(&datagram));
  ASSERT_EQ(datagram.payload.size(), 1U);
  EXPECT_EQ(datagram.payload[0], 42);
  EXPECT_EQ(receiver_->counts().foreign, 2);
  EXPECT_EQ(receiver_->counts().fragments, 3);
  EXPECT_EQ(receiver_->counts().malformed, 1);
}

TEST_F(LcmReceiverTest, DoesNotHearWhatItsOwnProcessPublishes) {
  for (const std::string own : {"EST_STATUS", "X_EST_POSTERIOR", "EST"}) {
    receiver_ = std::make_unique<LcmReceiver>(ParseLcmUrl(bus_.url()), std::vector<std::string>{"PLANT_PACK"},
                                              std::vector<std::string>{"ANOTHER_OWN", own});
    Publish(own.c_str(), {1, 2, 3});
    Publish(own.c_str(), {});
    SendRaw(Wire(0x4c433032, "ANOTHER_OWN", 100));
    // What resembles it is heard.
    Publish((own + "_2").c_str(), {1, 2, 3});
    Publish(own.substr(1).c_str(), {1, 2, 3});
    SendRaw(Wire(0x4c433033, own, 5));
    SendRaw(Wire(0x12345678, own, 5));
    auto unterminated = Wire(0x4c433032, own, 0);
    unterminated.pop_back();
    SendRaw(unterminated);
    SendRaw({1, 2, 3});
    SendRaw({});
    Publish("PLANT_PACK", {42});
    Datagram datagram;
    ASSERT_TRUE(Receive(&datagram)) << own;
    EXPECT_EQ(datagram.payload.size(), 1U);
    EXPECT_EQ(receiver_->counts().foreign, 2) << own;
    EXPECT_EQ(receiver_->counts().fragments, 1) << own;
    EXPECT_EQ(receiver_->counts().malformed, 4) << own;
  }
}

TEST(ChannelFilter, HasRoomForThePlantsOfOneProcess) {
  std::vector<std::string> channels;
  for (std::size_t i = 0; i < Pipeline::kMaxLanes; ++i)
    for (const std::string& channel : LcmPublisher::Channels("ARM_LEFT_JOINT_" + std::to_string(i) + '_'))
      channels.push_back(channel);
  const int fd = socket(AF_INET, SOCK_DGRAM, 0);
  EXPECT_TRUE(DropChannels(fd, channels));
  channels.resize(4096, "EST_STATUS");
  EXPECT_TRUE(FilterWithout(channels).empty());
  EXPECT_FALSE(DropChannels(fd, channels));
  close(fd);
}

TEST_F(LcmReceiverTest, DoesNotHearAnotherGroupOnTheSamePort) {
  SendRaw(Wire(0x4c433032, "PLANT_PACK", 9), "239.255.76.99");
  Publish("PLANT_PACK", {1});
  Datagram datagram;
  ASSERT_TRUE(Receive(&datagram));
  EXPECT_EQ(datagram.payload.size(), 1U);
}

TEST_F(LcmReceiverTest, ReturnsAtTheTimeWhenNothingComes) {
  EXPECT_FALSE(receiver_->WaitUntil(MonotonicNow() + kNanosPerMilli));
  EXPECT_FALSE(receiver_->WaitUntil(MonotonicNow() - kNanosPerSecond)) << "a time that has passed";
  Datagram datagram;
  EXPECT_FALSE(receiver_->TryReceive(&datagram));
}

TEST_F(LcmReceiverTest, IsWokenFromAnotherThread) {
  std::thread other([this] { receiver_->Wake(); });
  EXPECT_FALSE(receiver_->WaitUntil(MonotonicNow() + kLong));  // returns early, without a datagram
  other.join();
}

TEST_F(LcmReceiverTest, DrainThrowsAwayWhatIsQueued) {
  for (int i = 0; i < 10; ++i) Publish("PLANT_PACK", {1});
  receiver_->Drain();
  Datagram datagram;
  EXPECT_FALSE(receiver_->TryReceive(&datagram));
}

TEST_F(LcmReceiverTest, HoldsAHundredPacksThatNobodyReads) {
  if (receiver_->recv_buf_size() < 4'000'000) GTEST_SKIP() << "needs the right to a larger receive buffer";
  const auto bytes = test::Encode(test::ValidPack(1));
  for (int i = 0; i < 100; ++i) Publish("PLANT_PACK", bytes);
  Datagram datagram;
  int received = 0;
  while (receiver_->TryReceive(&datagram)) ++received;
  EXPECT_EQ(received, 100);
}

TEST(LcmReceiver, RefusesAChannelNameThatLcmWouldNotSend) {
  EXPECT_THROW(
      LcmReceiver(ParseLcmUrl("udpm://239.255.76.67:21000?ttl=0"), std::vector<std::string>{std::string(64, 'x')}),
      std::invalid_argument);
}

}  // namespace
}  // namespace armcmc::rt::lcm_receiver_test
