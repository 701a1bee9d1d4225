#include "armcmc/support/estimator_config.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "armcmc/estimator.hpp"

namespace armcmc::support::estimator_config_test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

EstimatorSettings Read(const std::string& text, const std::string& model_override = "") {
  StrictTable root = StrictTable::FromText(text, "f.toml");
  EstimatorSettings settings = ReadEstimatorSettings(root, model_override);
  root.Finish();
  return settings;
}

std::string ErrorOf(const std::string& text, const std::string& model_override = "") {
  try {
    Read(text, model_override);
  } catch (const ConfigError& error) {
    return error.what();
  }
  ADD_FAILURE() << "no ConfigError was thrown for:\n" << text;
  return "";
}

const std::string kHunt = "schema = 1\n[model]\nname = \"hunt_crossley\"\n";
const std::string kActuator = "schema = 1\n[model]\nname = \"soft_actuator\"\n";

TEST(EstimatorConfig, AnEmptyFileIsTheBuiltInModel) {
  const EstimatorSettings read = Read(kHunt), built_in = BuiltinSettings("hunt_crossley");
  EXPECT_EQ(read.model, "hunt_crossley");
  ASSERT_EQ(read.num_parameters, built_in.num_parameters);
  for (std::size_t i = 0; i < static_cast<std::size_t>(read.num_parameters); ++i) {
    EXPECT_EQ(read.parameters[i].name, built_in.parameters[i].name);
    EXPECT_EQ(read.parameters[i].mean, built_in.parameters[i].mean);
    EXPECT_EQ(read.parameters[i].lower, built_in.parameters[i].lower);
  }
  EXPECT_EQ(read.noise[0].std, built_in.noise[0].std);
  EXPECT_EQ(read.forgetting.threshold, built_in.forgetting.threshold);
  EXPECT_EQ(read.forgetting.drift_share, built_in.forgetting.drift_share);
  EXPECT_TRUE(read.forgetting.partial_change);
  EXPECT_EQ(read.sampler.seed, built_in.sampler.seed);
  EXPECT_EQ(read.sampler.rule, built_in.sampler.rule);
}

TEST(EstimatorConfig, ReadsHowManyPacksShareASample) {
  EXPECT_EQ(Read(kHunt).overlap, 1);
  EXPECT_EQ(Read(kHunt + "[timing]\noverlap = 10\n").overlap, 10);
  EXPECT_EQ(Read(kHunt + "[timing]\noverlap = 256\n").overlap, 256);
  for (const char* wrong : {"0", "-1", "257", "2.5", "\"10\""})
    EXPECT_THAT(ErrorOf(kHunt + "[timing]\noverlap = " + wrong + "\n"),
                AllOf(HasSubstr("f.toml:5:"), HasSubstr("timing.overlap"), HasSubstr("[1, 256]")))
        << wrong;
}

