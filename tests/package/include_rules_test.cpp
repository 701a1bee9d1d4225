#include "package/include_rules.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "support/paths.hpp"

namespace armcmc::test::include_rules_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

std::vector<std::string> Check(const std::string& file, const std::string& header) {
  return ForbiddenIncludes(file, "#pragma once\n#include " + header + "\n");
}

TEST(IncludeRules, AViolationIsNamedWithFileAndLine) {
  EXPECT_THAT(Check("core/src/sampler.cpp", "\"armcmc/rt/clock.hpp\""),
              ElementsAre(HasSubstr("core/src/sampler.cpp:2: armcmc/rt/clock.hpp belongs to rt")));
}

TEST(IncludeRules, CoreHasNoClockThreadInputOutputOrBus) {
  for (const char* header : {"<chrono>", "<thread>", "<iostream>", "<time.h>", "<unistd.h>", "<lcm/lcm-cpp.hpp>",
                             "\"armcmc/data_pack_t.hpp\"", "\"armcmc/support/csv.hpp\"", "<random>", "<fmt/core.h>"})
    EXPECT_THAT(Check("core/include/armcmc/x.hpp", header), SizeIs(1)) << header;
  for (const char* header : {"<vector>", "<Eigen/Core>", "\"armcmc/types.hpp\"", "\"armcmc/models/registry.hpp\"",
                             "<immintrin.h>", "\"local.hpp\""})
    EXPECT_THAT(Check("core/src/x.cpp", header), IsEmpty()) << header;
}

TEST(IncludeRules, TheRealTimeLibraryDoesNotUseWhatIsNotRealTime) {
  EXPECT_THAT(Check("rt/src/x.cpp", "\"armcmc/support/strict_toml.hpp\""), SizeIs(1));
  EXPECT_THAT(Check("rt/src/x.cpp", "<spdlog/spdlog.h>"), SizeIs(1));
  EXPECT_THAT(Check("rt/app/main.cpp", "\"armcmc/support/strict_toml.hpp\""), IsEmpty());
  EXPECT_THAT(Check("rt/src/x.cpp", "\"armcmc/estimator.hpp\""), IsEmpty());
  EXPECT_THAT(Check("rt/src/x.cpp", "<sys/mman.h>"), IsEmpty());
}

TEST(IncludeRules, ThePlantNeverSeesTheCore) {
  for (const char* file : {"plant_sim/src/x.cpp", "plant_sim/app/main.cpp", "plant_sim/include/armcmc/plant_sim/x.hpp"})
    for (const char* header : {"\"armcmc/types.hpp\"", "\"armcmc/models/registry.hpp\"", "\"armcmc/rt/clock.hpp\""})
      EXPECT_THAT(Check(file, header), SizeIs(1)) << file << " " << header;
  EXPECT_THAT(Check("plant_sim/app/main.cpp", "\"armcmc/support/estimator_config.hpp\""), SizeIs(1));
  EXPECT_THAT(Check("plant_sim/app/main.cpp", "\"armcmc/support/plant_file.hpp\""), SizeIs(1));
  EXPECT_THAT(Check("plant_sim/app/main.cpp", "\"armcmc/support/recording.hpp\""), IsEmpty());
  EXPECT_THAT(Check("plant_sim/src/x.cpp", "\"armcmc/data_pack_t.hpp\""), IsEmpty());
  EXPECT_THAT(Check("plant_sim/src/x.cpp", "\"armcmc/data_pack_v2_t.hpp\""), IsEmpty());
}

TEST(IncludeRules, PythonIsKnownToItsModuleOnlyWhichStandsOnCoreAndSupport) {
  EXPECT_THAT(Check("tools/python/src/x.cpp", "<pybind11/pybind11.h>"), IsEmpty());
  EXPECT_THAT(Check("tools/python/src/x.cpp", "\"armcmc/support/estimator_config.hpp\""), IsEmpty());
  EXPECT_THAT(Check("tools/python/src/x.cpp", "\"armcmc/rt/clock.hpp\""), SizeIs(1));
  EXPECT_THAT(Check("tools/python/src/x.cpp", "\"armcmc/replay/replay.hpp\""), SizeIs(1));
  for (const char* file : {"core/src/x.cpp", "rt/app/main.cpp", "tools/replay/src/x.cpp", "tools/support/src/x.cpp"})
    EXPECT_THAT(Check(file, "<pybind11/pybind11.h>"), SizeIs(1)) << file;
}

TEST(IncludeRules, NothingUsesTheTests) {
  for (const char* file : {"core/src/x.cpp", "rt/app/main.cpp", "tools/replay/app/main.cpp"}) {
    EXPECT_THAT(Check(file, "\"support/alloc_counter.hpp\""), SizeIs(1)) << file;
    EXPECT_THAT(Check(file, "<gtest/gtest.h>"), SizeIs(1)) << file;
  }
  EXPECT_THAT(Check("tests/core/x.cpp", "\"support/alloc_counter.hpp\""), IsEmpty());
}

TEST(IncludeRules, NobodyIncludesThroughAParentFolder) {
  EXPECT_THAT(Check("rt/app/main.cpp", "\"../../tests/support/paths.hpp\""), SizeIs(1));
}

TEST(IncludeRules, HoldForTheWholeTree) {
  int files = 0;
  for (const char* part : {"core", "rt", "lcm_types", "plant_sim", "tools", "tests"}) {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(SourceDir() / part)) {
      const std::string extension = entry.path().extension();
      if (extension != ".hpp" && extension != ".cpp" && extension != ".inl") continue;
      std::ifstream file(entry.path(), std::ios::binary);
      const std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
      const auto relative = std::filesystem::relative(entry.path(), SourceDir());
      for (const std::string& line : ForbiddenIncludes(relative, text)) ADD_FAILURE() << line;
      ++files;
    }
  }
  EXPECT_GT(files, 20);
}

}  // namespace
}  // namespace armcmc::test::include_rules_test
