#include "armcmc/replay/estimate_csv.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <limits>
#include <map>
#include <sstream>
#include <string>

#include "armcmc/estimator.hpp"
#include "tools/csv_rows.hpp"

namespace armcmc::replay::estimate_csv_test {
namespace {

EstimatorSettings Small(const std::string& model) {
  EstimatorSettings settings = BuiltinSettings(model);
  settings.sampler.rule = DrawRule::kFixed;
  settings.sampler.fixed_draws = settings.sampler.max_draws = SamplerSettings::kMinDraws;
  return settings;
}

/// The first row, by the names in the header.
std::map<std::string, std::string> Row(const std::string& text) { return test::RowsOf(text).at(0); }

TEST(EstimateCsv, HasTheColumnsOfTheInterface) {
  const Estimator estimator(Small("hunt_crossley"));
  std::ostringstream out;
  const EstimateCsv header(estimator, &out);
  EXPECT_EQ(out.str(),
            "pack,t,mode,"
            "K,K_ap,K_sd,K_q025,K_q25,K_q50,K_q75,K_q975,K_chain_mean,"
            "B,B_ap,B_sd,B_q025,B_q25,B_q50,B_q75,B_q975,B_chain_mean,"
            "p,p_ap,p_sd,p_q025,p_q25,p_q50,p_q75,p_q975,p_chain_mean,"
            "lambda,zeta,decision,draws,k_min,ess,kish_ess,acceptance,log_evidence,p_changed,noise_std,"
            "y_pred,y_lo,y_hi,y_free_run,y_rmse,"
            "p_drifted,K_drift_per_s,B_drift_per_s,p_drift_per_s\n");
}

TEST(EstimateCsv, BeforeAnythingIsKnownTheFieldsAreEmpty) {
  const Estimator estimator(Small("hunt_crossley"));
  std::ostringstream out;
  EstimateCsv csv(estimator, &out);
  Estimate estimate;
  estimate.seq = 3;
  estimate.t_last_s = 0.3;
  estimate.mode = 1;
  csv.Write(estimate);
  auto row = Row(out.str());
  EXPECT_EQ(row["pack"], "3");
  EXPECT_EQ(row["t"], "0.29999999999999999");
  EXPECT_EQ(row["mode"], "free");
  EXPECT_EQ(row["decision"], "hold");
  EXPECT_EQ(row["draws"], "0");
  for (const char* name : {"K", "B_sd", "p_q975", "lambda", "ess", "noise_std", "y_pred", "y_rmse"})
    EXPECT_EQ(row[name], "") << name;
}

TEST(EstimateCsv, AHeldPackRepeatsWhatIsKnownButNoFigureOfAStepThatWasNotMade) {
  const Estimator estimator(Small("hunt_crossley"));
  std::ostringstream out;
  EstimateCsv csv(estimator, &out);
  Estimate estimate;
  estimate.modes[0].known = true;
  estimate.modes[0].marginal[0].ar_map = 4.25;
  estimate.modes[0].lambda = 0.5;
  csv.Write(estimate);
  auto row = Row(out.str());
  EXPECT_EQ(row["K"], "4.25");
  EXPECT_EQ(row["lambda"], "");
}

TEST(EstimateCsv, TheMismatchOfTheFirstPackIsInfinite) {
  const Estimator estimator(Small("hunt_crossley"));
  std::ostringstream out;
  EstimateCsv csv(estimator, &out);
  Estimate estimate;
  estimate.modes[0].updated = true;
  estimate.modes[0].zeta = std::numeric_limits<double>::infinity();
  csv.Write(estimate);
  EXPECT_EQ(Row(out.str())["zeta"], "inf");
}

TEST(EstimateCsv, NumbersReadBackToTheSameBits) {
  const Estimator estimator(Small("hunt_crossley"));
  for (const double value : {1.0 / 3.0, 1e-300, -2.5e17, 0.1 + 0.2}) {
    std::ostringstream out;
    EstimateCsv csv(estimator, &out);
    Estimate estimate;
    estimate.modes[0].known = estimate.modes[0].updated = true;
    estimate.modes[0].decision = Decision::kModification;
    estimate.modes[0].marginal[2].q975 = value;
    estimate.modes[0].log_evidence = -value;
    csv.Write(estimate);
    auto row = Row(out.str());
    EXPECT_EQ(std::strtod(row["p_q975"].c_str(), nullptr), value);
    EXPECT_EQ(std::strtod(row["log_evidence"].c_str(), nullptr), -value);
    EXPECT_EQ(row["decision"], "modification");
  }
}

TEST(EstimateCsv, PlantsWithSeveralModesShowAllOfThem) {
  const Estimator estimator(Small("soft_actuator"));
  ASSERT_EQ(estimator.num_modes(), 2);
  std::ostringstream out;
  EstimateCsv csv(estimator, &out);
  Estimate estimate;
  estimate.mode = estimate.report_mode = 1;
  estimate.modes[1].known = true;
  estimate.modes[1].marginal[0].ar_map = -2.5;
  estimate.modes[1].marginal[0].sd = 0.5;
  estimate.modes[1].draws = 250;
  estimate.modes[1].p_drifted = 0.75;
  estimate.modes[1].drift_rate[0] = 0.125;
  csv.Write(estimate);
  auto row = Row(out.str());
  const std::string quantity{estimator.reported(0).name}, first{estimator.mode_name(0)}, second{estimator.mode_name(1)};
  EXPECT_EQ(row[quantity], "-2.5");
  EXPECT_EQ(row[quantity + "_" + second], "-2.5");
  EXPECT_EQ(row[quantity + "_" + second + "_sd"], "0.5");
  EXPECT_EQ(row[quantity + "_" + first], "");
  EXPECT_EQ(row["draws_" + second], "250");
  EXPECT_EQ(row["p_drifted"], "0.75");
  EXPECT_EQ(row[quantity + "_drift_per_s"], "0.125");
  EXPECT_EQ(row["mode"], second);
}

}  // namespace
}  // namespace armcmc::replay::estimate_csv_test
