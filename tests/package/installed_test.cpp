#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <set>
#include <string>

#include "package/page_blocks.hpp"
#include "support/paths.hpp"
#include "support/process.hpp"

namespace armcmc::test::installed_test {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

fs::path BuildDir() { return Program("x").parent_path().parent_path(); }

Outcome Shell(const std::string& command) { return RunProgram("/bin/sh", {"-c", command}, 300s); }

/// Builds a program outside of the source tree against what is installed under `prefix`. @return what went wrong.
std::string BuildConsumer(const fs::path& source, const fs::path& build, const std::string& prefix,
                          const std::string& option = "") {
  const Outcome configure = Shell("cmake -G Ninja -S " + source.string() + " -B " + build.string() +
                                  " -DCMAKE_PREFIX_PATH=" + prefix + " " + option);
  if (configure.code != 0) return configure.out + configure.err;
  const Outcome compile = Shell("cmake --build " + build.string());
  return compile.code == 0 ? "" : compile.out + compile.err;
}

/// The loop that core/README.md shows, built as if LCM were not installed, and run. It knows the parameters of its
/// plant: c = 12, k = 400.
void ExpectTheLoopOfThePageWorks(const fs::path& folder, const std::string& prefix) {
  ASSERT_EQ(WriteFiles(ReadBlocks(SourceDir() / "core/README.md"), folder / "loop"), 2);
  ASSERT_EQ(BuildConsumer(folder / "loop", folder / "loop-build", prefix, "-DCMAKE_DISABLE_FIND_PACKAGE_LCM=ON"), "");
  const Outcome run = RunProgram(folder / "loop-build/my_loop", {});
  EXPECT_EQ(run.code, 0) << run.err;
  EXPECT_EQ(std::count(run.out.begin(), run.out.end(), '\n'), 5) << run.out;
  const auto last = [&](const std::string& name) {
    const std::size_t at = run.out.rfind(name);
    return at == std::string::npos ? 0.0 : std::stod(run.out.substr(at + name.size()));
  };
  EXPECT_NEAR(last("c = "), 12.0, 0.5) << run.out;
  EXPECT_NEAR(last("k = "), 400.0, 10.0) << run.out;
}

/// Whether a line of the build's CMakeCache.txt matches.
bool IsConfigured(const std::string& line) {
  return Shell("grep -q '^" + line + "$' " + (BuildDir() / "CMakeCache.txt").string()).code == 0;
}

/// The Python package, if this build makes it: from the installed files alone, with the plants and the programs that
/// belong to them. It runs if it is made for Debian's Python.
void ExpectThePythonPackageWorks(const fs::path& folder, const std::string& root) {
  const std::string deb = folder / "python3-armcmc_*.deb";
  if (!IsConfigured("ARMCMC_PYTHON:BOOL=ON")) return;
  ASSERT_EQ(Shell("dpkg-deb -x " + deb + " " + root).code, 0) << "it is built, and not packed";
  const std::string depends = Shell("dpkg-deb -f " + deb + " Depends").out;
  for (const char* package : {"armcmc (= ", "python3-numpy", "python3 (>= 3."})
    EXPECT_NE(depends.find(package), std::string::npos) << package << " is missing in " << depends;
  const std::string packages = root + "/usr/lib/python3/dist-packages";
  if (!IsConfigured("Python_EXECUTABLE:[A-Z]*=/usr/bin/python3")) return;
  std::ofstream(folder / "use.py") << "import armcmc, numpy as np, os\n"
                                      "root = os.path.realpath(os.environ['ROOT'])\n"
                                      "assert os.path.realpath(armcmc.__file__).startswith(root), armcmc.__file__\n"
                                      "assert 'servo_axis' in armcmc.models(), armcmc.models()\n"
                                      "t = 1e-3 * np.arange(3000)\n"
                                      "q, v, a = np.sin(5 * t), 5 * np.cos(5 * t), -25 * np.sin(5 * t)\n"
                                      "noise = np.random.default_rng(1).standard_normal(t.size)\n"
                                      "F = 90 * a + 200 * v + 40 * np.sign(v) + noise\n"
                                      "e = armcmc.Estimator('hunt_crossley', 'hunt_crossley')\n"
                                      "e.step(np.column_stack([q, v])[:100], F[:100], 1e-3)\n"
                                      "r = armcmc.gap('servo_axis', dict(t=t, q=q, v=v, a=a, F=F))\n"
                                      "print(r['verdict'], r['effects'][0]['name'])\n";
  const Outcome run = Shell("cd / && ROOT=" + root + " PYTHONDONTWRITEBYTECODE=1 PYTHONPATH=" + packages +
                            " /usr/bin/python3 " + (folder / "use.py").string());
  EXPECT_EQ(run.code, 0) << run.err;
  EXPECT_EQ(run.out, "named coulomb_friction\n");
}

/// A source that includes every header that is installed under `prefix`.
void WriteAllHeaders(const fs::path& prefix, const fs::path& source) {
  std::set<std::string> headers;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(prefix / "include"))
    if (entry.path().extension() == ".hpp") headers.insert(fs::relative(entry.path(), prefix / "include").string());
  EXPECT_TRUE(headers.contains("armcmc/estimator.hpp"));
  EXPECT_TRUE(headers.contains("armcmc/data_pack_t.hpp"));
  EXPECT_TRUE(headers.contains("armcmc/rt/pipeline.hpp"));
  EXPECT_FALSE(headers.contains("armcmc/rt/allocation_counter.hpp")) << "what it declares is not in the library";
  std::ofstream out(source);
  for (const std::string& header : headers) out << "#include <" << header << ">\n";
}

