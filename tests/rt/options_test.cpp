#include "options.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "armcmc/plant/program.hpp"
#include "support/paths.hpp"

namespace armcmc::app::options_test {
namespace {

/// What Load() says of it; empty where it says nothing.
std::string Complaint(const Options& options) {
  try {
    (void)Load(options);
  } catch (const std::exception& error) {
    return error.what();
  }
  return "";
}

TEST(Options, OnePlantIsThatOfTheConfiguration) {
  Options options;
  options.model = {"hunt_crossley"};
  const Configuration configuration = Load(options);
  ASSERT_EQ(configuration.plants.size(), 1U);
  EXPECT_EQ(configuration.plants[0].prefix, "");
  EXPECT_EQ(configuration.plants[0].gap_log.directory, "gap_logs");
}

TEST(Options, SeveralPlantsHaveAModelAPrefixAndAFolderEach) {
  Options options;
  options.model = {"hunt_crossley", "soft_actuator", "hunt_crossley"};
  options.prefix = {"A_", "B_", "C_"};
  const Configuration configuration = Load(options);
  ASSERT_EQ(configuration.plants.size(), 3U);
  EXPECT_EQ(configuration.plants[0].estimator.model, "hunt_crossley");
  EXPECT_EQ(configuration.plants[1].estimator.model, "soft_actuator");
  EXPECT_EQ(configuration.plants[2].prefix, "C_");
  EXPECT_EQ(configuration.plants[1].gap_log.directory, "gap_logs/B_");
  options.model = {"servo_axis"};
  const test::ScratchDir folder;
  const std::string plain = folder / "plain.toml";
  std::ofstream(plain) << "schema = 1\n";
  options.config = {plain, plain};
  options.prefix = {"A_", "B_"};
  EXPECT_EQ(Load(options).plants[1].estimator.plant->info().name, "servo_axis") << "one model for both";
}

TEST(Options, SaysWhatDoesNotGoTogether) {
  Options options;
  options.model = {"hunt_crossley", "hunt_crossley"};
  EXPECT_NE(Complaint(options).find("two plants have the prefix \"\": give each one of its own, with --prefix"),
            std::string::npos)
      << Complaint(options);
  options.prefix = {"A_"};
  EXPECT_EQ(Complaint(options), "--prefix is given 1 times for 2 plants: give it once for each, in their order");
  options.prefix = {"A_", "B_"};
  options.report = {"a.json"};
  EXPECT_EQ(Complaint(options), "--report is given 1 times for 2 plants: give it once for each, in their order");
  options.report = {};
  EXPECT_EQ(Complaint(options), "");
  options.model.assign(17, "hunt_crossley");
  EXPECT_NE(Complaint(options).find("16 plants at most, not 17"), std::string::npos);
}

TEST(Options, PlantsOfOneProcessShareTimingAndBus) {
  const test::ScratchDir folder;
  const std::string slow = folder / "slow.toml";
  std::ofstream(slow) << "schema = 1\n[timing]\nperiod_ms = 200\n";
  Options options;
  options.model = {"servo_axis", "servo_axis"};
  const std::string plain = folder / "plain.toml";
  std::ofstream(plain) << "schema = 1\n";
  options.config = {plain, slow};
  options.prefix = {"A_", "B_"};
  EXPECT_NE(Complaint(options).find(slow +
                                    ": [timing], [rt] and the bus are those of all plants of a process, and "
                                    "differ from those of " +
                                    plain),
            std::string::npos)
      << Complaint(options);
}

}  // namespace
}  // namespace armcmc::app::options_test
