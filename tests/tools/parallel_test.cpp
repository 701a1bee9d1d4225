#include "armcmc/support/parallel.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cstddef>
#include <stdexcept>
#include <thread>
#include <vector>

namespace armcmc::support::parallel_test {
namespace {

TEST(InParallel, DoesEachPieceOnce) {
  for (const std::size_t count : {0U, 1U, 2U, 3U, 100U}) {
    std::vector<int> done(count, 0);
    InParallel(count, [&](std::size_t i) { ++done[i]; });
    EXPECT_EQ(done, std::vector<int>(count, 1));
  }
}

TEST(InParallel, WorkInsideOfWorkStaysOnItsThread) {
  std::atomic<int> elsewhere{0}, done{0};
  InParallel(4, [&](std::size_t) {
    const std::thread::id outer = std::this_thread::get_id();
    InParallel(50, [&](std::size_t) {
      std::this_thread::sleep_for(std::chrono::microseconds(100));  // time for another thread to come
      ++done;
      if (std::this_thread::get_id() != outer) ++elsewhere;
    });
  });
  EXPECT_EQ(done, 200);
  EXPECT_EQ(elsewhere, 0);
}

TEST(InParallel, ThrowsOnWhatItsWorkThrows) {
  for (int time = 0; time < 2; ++time)
    EXPECT_THROW(InParallel(20,
                            [](std::size_t i) {
                              if (i == 7) throw std::runtime_error("seven");
                            }),
                 std::runtime_error);
  // What was thrown ends nothing but the work it came from.
  std::atomic<int> done{0};
  InParallel(20, [&](std::size_t) { ++done; });
  EXPECT_EQ(done, 20);
}

}  // namespace
}  // namespace armcmc::support::parallel_test
