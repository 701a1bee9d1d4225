#include "armcmc/support/program.hpp"

#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <stdexcept>
#include <string>
#include <vector>

#include "armcmc/support/strict_toml.hpp"

namespace armcmc::support::program_test {
namespace {

struct Outcome {
  int code;
  std::string out, err;
};

Outcome RunWith(std::vector<std::string> arguments, const std::function<int()>& body) {
  CLI::App app{"A program."};
  std::string file;
  app.add_option("--file", file, "A file")->required();
  arguments.insert(arguments.begin(), "prog");
  std::vector<char*> argv;
  for (std::string& argument : arguments) argv.push_back(argument.data());
  ::testing::internal::CaptureStdout();
  ::testing::internal::CaptureStderr();
  const int code = RunProgram(app, "prog", static_cast<int>(argv.size()), argv.data(), body);
  Outcome outcome{code, ::testing::internal::GetCapturedStdout(), ::testing::internal::GetCapturedStderr()};
  return outcome;
}

TEST(Program, ReturnsTheCodeOfItsBody) {
  EXPECT_EQ(RunWith({"--file", "x"}, [] { return 0; }).code, 0);
  EXPECT_EQ(RunWith({"--file", "x"}, [] { return 3; }).code, 3);
}

TEST(Program, HelpAndVersionGoToStandardOutputAndSucceed) {
  const Outcome version = RunWith({"--version"}, [] { return 9; });
  EXPECT_EQ(version.code, kExitOk);
  EXPECT_EQ(version.out, "prog " + Version() + "\n");
  const Outcome help = RunWith({"--help"}, [] { return 9; });
  EXPECT_EQ(help.code, kExitOk);
  EXPECT_NE(help.out.find("--file"), std::string::npos);
}

TEST(Program, BadUsageIsTwoAndOneLine) {
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{}, {"--flie", "x"}, {"--file"}, {"--file", "x", "left-over"}}) {
    const Outcome o = RunWith(arguments, [] { return 0; });
    EXPECT_EQ(o.code, kExitBadInput);
    EXPECT_EQ(std::count(o.err.begin(), o.err.end(), '\n'), 1) << o.err;
    EXPECT_TRUE(o.err.starts_with("prog: ")) << o.err;
  }
}

TEST(Program, BadInputIsTwoOtherTroubleIsOneEachWithOneLine) {
  const Outcome config = RunWith({"--file", "x"}, []() -> int { throw ConfigError("f.toml:3: k: unknown key"); });
  EXPECT_EQ(config.code, kExitBadInput);
  EXPECT_EQ(config.err, "prog: f.toml:3: k: unknown key\n");
  EXPECT_EQ(RunWith({"--file", "x"}, []() -> int { throw InputError("d.csv:3: x"); }).code, kExitBadInput);
  EXPECT_EQ(RunWith({"--file", "x"}, []() -> int { throw std::invalid_argument("x"); }).code, kExitBadInput);
  const Outcome other = RunWith({"--file", "x"}, []() -> int { throw std::runtime_error("no\nbus\n"); });
  EXPECT_EQ(other.code, kExitFailure);
  EXPECT_EQ(other.err, "prog: no bus\n");
}

}  // namespace
}  // namespace armcmc::support::program_test
