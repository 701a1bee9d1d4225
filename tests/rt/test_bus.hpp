#pragma once

#include <gtest/gtest.h>
#include <lcm/lcm.h>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "armcmc/rt/clock.hpp"

namespace armcmc::rt::test {

inline constexpr Nanos kLong = 20 * kNanosPerSecond;  ///< A bound for a hung test, never reached otherwise.

/// Another program on the bus, which sends through liblcm.
class Peer {
 public:
  explicit Peer(const std::string& url) : lcm_(lcm_create(url.c_str()), &lcm_destroy) { EXPECT_NE(lcm_, nullptr); }

  void Publish(const std::string& channel, const std::vector<std::uint8_t>& bytes) {
    ASSERT_EQ(lcm_publish(lcm_.get(), channel.c_str(), bytes.data(), static_cast<unsigned>(bytes.size())), 0);
  }

 private:
  std::unique_ptr<lcm_t, decltype(&lcm_destroy)> lcm_;
};

}  // namespace armcmc::rt::test
