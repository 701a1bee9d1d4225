// The task that other samplers are given: its posterior against an oracle, its files, and what comes out of them.

#include "armcmc/bench/peer_case.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "statistical/quadrature.hpp"
#include "support/paths.hpp"
#include "support/process.hpp"

namespace armcmc::bench::peer_case_test {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

constexpr const char* kPython = "/usr/bin/python3";

std::string TextOf(const std::filesystem::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

TEST(PeerCases, HaveThePosteriorThatAGridOverAllParametersFinds) {
  for (const PeerCase& what : PeerCases()) {
    const auto& prior = what.settings.parameters;
    const std::array<Moments, 3> posterior = QuadraturePosterior(what);
    const auto log_prior = [&](double k, double b, double p) {
      double sum = 0.0;
      const std::array theta{k, b, p};
      for (std::size_t d = 0; d < 3; ++d) {
        if (theta[d] < prior[d].lower || theta[d] > prior[d].upper) return -HUGE_VAL;
        sum -= 0.5 * std::pow((theta[d] - prior[d].mean) / prior[d].sd, 2.0);
      }
      return sum;
    };
    const double reach = 7.0 * posterior[2].sd;
    const auto truth = test::ContactQuadrature::Run(
        what.pack, what.settings.noise[0].std, log_prior, posterior[2].mean - reach, posterior[2].mean + reach,
        {prior[0].mean, prior[1].mean}, {1.0 / (prior[0].sd * prior[0].sd), 0.0, 1.0 / (prior[1].sd * prior[1].sd)});
    for (std::size_t d = 0; d < 3; ++d) {
      // Both sum a smooth function over equal steps to where it has vanished; the grid cuts (K, B) at seven standard
      // deviations.
      EXPECT_NEAR(posterior[d].mean, truth[d].mean, 1e-5 * truth[d].sd) << what.name << ' ' << prior[d].name;
      EXPECT_NEAR(posterior[d].sd / truth[d].sd, 1.0, 1e-5) << what.name << ' ' << prior[d].name;
    }
  }
}

TEST(PeerCases, WithABoundThatCutsThePosteriorHaveNone) {
  PeerCase what = PeerCases().front();
  what.settings.parameters[1].upper = 2.31;
  EXPECT_THROW((void)QuadraturePosterior(what), std::invalid_argument);
}

TEST(PeerCases, AreWrittenWithWhatTheEstimatorMakesOfThem) {
  const test::ScratchDir dir;
  const test::Outcome run =
      test::RunProgram(test::Program("armcmc-bench"), {"--write-packs", (dir / "packs").string(), "--replicates", "3"});
  ASSERT_EQ(run.code, 0) << run.err;
  for (const char* name : {"cold", "ridge"}) {
    const std::filesystem::path folder = dir / "packs" / name;
    EXPECT_THAT(TextOf(folder / "pack.csv"), StartsWith("x,v,f,noise_sd\n"));
    EXPECT_THAT(TextOf(folder / "parameters.csv"),
                StartsWith("name,mean,sd,lower,upper,posterior_mean,posterior_sd\n"));
    for (const char* program : {"armcmc_weighted.csv", "armcmc_chain.csv"}) {
      const std::string text = TextOf(folder / program);
      EXPECT_THAT(text, HasSubstr("\nms,acceptance,evaluations,K,B,p\n")) << name << ' ' << program;
      EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 6) << name << ' ' << program;
    }
  }
  const test::Outcome usage = test::RunProgram(test::Program("armcmc-bench"),
                                               {"--write-packs", (dir / "packs").string(), "--benchmark_filter=Draw"});
  EXPECT_EQ(usage.code, 2);
  EXPECT_THAT(usage.err, HasSubstr("--benchmark_filter=Draw"));
}

TEST(PeerSummary, CountsEffectiveDrawsByTheErrorOfTheWorstParameter) {
  if (!std::filesystem::exists(kPython)) GTEST_SKIP() << "no " << kPython;
  const test::ScratchDir dir;
  std::filesystem::create_directories(dir / "one");
  std::ofstream(dir / "one/parameters.csv") << "name,mean,sd,lower,upper,posterior_mean,posterior_sd\n"
                                               "K,0,9,-99,99,5,2\nB,0,9,-99,99,1,0.5\n";
  // K errs by 0.1 standard deviations, B by 0.2: 1 / 0.04 effective draws, in 4 ms.
  std::ofstream(dir / "one/gsl.csv") << "# peer: some peer\n# how: tuned\nms,acceptance,evaluations,K,B\n"
                                        "3,0.2,100,5.2,1.1\n4,0.4,100,4.8,0.9\n90,0.3,100,5.2,1.1\n4,0.3,100,4.8,0.9\n";
  // Ten times as many draws in a tenth of the time, with a bias that all replicates share.
  std::ofstream(dir / "one/armcmc_weighted.csv")
      << "# peer: ours\nms,acceptance,evaluations,K,B\n0.4,0.5,10,5.12649110640674,1\n0.4,0.5,10,5.12649110640674,1\n";
  const test::Outcome run = test::RunProgram(kPython, {test::SourceDir() / "tools/bench/peers/summary.py", dir.path(),
                                                       "--json", dir / "report.json", "--about", "commit=abc"});
  ASSERT_EQ(run.code, 0) << run.err;
  const auto report = nlohmann::json::parse(TextOf(dir / "report.json"));
  EXPECT_EQ(report.at("about").at("commit"), "abc");
  const auto& one = report.at("cases").at(0);
  EXPECT_EQ(one.at("best_peer"), "gsl");
  EXPECT_NEAR(one.at("times_best_peer").at("armcmc_weighted").get<double>(), 100.0, 1e-6);
  const auto& ours = one.at("peers").at(0);
  EXPECT_NEAR(ours.at("effective_draws").get<double>(), 250.0, 1e-6);
  EXPECT_NEAR(ours.at("bias_sd").get<double>(), 0.0632455532, 1e-9);
  const auto& peer = one.at("peers").at(1);
  EXPECT_EQ(peer.at("peer"), "some peer");
  EXPECT_NEAR(peer.at("effective_draws").get<double>(), 25.0, 1e-9);
  EXPECT_NEAR(peer.at("acceptance").get<double>(), 0.3, 1e-9);
  EXPECT_EQ(peer.at("ms").get<double>(), 4.0);
  EXPECT_EQ(peer.at("replicates").get<int>(), 4);
  EXPECT_THAT(run.out, HasSubstr("| one | some peer | 4 | 100 | 0.30 | 4 | 25 ± 71 % | 6.25 | 100 |"));
  const test::Outcome nothing =
      test::RunProgram(kPython, {test::SourceDir() / "tools/bench/peers/summary.py", dir / "none"});
  EXPECT_EQ(nothing.code, 2);
}

class ComparePeers : public ::testing::Test {
 protected:
  test::Outcome Run(std::vector<std::string> arguments) const {
    arguments.insert(arguments.end(), {"--build", test::Program("x").parent_path().parent_path()});
    return test::RunProgram(test::SourceDir() / "tools/bench/compare-peers", arguments, std::chrono::minutes(1));
  }
};

TEST_F(ComparePeers, SaysWhatItRunsAndRefusesWhatItDoesNotKnow) {
  const test::Outcome help = Run({"--help"});
  EXPECT_EQ(help.code, 0);
  for (const char* word : {"liborocos-bfl-dev", "libgsl-dev", "python3-emcee", "r-cran-mcmc", "r-cran-rstan", "--json"})
    EXPECT_THAT(help.out, HasSubstr(word));
  for (const std::vector<std::string>& wrong :
       {std::vector<std::string>{"--only", "nobody"}, {"--with", "everything"}, {"--fast"}, {"--json"}}) {
    const test::Outcome run =
        test::RunProgram(test::SourceDir() / "tools/bench/compare-peers", wrong, std::chrono::minutes(1));
    EXPECT_EQ(run.code, 2) << wrong.front();
    EXPECT_THAT(run.err, HasSubstr("Usage:"));
  }
}

TEST_F(ComparePeers, NamesThePackagesOfPeersThatItLeavesOut) {
  // A computer on which nothing is installed.
  const test::ScratchDir dir;
  std::ofstream(dir / "dpkg-query") << "#!/bin/sh\nexit 1\n";
  std::filesystem::permissions(dir / "dpkg-query", std::filesystem::perms::owner_all);
  const test::Outcome run =
      test::RunProgram("/usr/bin/env", {"PATH=" + dir.path().string() + ":/usr/bin:/bin",
                                        test::SourceDir() / "tools/bench/compare-peers", "--no-install", "--only",
                                        "gsl", "--build", test::Program("x").parent_path().parent_path()});
  EXPECT_EQ(run.code, 1);
  EXPECT_THAT(run.out, testing::IsEmpty());
  EXPECT_THAT(run.err, HasSubstr("gsl is left out; as root: apt-get update && apt-get install --no-install-recommends "
                                 "libgsl-dev"));
  EXPECT_THAT(run.err, HasSubstr("no peer can be run"));
}

TEST_F(ComparePeers, QuicklyShowsThatEveryPeerFindsThePosterior) {
  if (!std::filesystem::exists(kPython)) GTEST_SKIP() << "no " << kPython;
  const test::ScratchDir dir;
  const test::Outcome run = Run({"--quick", "--no-install", "--only", "bfl", "--only", "gsl", "--only", "emcee",
                                 "--only", "mcmc", "--json", (dir / "peers.json").string()});
  if (run.code == 1 && run.err.find("no peer can be run") != std::string::npos) GTEST_SKIP() << run.err;
  ASSERT_EQ(run.code, 0) << run.err;
  const auto report = nlohmann::json::parse(TextOf(dir / "peers.json"));
  EXPECT_EQ(report.at("about").at("quick"), "true");
  ASSERT_EQ(report.at("cases").size(), 2U);
  for (const auto& what : report.at("cases")) {
    EXPECT_GE(what.at("peers").size(), 4U);  // two of ours, the fit, and a peer
    EXPECT_TRUE(what.at("times_best_peer").contains("armcmc_weighted"));
    for (const auto& peer : what.at("peers")) {
      EXPECT_GT(peer.at("ms").get<double>(), 0.0) << peer;
      EXPECT_GT(peer.at("effective_draws_per_ms").get<double>(), 0.0) << peer;
      EXPECT_THAT(run.out, HasSubstr(peer.at("peer").get<std::string>()));
      // 3000 evaluations five times over: a chain of a hundredth of them knows a mean of `cold` to 0.08 of its standard
      // deviation.
      if (what.at("case") == "cold") {
        EXPECT_LT(peer.at("bias_sd").get<double>(), 0.25) << peer;
      }
    }
  }
}

}  // namespace
}  // namespace armcmc::bench::peer_case_test
