#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "support/paths.hpp"
#include "support/process.hpp"

namespace armcmc::test::docs_test {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

std::string TextOf(const fs::path& path) {
  std::ifstream in(path);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

TEST(Docs, ArePagesOfTheInstalledHeadersWithoutAWarning) {
  const fs::path settings = Program("x").parent_path().parent_path() / "Doxyfile.docs";
  if (!fs::exists("/usr/bin/doxygen") || !fs::exists(settings))
    GTEST_SKIP() << "needs doxygen: tools/install-dependencies --with docs, then configure again";
  const ScratchDir dir;
  const Outcome run = RunProgram("/bin/sh",
                                 {"-c", "cd '" + SourceDir().string() + "' && { cat '" + settings.string() +
                                            "'; echo 'OUTPUT_DIRECTORY = " + dir.path().string() + "'; } | doxygen -"},
                                 300s);
  EXPECT_EQ(run.code, 0);
  EXPECT_EQ(run.err, "");
  const fs::path html = dir.path() / "html";
  EXPECT_NE(TextOf(html / "index.html").find("The estimator in a loop of your own"), std::string::npos);
  const std::string estimator = TextOf(html / "classarmcmc_1_1Estimator.html");
  EXPECT_NE(estimator.find("Real time"), std::string::npos) << "@rt";
  EXPECT_EQ(estimator.find("ARMCMC_NONBLOCKING"), std::string::npos);
  EXPECT_TRUE(fs::exists(html / "classarmcmc_1_1rt_1_1Pipeline.html"));
  EXPECT_FALSE(fs::exists(html / "classarmcmc_1_1ModeSampler.html")) << "its header is not installed";
}

}  // namespace
}  // namespace armcmc::test::docs_test
