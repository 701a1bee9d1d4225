#include "armcmc/rt/lcm_url.hpp"

#include <arpa/inet.h>
#include <gtest/gtest.h>

#include <stdexcept>

namespace armcmc::rt::lcm_url_test {
namespace {

TEST(ParseLcmUrl, ReadsEveryPart) {
  const LcmUrl url = ParseLcmUrl("udpm://239.1.2.3:7700?ttl=1&recv_buf_size=100000");
  EXPECT_EQ(ntohl(url.group.s_addr), 0xEF010203U);
  EXPECT_EQ(url.port, 7700);
  EXPECT_EQ(url.ttl, 1);
  EXPECT_EQ(url.recv_buf_size, 100'000);
}

TEST(ParseLcmUrl, TakesTheDefaultsOfLcm) {
  const LcmUrl url = ParseLcmUrl("udpm://");
  EXPECT_EQ(ntohl(url.group.s_addr), 0xEFFF4C43U);  // 239.255.76.67
  EXPECT_EQ(url.port, 7667);
  EXPECT_EQ(url.ttl, 0);
}

TEST(ParseLcmUrl, SaysWhatIsWrong) {
  for (const char* bad : {"", "tcpq://127.0.0.1:7700", "udpm://10.0.0.1:7667", "udpm://239.255.76.67:0",
                          "udpm://239.255.76.67:70000", "udpm://239.255.76.67:76x", "udpm://239.255.76.67:7667?ttl=-1",
                          "udpm://239.255.76.67:7667?ttl", "udpm://239.255.76.67:7667?speed=1"}) {
    try {
      (void)ParseLcmUrl(bad);
      ADD_FAILURE() << bad << " was accepted";
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find("udpm://239.255.76.67:7667?ttl=0"), std::string::npos) << error.what();
    }
  }
}

TEST(MulticastRouteRemedy, NamesTheCommand) {
  EXPECT_NE(MulticastRouteRemedy(ParseLcmUrl("udpm://")).find("ip route add 224.0.0.0/4 dev lo"), std::string::npos);
}

}  // namespace
}  // namespace armcmc::rt::lcm_url_test
