#include "armcmc/settings.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "plants/hunt_crossley/model.hpp"

namespace armcmc::settings_test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::string ErrorOf(const EstimatorSettings& settings) {
  try {
    settings.Validate();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(BuiltinSettings, UnknownNameListsTheKnownOnes) {
  try {
    (void)BuiltinSettings("hunt_crossly");
    FAIL() << "accepted";
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("hunt_crossly"), HasSubstr("hunt_crossley"), HasSubstr("soft_actuator"),
                                    HasSubstr("soft_actuator_excited")));
  }
}

struct Wrong {
  std::string key;    // must be named
  std::string value;  // must be shown, when the message is about one number
  std::function<void(EstimatorSettings&)> spoil;
};

const std::vector<Wrong> kWrong{
    {"'nope'", "", [](EstimatorSettings& s) { s.model = std::string("nope"); }},
    {"3 parameters", "2", [](EstimatorSettings& s) { s.num_parameters = 2; }},
    {"'Q'", "'B'", [](EstimatorSettings& s) { s.parameters[1].name = std::string(1, 'Q'); }},
    {"parameters.K.sd", "= 0", [](EstimatorSettings& s) { s.parameters[0].sd = 0.0; }},
    {"parameters.K.sd", "= -1", [](EstimatorSettings& s) { s.parameters[0].sd = -1.0; }},
    {"parameters.K.mean", "nan", [](EstimatorSettings& s) { s.parameters[0].mean = kNan; }},
    {"parameters.p", "lower", [](EstimatorSettings& s) { s.parameters[2].lower = s.parameters[2].upper; }},
    {"parameters.p", "lower", [](EstimatorSettings& s) { s.parameters[2].upper = kInfinity; }},
    {"parameters.p", "mass", [](EstimatorSettings& s) { s.parameters[2].mean = 100.0; }},
    {"noise.contact.std", "= 0", [](EstimatorSettings& s) { s.noise[0].std = 0.0; }},
    {"noise.contact.std", "inf", [](EstimatorSettings& s) { s.noise[0].std = kInfinity; }},
    {"noise.contact.mean", "nan", [](EstimatorSettings& s) { s.noise[0].mean = kNan; }},
    {"noise.contact.std_log_sd", "= 0", [](EstimatorSettings& s) { s.noise[0].std_log_sd = 0.0; }},
    {"noise.contact.dof", "= 0", [](EstimatorSettings& s) { s.noise[0].dof = 0.0; }},
    {"noise.contact.outlier_weight", "= 0.6", [](EstimatorSettings& s) { s.noise[0].outlier_weight = 0.6; }},
    {"noise.contact.outlier_scale", "= 1", [](EstimatorSettings& s) { s.noise[0].outlier_scale = 1.0; }},
    {"forgetting.threshold", "= 0", [](EstimatorSettings& s) { s.forgetting.threshold = 0.0; }},
    {"forgetting.threshold", "nan", [](EstimatorSettings& s) { s.forgetting.threshold = kNan; }},
    {"forgetting.mu", "inf", [](EstimatorSettings& s) { s.forgetting.mu = kInfinity; }},
    {"forgetting.drift_share", "= 1", [](EstimatorSettings& s) { s.forgetting.drift_share = 1.0; }},
    {"forgetting.lambda_max", "= 1", [](EstimatorSettings& s) { s.forgetting.lambda_max = 1.0; }},
    {"forgetting.rho", "= 1.5 is outside [0, 1]", [](EstimatorSettings& s) { s.forgetting.rho = 1.5; }},
    {"forgetting.min_samples", "= 0", [](EstimatorSettings& s) { s.forgetting.min_samples = 0; }},
    {"sampler.epsilon", "= 0 is outside (0, 1)", [](EstimatorSettings& s) { s.sampler.epsilon = 0.0; }},
    {"sampler.delta", "= 1", [](EstimatorSettings& s) { s.sampler.delta = 1.0; }},
    {"sampler.max_draws", "= 10", [](EstimatorSettings& s) { s.sampler.max_draws = 10; }},
    {"sampler.max_draws", "= 150001", [](EstimatorSettings& s) { s.sampler.max_draws = kMaxDraws + 1; }},
    {"sampler.draws", "= 50",
     [](EstimatorSettings& s) {
       s.sampler.rule = DrawRule::kFixed;
       s.sampler.fixed_draws = 50;
     }},
    {"sampler.lambda_q_min", "= 0", [](EstimatorSettings& s) { s.sampler.lambda_q_min = 0.0; }},
    {"sampler.lambda_q_max", "= 1", [](EstimatorSettings& s) { s.sampler.lambda_q_max = 1.0; }},
    {"sampler.lambda_q_min", "lambda_q_max", [](EstimatorSettings& s) { s.sampler.lambda_q_min = 0.9; }},
    {"gap_watch.false_alarm_rate", "= 0", [](EstimatorSettings& s) { s.gap_watch.false_alarm_rate = 0.0; }},
    {"gap_watch.tolerance", "= 2", [](EstimatorSettings& s) { s.gap_watch.tolerance = 2.0; }},
    {"model.regress_rate", "has no rate to regress", [](EstimatorSettings& s) { s.regress_rate = true; }},
    {"takes no effects", "",
     [](EstimatorSettings& s) {
       s.method = Method::kRls;
       s.effects[0] = MakeEffect(HuntCrossley::kInfo, "coulomb_friction");
       s.num_effects = 1;
     }},
    {"takes no effects", "",
     [](EstimatorSettings& s) {
       s.method = Method::kParticleFilter;
       s.baseline.pf_updates = 2;
       s.effects[0] = MakeEffect(HuntCrossley::kInfo, "coulomb_friction");
       s.num_effects = 1;
     }},
};

