#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "support/paths.hpp"
#include "support/process.hpp"

namespace armcmc::test::armcmc_spy_test {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

/// armcmc-spy on a machine where some of what it needs is not there.
class ArmcmcSpy : public ::testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(dir_ / "bin");
    for (const char* tool : {"sh", "cat", "dirname", "readlink", "nice"}) {
      fs::create_symlink(
          fs::exists(fs::path("/usr/bin") / tool) ? fs::path("/usr/bin") / tool : fs::path("/bin") / tool,
          dir_ / "bin" / tool);
    }
    fs::create_directories(dir_ / "jars");
  }

  void Touch(const std::string& name) const {
    fs::create_directories((dir_ / name).parent_path());
    std::ofstream file(dir_ / name);
  }

  /// A Java that does nothing but show how it is called.
  void AddJava(bool with_windows) const {
    Touch("java/bin/java");
    std::ofstream(dir_ / "java/bin/java") << "#!/bin/sh\necho \"$@\"\n";
    fs::permissions(dir_ / "java/bin/java", fs::perms::owner_all);
    if (with_windows) Touch("java/lib/libawt_xawt.so");
    fs::create_symlink(dir_ / "java/bin/java", dir_ / "bin/java");
  }

  [[nodiscard]] Outcome Run(std::vector<std::string> arguments, const std::string& display = ":0") const {
    std::vector<std::string> command = {"-i", "PATH=" + (dir_ / "bin").string(),
                                        "ARMCMC_JAVA_DIR=" + (dir_ / "jars").string(),
                                        "ARMCMC_SPY_JAR=" + (dir_ / "armcmc-spy.jar").string()};
    if (!display.empty()) command.push_back("DISPLAY=" + display);
    command.push_back(Program("armcmc-spy").string());
    command.insert(command.end(), arguments.begin(), arguments.end());
    return RunProgram("/usr/bin/env", command);
  }

  ScratchDir dir_;
};

TEST_F(ArmcmcSpy, ExplainsItself) {
  EXPECT_THAT(Run({"--help"}).out,
              AllOf(StartsWith("Shows the messages on the bus"), HasSubstr("\nUsage: armcmc-spy [OPTIONS]\n")));
  EXPECT_EQ(Run({"--help"}).code, 0);
  EXPECT_THAT(Run({"--version"}).out, StartsWith("armcmc-spy 0."));
  for (const std::vector<std::string>& bad :
       std::vector<std::vector<std::string>>{{"--nonsense"}, {"--lcm-url"}, {"--prefix"}, {"--lcm-url", "7667"}}) {
    const Outcome o = Run(bad);
    EXPECT_EQ(o.code, 2) << bad[0];
    EXPECT_EQ(std::count(o.err.begin(), o.err.end(), '\n'), 1) << o.err;
  }
}

TEST_F(ArmcmcSpy, RepeatsNothingThatATerminalActsOn) {
  for (const std::string raw : {"--\x1b[2J", "--\xff", "--\xC2\x9B", "--a\nb"}) {
    EXPECT_EQ(Run({raw}).err,
              "armcmc-spy: (a word with bytes that are not shown) is not an option (see armcmc-spy --help)\n");
    EXPECT_THAT(Run({"--lcm-url", raw}).err,
                StartsWith("armcmc-spy: --lcm-url (a word with bytes that are not shown): "));
  }
  EXPECT_EQ(Run({"--\\033[2J"}).err, "armcmc-spy: --\\033[2J is not an option (see armcmc-spy --help)\n");
  EXPECT_THAT(Run({"--lcm-url", std::string(9000, 'x')}).err, StartsWith("armcmc-spy: --lcm-url (a word of 9000 char"));
}

TEST_F(ArmcmcSpy, SaysWhichPackageIsMissing) {
  const auto expect = [this](const std::string& words) {
    const Outcome o = Run({});
    EXPECT_EQ(o.code, 1);
    EXPECT_THAT(o.err, HasSubstr(words));
    EXPECT_EQ(std::count(o.err.begin(), o.err.end(), '\n'), 1) << o.err;
  };
  expect("there is no Java. As root: apt-get install default-jre");
  AddJava(false);
  expect("cannot open windows. As root: apt-get install default-jre");
  Touch("java/lib/libawt_xawt.so");
  expect("apt-get install liblcm-java");
  Touch("jars/lcm.jar");
  expect("apt-get install libjchart2d-java");
  Touch("jars/jchart2d.jar");
  expect("tools/install-dependencies --with spy, then build again");
  Touch("armcmc-spy.jar");
  EXPECT_THAT(Run({}, "").err, HasSubstr("armcmc-watch, which needs none"));
  EXPECT_EQ(Run({}).code, 0);
}

TEST_F(ArmcmcSpy, HandsOverUrlAndPrefix) {
  AddJava(true);
  for (const char* file : {"jars/lcm.jar", "jars/jchart2d.jar", "armcmc-spy.jar"}) Touch(file);
  EXPECT_THAT(Run({"--lcm-url", "udpm://239.255.76.67:7999?ttl=0", "--prefix", "left_"}).out,
              HasSubstr("armcmc.spy.Main udpm://239.255.76.67:7999?ttl=0 true left_"));
  EXPECT_THAT(Run({"--panels"}).out, HasSubstr("armcmc.spy.Main udpm://239.255.76.67:7667?ttl=0 true"));
  EXPECT_THAT(Run({}).out, HasSubstr("armcmc.spy.Main udpm://239.255.76.67:7667?ttl=0 false"));
}

}  // namespace
}  // namespace armcmc::test::armcmc_spy_test
