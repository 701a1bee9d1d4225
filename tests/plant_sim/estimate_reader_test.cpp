#include "estimate_reader.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "armcmc/plant_sim/plant.hpp"

namespace armcmc::plant_sim::estimate_reader_test {
namespace {

estimate_t Message(const std::vector<std::string>& names) {
  estimate_t message{};
  message.seq = 5;
  message.known = 1;
  message.n_modes = 1;
  message.known_by_mode[0] = 1;
  message.n_params = static_cast<int>(names.size());
  for (std::size_t i = 0; i < names.size(); ++i) {
    std::memcpy(message.param_name[i], names[i].data(), names[i].size());
    message.ar_map_by_mode[0][i] = 10.0 + static_cast<double>(i);
    message.q025[i] = 20.0 + static_cast<double>(i);
    message.q975[i] = 30.0 + static_cast<double>(i);
  }
  return message;
}

const PlantFamily& HuntCrossley() { return *FindPlantFamily("hunt_crossley"); }

TEST(EstimateReader, FindsParametersByName) {
  const ReceivedEstimate estimate = ReadEstimate(HuntCrossley(), Message({"noise_std", "p", "K", "B"}), 0.7);
  EXPECT_EQ(estimate.seq, 5);
  EXPECT_EQ(estimate.arrival_s, 0.7);
  EXPECT_TRUE(estimate.known[0]);
  EXPECT_EQ(estimate.interval_mode, 0);
  EXPECT_EQ(estimate.theta[0][0], 12.0);
  EXPECT_EQ(estimate.theta[0][1], 13.0);
  EXPECT_EQ(estimate.theta[0][2], 11.0);
  EXPECT_EQ(estimate.lo[0], 22.0);
  EXPECT_EQ(estimate.hi[2], 31.0);
}

TEST(EstimateReader, KeepsTheContactEstimateInFreeMotion) {
  estimate_t message = Message({"K", "B", "p"});
  message.mode = 1;
  const ReceivedEstimate estimate = ReadEstimate(HuntCrossley(), message, 0.0);
  EXPECT_TRUE(estimate.known[0]);
  EXPECT_EQ(estimate.interval_mode, 0);
}

TEST(EstimateReader, TakesNothingFromAMessageThatLacksAParameterOrHoldsNaN) {
  EXPECT_FALSE(ReadEstimate(HuntCrossley(), Message({"K", "B"}), 0.0).known[0]);
  estimate_t message = Message({"K", "B", "p"});
  message.ar_map_by_mode[0][1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(ReadEstimate(HuntCrossley(), message, 0.0).known[0]);
  EXPECT_EQ(ReadEstimate(HuntCrossley(), message, 0.0).interval_mode, -1);
}

TEST(EstimateReader, SurvivesCountsOutOfRange) {
  estimate_t message = Message({"K", "B", "p"});
  message.n_params = 1'000'000;
  message.n_modes = -7;
  message.mode = -3;
  const ReceivedEstimate estimate = ReadEstimate(HuntCrossley(), message, 0.0);
  EXPECT_FALSE(estimate.known[0]);
  EXPECT_EQ(estimate.interval_mode, -1);
}

}  // namespace
}  // namespace armcmc::plant_sim::estimate_reader_test