TEST(EstimatorSettings, ConstantsAreThoseThatThePlantDeclares) {
  const auto error = [](std::size_t constant, double value) -> std::string {
    EstimatorSettings settings = BuiltinSettings("soft_actuator");
    settings.constants[constant] = value;
    try {
      settings.Validate();
    } catch (const std::invalid_argument& wrong) {
      return wrong.what();
    }
    return "";
  };
  EXPECT_THAT(error(0, -1.0), AllOf(HasSubstr("constants.p_atm"), HasSubstr("= -1")));
  EXPECT_THAT(error(1, 1000.0), AllOf(HasSubstr("constants.p_supply"), HasSubstr("= 1000"), HasSubstr("101325")));
  EXPECT_THAT(error(2, kNan), AllOf(HasSubstr("constants.q1"), HasSubstr("nan")));
  EXPECT_THAT(error(3, -1.0), AllOf(HasSubstr("constants.q2"), HasSubstr("= -1")));
  EXPECT_THAT(error(4, kInfinity), AllOf(HasSubstr("constants.q3"), HasSubstr("inf")));
  EXPECT_EQ(error(5, kNan), "") << "it has five";
  EXPECT_EQ(ConstantOf(BuiltinSettings("soft_actuator"), "p_supply"), 800e3);
  EXPECT_TRUE(std::isnan(ConstantOf(BuiltinSettings("hunt_crossley"), "p_supply")));
}

TEST(EstimatorSettings, ValidateNamesKeyValueAndRangeOfWhatIsWrong) {
  for (const Wrong& wrong : kWrong) {
    EstimatorSettings settings = BuiltinSettings("hunt_crossley");
    wrong.spoil(settings);
    EXPECT_THAT(ErrorOf(settings), AllOf(HasSubstr(wrong.key), HasSubstr(wrong.value)));
  }
}

TEST(EstimatorSettings, ValidateLooksAtTheNoiseOfEveryMode) {
  EstimatorSettings settings = BuiltinSettings("soft_actuator");
  settings.noise[1].std = -1.0;
  EXPECT_THAT(ErrorOf(settings), HasSubstr("noise.u_d.std"));
}

TEST(EstimatorSettings, WhatALawDoesNotUseMayStayAtItsDefault) {
  EstimatorSettings settings = BuiltinSettings("hunt_crossley");
  settings.parameters[0].prior = PriorKind::kUniform;
  settings.parameters[0].sd = 0.0;
  EXPECT_EQ(ErrorOf(settings), "");
}

}  // namespace
}  // namespace armcmc::settings_test