void WriteConsumer(const fs::path& prefix, const fs::path& folder) {
  fs::create_directories(folder);
  WriteAllHeaders(prefix, folder / "headers.cpp");
  std::ofstream(folder / "CMakeLists.txt") << "cmake_minimum_required(VERSION 3.25)\n"
                                              "project(consumer LANGUAGES CXX)\n"
                                              "find_package(armcmc 0.1 REQUIRED)\n"
                                              "add_executable(consumer main.cpp headers.cpp)\n"
                                              "target_link_libraries(consumer PRIVATE armcmc::core armcmc::rt)\n";
  std::ofstream(folder / "main.cpp") << "#include <armcmc/data_pack_t.hpp>\n"
                                        "#include <armcmc/estimator.hpp>\n"
                                        "#include <armcmc/rt/watchdog.hpp>\n"
                                        "#include <cstdio>\n"
                                        "int main() {\n"
                                        "  armcmc::Estimator estimator(armcmc::BuiltinSettings(\"hunt_crossley\"));\n"
                                        "  armcmc::data_pack_t pack{};\n"
                                        "  std::printf(\"%d %d\\n\", estimator.num_inputs(), pack.getEncodedSize());\n"
                                        "  return 0;\n"
                                        "}\n";
}

TEST(Installed, AnOutsideProjectFindsBuildsAndRuns) {
  const ScratchDir dir;
  const std::string prefix = dir / "prefix", source = dir / "consumer", build = dir / "consumer-build";
  const Outcome install = Shell("cmake --install " + BuildDir().string() + " --prefix " + prefix);
  ASSERT_EQ(install.code, 0) << install.err;
  WriteConsumer(prefix, source);
  ASSERT_EQ(BuildConsumer(source, build, prefix), "");
  const Outcome run = RunProgram(fs::path(build) / "consumer", {});
  EXPECT_EQ(run.code, 0);
  EXPECT_EQ(run.out.substr(0, 2), "2 ") << "inputs of a contact: " << run.out;
  const Outcome estimator = RunProgram(fs::path(prefix) / "bin/armcmc-estimator", {"--version"});
  EXPECT_EQ(estimator.code, 0) << estimator.err;
  ExpectTheLoopOfThePageWorks(dir.path(), prefix);
}

