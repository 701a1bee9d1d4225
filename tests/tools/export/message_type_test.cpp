#include "armcmc/log_export/message_type.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>

#include "armcmc/change_t.hpp"
#include "armcmc/data_pack_t.hpp"
#include "armcmc/data_pack_v2_t.hpp"
#include "armcmc/estimate_t.hpp"
#include "armcmc/estimator_status_t.hpp"
#include "armcmc/plant_truth_t.hpp"
#include "armcmc/posterior_t.hpp"
#include "armcmc/support/program.hpp"

namespace armcmc::log_export::message_type_test {
namespace {

using ::testing::HasSubstr;

template <typename Message>
std::vector<std::uint8_t> Encoded(const Message& message) {
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return bytes;
}

/// The type of a message of the generated code as the .lcm text has it.
template <typename Message>
const MessageType* Described() {
  const MessageType* type = TypeOf(Encoded(Message{}));
  return type != nullptr && type->fingerprint == Message::getHash() ? type : nullptr;
}

TEST(MessageType, HasTheFingerprintAndLengthOfTheGeneratedCode) {
  ASSERT_NE(Described<data_pack_t>(), nullptr);
  ASSERT_NE(Described<data_pack_v2_t>(), nullptr);
  ASSERT_NE(Described<plant_truth_t>(), nullptr);
  ASSERT_NE(Described<estimate_t>(), nullptr);
  ASSERT_NE(Described<posterior_t>(), nullptr);
  ASSERT_NE(Described<estimator_status_t>(), nullptr);
  ASSERT_NE(Described<change_t>(), nullptr);
  EXPECT_EQ(Described<estimate_t>()->name, "estimate_t");
}

// Somebody has logs of these. A type that has been released is not changed: the new struct gets a new name and a new
// channel, and stands here beside the old one (lcm_types/EVOLUTION.md).
TEST(MessageType, ReleasedFingerprintsAreFrozen) {
  const std::vector<std::pair<std::string, std::uint64_t>> frozen = {
      {"data_pack_t", 0x6715710721d2cf1f},   {"data_pack_v2_t", 0x342b43e393235195},
      {"plant_truth_t", 0x7391ea7e8be666ff}, {"estimate_t", 0x2d3f65e4c6443a48},
      {"posterior_t", 0x75343c9a3bfc7fd5},   {"estimator_status_t", 0xa10c28116c506211},
      {"change_t", 0x3f008f8e3cf48f9a},
  };
  for (const auto& [name, fingerprint] : frozen) {
    bool found = false;
    for (const MessageType& type : ReleasedTypes()) {
      if (type.name != name) continue;
      found = true;
      EXPECT_EQ(static_cast<std::uint64_t>(type.fingerprint), fingerprint)
          << name << " has been released and may not change: logs of it would become unreadable. Give the new struct "
          << "a new name and a new channel; see lcm_types/EVOLUTION.md";
    }
    EXPECT_TRUE(found) << name << " has been released: its .lcm file must stay";
  }
  EXPECT_EQ(ReleasedTypes().size(), frozen.size()) << "a new type belongs into this list once it is released";
}

TEST(MessageType, ReadsNumbersAndTextsWhereTheGeneratedCodePutThem) {
  estimate_t message{};
  message.seq = -7;
  message.run_id = (std::int64_t{1} << 60) + 1;
  message.n_params = 3;
  message.in_contact = -1;
  message.ar_map_by_mode[2][5] = 6.25;
  message.draws_by_mode[3] = 14'979;
  message.y_rmse = 0.125;
  std::memcpy(message.param_name[1], "B", 1);
  std::memcpy(message.param_unit[1], "N s/m\x01", 6);
  const auto bytes = Encoded(message);
  const MessageType& type = *TypeOf(bytes);
  EXPECT_EQ(IntegerAt(bytes, *type.Find("seq"), 0), -7);
  EXPECT_EQ(IntegerAt(bytes, *type.Find("run_id"), 0), (std::int64_t{1} << 60) + 1);
  EXPECT_EQ(NumberAt(bytes, *type.Find("n_params"), 0), 3.0);
  EXPECT_EQ(NumberAt(bytes, *type.Find("in_contact"), 0), -1.0);
  EXPECT_EQ(NumberAt(bytes, *type.Find("ar_map_by_mode"), 2 * 8 + 5), 6.25);
  EXPECT_EQ(NumberAt(bytes, *type.Find("draws_by_mode"), 3), 14'979.0);
  EXPECT_EQ(NumberAt(bytes, *type.Find("y_rmse"), 0), 0.125);
  EXPECT_EQ(TextAt(bytes, *type.Find("param_name"), 1), "B");
  EXPECT_EQ(TextAt(bytes, *type.Find("param_unit"), 1), "N s/m?");
  EXPECT_EQ(type.Find("none"), nullptr);
}

TEST(MessageType, AnotherFingerprintOrLengthIsNoneOfOurs) {
  auto bytes = Encoded(data_pack_t{});
  bytes.pop_back();
  EXPECT_EQ(TypeOf(bytes), nullptr);
  bytes = Encoded(data_pack_t{});
  bytes[3] ^= 1;
  EXPECT_EQ(TypeOf(bytes), nullptr);
  bytes.resize(5);
  EXPECT_EQ(TypeOf(bytes), nullptr);
}

// As lcm-gen has it: names, types and dimensions of the members count, the struct's name, comments and constants do
// not.
TEST(MessageType, TheFingerprintSeesMembersOnly) {
  const auto of = [](const char* text) { return ParseMessageTypes(text).at(0).fingerprint; };
  const auto base = of("package a; struct s_t { int32_t n; double y[3]; }");
  EXPECT_EQ(of("package b; struct r_t { const int32_t N = 3, M = 4; // said\n int32_t n; double y[3]; }"), base);
  EXPECT_NE(of("struct s_t { int32_t m; double y[3]; }"), base);
  EXPECT_NE(of("struct s_t { int64_t n; double y[3]; }"), base);
  EXPECT_NE(of("struct s_t { int32_t n; double y[4]; }"), base);
  EXPECT_NE(of("struct s_t { double y[3]; int32_t n; }"), base);
}

TEST(MessageType, TextThatIsNotReadIsAnErrorWithItsLine) {
  const auto error = [](const char* text) -> std::string {
    try {
      (void)ParseMessageTypes(text);
    } catch (const support::InputError& e) {
      return e.what();
    }
    return "no error";
  };
  EXPECT_THAT(error("struct a_t {\n string s;\n}"), HasSubstr("line 2: type string"));
  EXPECT_THAT(error("struct a_t { int32_t n; double y[n]; }"), HasSubstr("fixed size"));
  EXPECT_THAT(error("struct a_t { int32_t n;"), HasSubstr("expected }"));
  EXPECT_THAT(error("enum e { A }"), HasSubstr("expected struct"));
}

}  // namespace
}  // namespace armcmc::log_export::message_type_test