TEST(EstimatorConfig, EveryKeyArrives) {
  const EstimatorSettings s = Read(kHunt + R"(
[model.parameters.K]
prior = "normal"
mean = 3
sd = 1.5
lower = 0.5
upper = 7
[model.parameters.p]
prior = "uniform"
lower = 1.1
upper = 2.4
[noise]
kind = "mixture"
std = 0.2
mean = 0.01
estimate_std = true
std_log_sd = 0.5
dof = 5
outlier_weight = 0.1
outlier_scale = 8
[gap_watch]
enabled = false
false_alarm_rate = 0.2
tolerance = 0.5
[forgetting]
index = "signed_mean"
threshold = 2.5
mu = 0.1
lambda_max = 0.9
rho = 0.01
min_samples = 7
drift_share = 0.3
partial_change = false
[sampler]
epsilon = 0.02
delta = 0.8
draws = "k_min"
max_draws = 20000
lambda_q_min = 0.1
lambda_q_max = 0.6
use_linearity = false
seed = 42
)");
  EXPECT_EQ(s.parameters[0].mean, 3.0);
  EXPECT_EQ(s.parameters[0].sd, 1.5);
  EXPECT_EQ(s.parameters[0].lower, 0.5);
  EXPECT_EQ(s.parameters[0].upper, 7.0);
  EXPECT_EQ(s.parameters[2].prior, PriorKind::kUniform);
  EXPECT_EQ(s.noise[0].kind, NoiseKind::kMixture);
  EXPECT_EQ(s.noise[0].std, 0.2);
  EXPECT_EQ(s.noise[0].mean, 0.01);
  EXPECT_TRUE(s.noise[0].estimate_std);
  EXPECT_EQ(s.noise[0].std_log_sd, 0.5);
  EXPECT_EQ(s.noise[0].dof, 5.0);
  EXPECT_EQ(s.noise[0].outlier_weight, 0.1);
  EXPECT_EQ(s.noise[0].outlier_scale, 8.0);
  EXPECT_FALSE(s.gap_watch.enabled);
  EXPECT_EQ(s.gap_watch.false_alarm_rate, 0.2);
  EXPECT_EQ(s.gap_watch.tolerance, 0.5);
  EXPECT_EQ(s.forgetting.index, MismatchIndex::kSignedMean);
  EXPECT_EQ(s.forgetting.threshold, 2.5);
  EXPECT_EQ(s.forgetting.mu, 0.1);
  EXPECT_EQ(s.forgetting.lambda_max, 0.9);
  EXPECT_EQ(s.forgetting.rho, 0.01);
  EXPECT_EQ(s.forgetting.min_samples, 7);
  EXPECT_EQ(s.forgetting.drift_share, 0.3);
  EXPECT_FALSE(s.forgetting.partial_change);
  EXPECT_EQ(s.sampler.epsilon, 0.02);
  EXPECT_EQ(s.sampler.delta, 0.8);
  EXPECT_EQ(s.sampler.rule, DrawRule::kKMin);
  EXPECT_EQ(s.sampler.max_draws, 20'000);
  EXPECT_EQ(s.sampler.lambda_q_min, 0.1);
  EXPECT_EQ(s.sampler.lambda_q_max, 0.6);
  EXPECT_FALSE(s.sampler.use_linearity);
  EXPECT_EQ(s.sampler.seed, 42u);
}

TEST(EstimatorConfig, TheMethodAndTheTuningOfTheBaselinesArrive) {
  EXPECT_EQ(Read(kHunt).method, Method::kArmcmc);
  EXPECT_EQ(Read("method = \"rls\"\n" + kHunt).method, Method::kRls);
  EXPECT_EQ(Read("method = \"mcmc\"\n" + kHunt).method, Method::kMetropolis);
  const EstimatorSettings s = Read("method = \"pf\"\n" + kHunt + R"(
[baseline]
recall = true
rls_forgetting = 0.99
rls_reset = false
particles = 1000
pf_updates = 5
pf_jitter = 0.2
)");
  EXPECT_EQ(s.method, Method::kParticleFilter);
  EXPECT_TRUE(s.baseline.recall);
  EXPECT_EQ(s.baseline.rls_forgetting, 0.99);
  EXPECT_FALSE(s.baseline.rls_reset);
  EXPECT_EQ(s.baseline.particles, 1000);
  EXPECT_EQ(s.baseline.pf_updates, 5);
  EXPECT_EQ(s.baseline.pf_jitter, 0.2);
  EXPECT_THAT(ErrorOf("method = \"kalman\"\n" + kHunt), HasSubstr("armcmc"));
  EXPECT_THAT(ErrorOf(kHunt + "[baseline]\nrls_forgetting = 1.5\n"), HasSubstr("rls_forgetting"));
}

TEST(EstimatorConfig, ANumberOfDrawsIsFixedAndFits) {
  const EstimatorSettings s = Read(kHunt + "[sampler]\ndraws = 30000\n");
  EXPECT_EQ(s.sampler.rule, DrawRule::kFixed);
  EXPECT_EQ(s.sampler.fixed_draws, 30'000);
  EXPECT_GE(s.sampler.max_draws, 30'000);
}

TEST(EstimatorConfig, NoiseOfOneModeOverridesTheOthers) {
  const EstimatorSettings plain = BuiltinSettings("soft_actuator");
  const std::string second{Estimator(plain).mode_name(1)};
  const EstimatorSettings s =
      Read(kActuator + "[noise]\nkind = \"laplace\"\nstd = 2e-4\n[noise." + second + "]\nstd = 3e-4\n");
  EXPECT_EQ(s.noise[0].std, 2e-4);
  EXPECT_EQ(s.noise[1].std, 3e-4);
  EXPECT_EQ(s.noise[1].kind, NoiseKind::kLaplace);
}

TEST(EstimatorConfig, ConstantsBelongToTheActuator) {
  const EstimatorSettings s = Read(kActuator + "[model.constants]\np_atm = 1e5\nq1 = 0.07\n");
  EXPECT_EQ(ConstantOf(s, "q1"), 0.07);
  EXPECT_EQ(ConstantOf(s, "p_atm"), 1e5);
  EXPECT_EQ(ConstantOf(s, "q2"), ConstantOf(BuiltinSettings("soft_actuator"), "q2"));
  EXPECT_TRUE(std::isnan(ConstantOf(s, "q4")));
  EXPECT_THAT(ErrorOf(kHunt + "[model.constants]\nq1 = 0.07\n"), HasSubstr("model.constants"));
  EXPECT_THAT(ErrorOf(kActuator + "[model.constants]\nq4 = 0.07\n"),
              AllOf(HasSubstr("f.toml:5"), HasSubstr("model.constants.q4"), HasSubstr("p_atm, p_supply, q1, q2, q3")));
  EXPECT_THAT(ErrorOf(kActuator + "[model.constants]\nq2 = -1.0\n"), HasSubstr("model.constants.q2"));
}

TEST(EstimatorConfig, WhatIsRegressedCanBeChosenForTheActuator) {
  EXPECT_FALSE(Read(kActuator).regress_rate);
  for (const std::string key : {"regress_rate", "pressure_rate"}) {
    EXPECT_TRUE(Read(kActuator + key + " = true\n").regress_rate) << key;
    EXPECT_FALSE(Read(kActuator + key + " = false\n").regress_rate) << key;
    EXPECT_THAT(ErrorOf(kHunt + key + " = true\n"),
                AllOf(HasSubstr("f.toml:4"), HasSubstr("model." + key), HasSubstr("has no rate to regress")));
  }
  EXPECT_THAT(ErrorOf(kActuator + "pressure_rate = true\nregress_rate = true\n"),
              HasSubstr("means the same as regress_rate"));
  EXPECT_THAT(ErrorOf(kActuator + "regres_rate = true\n"), HasSubstr("did you mean regress_rate?"));
}

TEST(EstimatorConfig, TheModelOfTheCommandLineWins) {
  EXPECT_EQ(Read(kHunt, "soft_actuator").model, "soft_actuator");
  EXPECT_EQ(Read("schema = 1\n", "hunt_crossley").model, "hunt_crossley");
}

TEST(EstimatorConfig, UnknownModelsAreNamed) {
  EXPECT_THAT(ErrorOf("schema = 1\n[model]\nname = \"hunt\"\n"), HasSubstr("f.toml:3:8: model.name = \"hunt\""));
  EXPECT_THAT(ErrorOf(kHunt, "hunt"), HasSubstr("--model hunt"));
  EXPECT_THAT(ErrorOf("schema = 1\n"), HasSubstr("model.name is missing"));
}

TEST(EstimatorConfig, TyposAndForeignNamesAreErrorsWithTheirLine) {
  EXPECT_THAT(ErrorOf(kHunt + "[sampler]\nsed = 1\n"), AllOf(HasSubstr("f.toml:5"), HasSubstr("did you mean seed?")));
  EXPECT_THAT(ErrorOf(kHunt + "[model.parameters.Q]\nmean = 1\n"), HasSubstr("f.toml:4:1: model.parameters.Q"));
  EXPECT_THAT(ErrorOf(kHunt + "[noise.valve]\nstd = 1\n"), HasSubstr("noise.valve"));
  EXPECT_THAT(ErrorOf(kHunt + "[samplr]\n"), HasSubstr("did you mean sampler?"));
}

TEST(EstimatorConfig, ValuesOutOfRangeAreErrors) {
  EXPECT_THAT(ErrorOf("schema = 2\n[model]\nname = \"hunt_crossley\"\n"), HasSubstr("f.toml:1:10: schema = 2"));
  for (const char* line : {"[noise]\nstd = 0",
                           "[noise]\nstd = -1",
                           "[noise]\nkind = \"normal\"",
                           "[noise]\noutlier_weight = 0.7",
                           "[noise]\noutlier_scale = 1",
                           "[gap_watch]\nfalse_alarm_rate = 0",
                           "[gap_watch]\ntolerance = 2",
                           "[forgetting]\nthreshold = 0",
                           "[forgetting]\nlambda_max = 1.5",
                           "[forgetting]\nrho = -1",
                           "[forgetting]\nmin_samples = 0",
                           "[forgetting]\ndrift_share = 1.0",
                           "[forgetting]\npartial_change = 1",
                           "[sampler]\nepsilon = 0",
                           "[sampler]\ndelta = 1",
                           "[sampler]\ndraws = 10",
                           "[sampler]\ndraws = \"many\"",
                           "[sampler]\nseed = -1",
                           "[sampler]\nlambda_q_min = 0.7\nlambda_q_max = 0.6",
                           "[model.parameters.K]\nlower = 3\nupper = 2",
                           "[model.parameters.K]\nsd = 0",
                           "[model.parameters.K]\nprior = \"uniform\"\nmean = 2"}) {
    EXPECT_THAT(ErrorOf(kHunt + line + "\n"), HasSubstr("f.toml")) << line;
  }
}

}  // namespace
}  // namespace armcmc::support::estimator_config_test