TEST(Installed, TheDebianPackageHoldsWhatAnOperatorNeeds) {
  if (!fs::exists("/usr/bin/dpkg-deb")) GTEST_SKIP() << "dpkg-deb is not installed";
  const ScratchDir dir;
  const Outcome pack = Shell("cpack -G DEB -D CPACK_DEBIAN_COMPRESSION_TYPE=none --config " +
                             (BuildDir() / "CPackConfig.cmake").string() + " -B " + dir.path().string());
  ASSERT_EQ(pack.code, 0) << pack.out << pack.err;
  const std::string deb = dir / "armcmc_*.deb";
  const Outcome contents = Shell("dpkg-deb -c " + deb);
  ASSERT_EQ(contents.code, 0) << contents.err;
  for (const char* path :
       {"./usr/bin/armcmc-estimator", "./usr/bin/armcmc-plant", "./usr/bin/armcmc-stress", "./usr/bin/armcmc-rtcheck",
        "./usr/share/man/man1/armcmc-estimator.1", "./usr/share/man/man1/armcmc-watch.1",
        "./usr/share/man/man1/armcmc-spy.1", "./usr/share/bash-completion/completions/armcmc-gap",
        "./usr/lib/systemd/system/armcmc-estimator.service", "./usr/lib/sysctl.d/60-armcmc.conf",
        "./usr/share/armcmc/deploy/60-armcmc.rules", "./usr/share/armcmc/config/hunt_crossley.toml",
        "./usr/share/armcmc/scenarios/hunt_crossley_paper.toml", "./usr/share/armcmc/lcm_types/armcmc_data_pack_t.lcm",
        "./usr/share/doc/armcmc/tuning.md", "./usr/include/armcmc/estimator.hpp"}) {
    EXPECT_NE(contents.out.find(path), std::string::npos) << path << " is missing in\n" << contents.out;
  }
  EXPECT_EQ(contents.out.find("lcm_types/spy"), std::string::npos) << "folders without a file\n" << contents.out;
  EXPECT_NE(Shell("dpkg-deb -f " + deb + " Depends").out.find("liblcm1"), std::string::npos);
  const std::string control = dir / "control";
  ASSERT_EQ(Shell("dpkg-deb -e " + deb + " " + control).code, 0);
  for (const char* script : {"postinst", "prerm", "postrm"}) {
    const std::string path = (fs::path(control) / script).string();
    const Outcome parsed = Shell(std::string("test -x ").append(path).append(" && sh -n ").append(path));
    EXPECT_EQ(parsed.code, 0) << script << ": " << parsed.err;
  }
  const std::string root = dir / "root";
  ASSERT_EQ(Shell("dpkg-deb -x " + deb + " " + root).code, 0);
  const Outcome plant = RunProgram(fs::path(root) / "usr/bin/armcmc-plant",
                                   {"--scenario", "hunt_crossley_paper", "--duration", "1", "--csv", dir / "x.csv"});
  EXPECT_EQ(plant.code, 0) << "it finds its scenarios where it lies: " << plant.err;
  const Outcome replay = RunProgram(fs::path(root) / "usr/bin/armcmc-replay",
                                    {"--config", "hunt_crossley", "--data", dir / "x.csv", "--out", dir / "y.csv"});
  EXPECT_EQ(replay.code, 0) << "and its configurations: " << replay.err;
  const Outcome list = RunProgram(fs::path(root) / "usr/bin/armcmc-model", {"list"});
  EXPECT_EQ(list.code, 0) << list.err;
  EXPECT_NE(list.out.find("servo_axis"), std::string::npos) << "and the bundled plants: " << list.out;
  const Outcome man = Shell("man --warnings -l " + root + "/usr/share/man/man1/armcmc-plant.1 2>&1 >/dev/null");
  if (man.code == 0) {
    EXPECT_EQ(man.out, "") << "the manual page is good roff";
  }
  const std::string completions = root + "/usr/share/bash-completion/completions/";
  const auto completed = [&](const std::string& program, const std::string& words, int word) {
    std::string function = "_" + program;
    std::replace(function.begin(), function.end(), '-', '_');
    return Shell("bash -c '. " + completions + program + "; COMP_WORDS=(" + words +
                 "); COMP_CWORD=" + std::to_string(word) + "; " + function + "; echo ${COMPREPLY[@]}'")
        .out;
  };
  EXPECT_EQ(completed("armcmc-gap", "armcmc-gap --rec", 1), "--recording\n");
  EXPECT_EQ(completed("armcmc-model", "armcmc-model \"\"", 1), "--help --version check list add new\n");
  EXPECT_EQ(completed("armcmc-model", "armcmc-model new --f", 2), "--from\n");
  ExpectTheLoopOfThePageWorks(dir.path(), root + "/usr");
  ExpectThePythonPackageWorks(dir.path(), root);
}

TEST(Installed, SystemdAcceptsTheService) {
  if (!fs::exists("/usr/bin/systemd-analyze")) GTEST_SKIP() << "systemd-analyze is not installed";
  const ScratchDir dir;
  std::ifstream source(SourceDir() / "rt/deploy/armcmc-estimator.service");
  std::string text{std::istreambuf_iterator<char>(source), std::istreambuf_iterator<char>()};
  // The program need not be installed for its unit to be checked.
  const std::string program = "/usr/bin/armcmc-estimator";
  text.replace(text.find(program), program.size(), Program("armcmc-estimator").string());
  const std::string unit = dir / "armcmc-estimator.service";
  std::ofstream(unit) << text;
  const Outcome verify = Shell("systemd-analyze verify --man=no " + unit);
  EXPECT_EQ(verify.code, 0) << verify.err;
  EXPECT_EQ(verify.err.find("armcmc-estimator.service:"), std::string::npos) << verify.err;
}

}  // namespace
}  // namespace armcmc::test::installed_test
