#include "armcmc/identify/fit.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <random>

#include "core/plant/plants.hpp"

namespace armcmc::identify::fit_test {
namespace {

using Eigen::VectorXd;

struct Made {
  std::shared_ptr<const TrajectoryModel> model;
  std::vector<std::uint8_t> rows;
};

Made Make(PlantDescription description, Series series) {
  const std::size_t rows = series.num_rows();
  return {std::make_shared<const TrajectoryModel>(std::make_shared<const Plant>(std::move(description)),
                                                  std::make_shared<const Series>(std::move(series))),
          std::vector<std::uint8_t>(rows, 1)};
}

/// An axis (v, a, F) of 100 kg, 180 N s/m, -3 N with noise of 1 N.
Series Axis() {
  Series series;
  series.dt = 0.01;
  series.runs = {0};
  series.signals.resize(3);
  std::mt19937_64 random(5);
  std::normal_distribution<double> noise(0.0, 1.0);
  for (int n = 0; n < 800; ++n) {
    const double t = 0.01 * n, v = 0.2 * std::sin(2.0 * t), a = 0.4 * std::cos(2.0 * t);
    series.t.push_back(t);
    series.signals[0].push_back(v);
    series.signals[1].push_back(a);
    series.signals[2].push_back(100.0 * a + 180.0 * v - 3.0 + noise(random));
  }
  return series;
}

TEST(Fit, OfALinearLawIsRegularisedLeastSquares) {
  const Made made = Make(test::DescribedAxis(), Axis());
  const FitResult fit = Fit(*made.model, made.rows, made.model->Start());
  ASSERT_TRUE(fit.valid);
  // The normal equations, with the errors' size that the fit ends with.
  const Series& s = made.model->series();
  Eigen::MatrixXd x(800, 3);
  VectorXd y(800);
  for (Eigen::Index n = 0; n < 800; ++n) {
    const auto k = static_cast<std::size_t>(n);
    x.row(n) << s.signals[1][k], s.signals[0][k], 1.0;
    y[n] = s.signals[2][k];
  }
  const double precision = 1.0 / (fit.error_sd * fit.error_sd);
  Eigen::MatrixXd normal = precision * x.transpose() * x;
  const VectorXd prior = PriorPrecision(*made.model);
  normal.diagonal() += prior;
  const VectorXd expected =
      normal.ldlt().solve(precision * x.transpose() * y + prior.cwiseProduct(made.model->Start()));
  for (Eigen::Index d = 0; d < 3; ++d) EXPECT_NEAR(fit.theta[d], expected[d], 1e-4 * std::fabs(expected[d]));
  EXPECT_NEAR(fit.error_sd, 1.0, 0.08);
  const VectorXd sd = Covariance(*made.model, made.rows, fit).diagonal().cwiseSqrt();
  const VectorXd variance = normal.inverse().diagonal();
  for (Eigen::Index d = 0; d < 3; ++d) EXPECT_NEAR(sd[d], std::sqrt(variance[d]), 1e-3 * sd[d]);
}

TEST(Fit, CountsOnlyItsRows) {
  Series series = Axis();
  for (std::size_t n = 400; n < 800; ++n) series.signals[2][n] += 1e6;
  Made made = Make(test::DescribedAxis(), std::move(series));
  std::fill(made.rows.begin() + 400, made.rows.end(), std::uint8_t{0});
  const FitResult fit = Fit(*made.model, made.rows, made.model->Start());
  EXPECT_NEAR(fit.theta[0], 100.0, 2.0);
  EXPECT_NEAR(fit.theta[1], 180.0, 3.0);
}

TEST(Fit, StaysWithinTheBounds) {
  PlantDescription axis = test::DescribedAxis();
  axis.parameters[0].upper = 95.0;
  axis.parameters[0].mean = 80.0;
  const Made made = Make(std::move(axis), Axis());
  const FitResult fit = Fit(*made.model, made.rows, made.model->Start());
  EXPECT_DOUBLE_EQ(fit.theta[0], 95.0);
  EXPECT_NEAR(fit.theta[1], 180.0, 3.0);
}

/// x'' = -k x - d x' from x = 1 at rest, k and d to be found, measured without noise.
PlantDescription Oscillator() {
  PlantDescription plant;
  plant.name = "swing";
  plant.output = "y";
  plant.law = "pos";
  plant.signals = {{"u", "m/s^2", "", ""}, {"y", "m", "position", ""}};
  plant.parameters = {{"k", "1/s^2", "lognormal", 5.0, 1.0}, {"d", "1/s", "normal", 0.5, 0.5, 0.0, 5.0}};
  plant.states = {{"pos", "m", "position", "speed", "1", "", 1},
                  {"speed", "m/s", "velocity", "u - k*pos - d*speed", "0", "", 4}};
  plant.noise.std = 0.01;
  return plant;
}

Series Swing(int rows, const std::vector<std::size_t>& runs = {0}) {
  Series series;
  series.dt = 0.02;
  series.runs = runs;
  series.signals.resize(2);
  for (int n = 0; n < rows; ++n) {
    int of_run = n;
    for (const std::size_t run : runs)
      if (static_cast<int>(run) <= n) of_run = n - static_cast<int>(run);
    const double t = 0.02 * of_run, w = std::sqrt(9.0 - 0.04);
    series.t.push_back(t);
    series.signals[0].push_back(0.0);
    // k = 9, d = 0.4: under-damped from rest.
    series.signals[1].push_back(std::exp(-0.2 * t) * (std::cos(w * t) + 0.2 / w * std::sin(w * t)));
  }
  return series;
}

TEST(TrajectoryModel, StatesFollowTheClosedFormAndBeginAnewInEveryRun) {
  const Made made = Make(Oscillator(), Swing(600, {0, 250}));
  VectorXd prediction;
  ASSERT_TRUE(made.model->PredictOne(VectorXd{{std::log(9.0), 0.4}}, &prediction));
  EXPECT_LT((prediction - made.model->target()).cwiseAbs().maxCoeff(), 2e-8);
}

TEST(TrajectoryModel, AnInputMayBeHeldOrSmoothBetweenSamples) {
  for (const char* between : {"held", "smooth"}) {
    PlantDescription sum = Oscillator();
    sum.signals[0].between = between;
    sum.states[0].start = "0";
    sum.states[1].substeps = 1;
    Series series = Swing(90, {0, 40});
    for (std::size_t n = 0; n < 90; ++n) series.signals[0][n] = std::pow(static_cast<double>(n % 40), 2.0);
    const Made made = Make(sum, series);
    VectorXd prediction;
    // No spring, no damper: twice the integral of u.
    ASSERT_TRUE(made.model->PredictOne(VectorXd{{-60.0, 0.0}}, &prediction));
    double speed = 0.0, pos = 0.0;
    for (int n = 0; n < 39; ++n) {
      EXPECT_NEAR(prediction[40 + n], pos, 1e-9 * (1.0 + pos)) << between << n;
      const double u = n, dt = 0.02;
      const bool held = std::string(between) == "held";
      // A second integral of u^2 from u to u + 1, u in samples.
      pos += dt * speed + dt * dt * (held ? u * u / 2.0 : u * u / 2.0 + u / 3.0 + 1.0 / 12.0);
      speed += dt * (held ? u * u : u * u + u + 1.0 / 3.0);
    }
  }
}

TEST(TrajectoryModel, SeveralCandidatesAtOnceAreEachAsAlone) {
  for (const char* rate : {"u - k*pos - d*speed", "lowpass(u + k*y, 0.2) - k*pos - d*speed"}) {
    PlantDescription plant = Oscillator();
    plant.states[1].rate = rate;
    const Made made = Make(std::move(plant), Swing(100, {0, 40}));
    Eigen::MatrixXd thetas(2, 53), predictions;
    for (Eigen::Index c = 0; c < thetas.cols(); ++c)
      thetas.col(c) << std::log(3.0 + 0.3 * static_cast<double>(c)), 0.1 * static_cast<double>(c % 5);
    made.model->Predict(thetas, &predictions);
    for (const Eigen::Index c : {0, 15, 16, 31, 32, 36, 47, 48, 52}) {
      VectorXd alone;
      ASSERT_TRUE(made.model->PredictOne(thetas.col(c), &alone));
      EXPECT_EQ(alone, VectorXd(predictions.col(c))) << rate << ' ' << c;
    }
  }
}

TEST(TrajectoryModel, KnowsWhenAStartIsForgotten) {
  const Made made = Make(Oscillator(), Swing(3000));
  // exp(-d t / 2) = 0.01 after 23 s of d = 0.4.
  const Eigen::Index rows = made.model->RowsToForget(VectorXd{{std::log(9.0), 0.4}}, 0.01);
  EXPECT_NEAR(0.02 * static_cast<double>(rows), 2.0 / 0.4 * std::log(100.0), 0.7);
}

TEST(Fit, FindsTheParametersOfASimulatedPlantFromFarOff) {
  const Made made = Make(Oscillator(), Swing(400));
  const FitResult fit = BestFit(*made.model, made.rows, {made.model->Start()}, 1);
  EXPECT_NEAR(made.model->Shown(0, fit.theta[0]), 9.0, 1e-3);
  EXPECT_NEAR(fit.theta[1], 0.4, 1e-3);
}

/// Force of a bead over its place, k = 0.05 with the power 1.5 behind x = 2e-5, 3e-9 before it; `wave` on top.
/// @param give  Share of the force that is missing behind x = 3e-5.
Made Bead(double wave, double give = 0.0) {
  PlantDescription contact;
  contact.name = "bead";
  contact.output = "f";
  contact.law = "k*max(x - x0, 0)^n + f0";
  contact.signals = {{"x", "m", "position", ""}, {"f", "N", "force", ""}};
  contact.parameters = {{"k", "N/m^n", "lognormal", 1.0, 5.0},
                        {"n", "1", "normal", 1.5, 0.35, 1.0, 3.0},
                        {"x0", "m", "normal", 0.0, 1e-3},
                        {"f0", "N", "normal", 0.0, 0.1}};
  Series series;
  series.dt = 0.01;
  series.runs = {0};
  series.signals.resize(2);
  for (int n = 0; n < 400; ++n) {
    const double x = 1e-7 * n;
    series.t.push_back(0.01 * n);
    series.signals[0].push_back(x);
    const double force = 0.05 * std::pow(std::max(x - 2e-5, 0.0), 1.5) * (x > 3e-5 ? 1.0 - give : 1.0);
    series.signals[1].push_back(force + 3e-9 + wave * std::sin(37.0 * n));
  }
  return Make(std::move(contact), std::move(series));
}

TEST(BestFit, IsWhereTheBestOfAllFitsIsFound) {
  const Made made = Make(Oscillator(), Swing(300));
  std::vector<VectorXd> starts;
  starts.reserve(9);
  for (int s = 0; s < 9; ++s) starts.push_back(VectorXd{{std::log(2.0 + s), 0.05 * s}});
  FitResult expected;
  for (const VectorXd& start : starts) {
    FitResult fit = Fit(*made.model, made.rows, start);
    if (!expected.valid || fit.cost < expected.cost) expected = std::move(fit);
  }
  const FitResult best = BestFit(*made.model, made.rows, starts, 4, 12, false);
  ASSERT_TRUE(best.valid);
  const FitResult refined = Fit(*made.model, made.rows, best.theta);
  EXPECT_NEAR(refined.cost, expected.cost, 1e-3);
  EXPECT_LT((refined.theta - expected.theta).norm(), 1e-7);
  // A thousandth of the mean square is half a thousandth of the number of rows; the last step gained that at most.
  EXPECT_LT(best.cost - refined.cost, 1e-3 * static_cast<double>(made.rows.size()));
  VectorXd prediction;
  Eigen::MatrixXd jacobian;
  ASSERT_TRUE(made.model->Linearise(best.theta, &prediction, &jacobian));
  EXPECT_EQ(best.prediction, prediction);
  EXPECT_EQ(best.jacobian, jacobian);
}

TEST(BestFit, GoesOnFromMoreThanTheFirst) {
  // Of two starts far from k = 9 the one that fits better after two steps does not lead there.
  const Made made = Make(Oscillator(), Swing(300));
  const VectorXd first{{std::log(101.0), 0.4}}, leads{{std::log(0.25), 0.0}};
  const auto cost = [&](const std::vector<VectorXd>& starts, std::size_t most_fits, int iterations) {
    return BestFit(*made.model, made.rows, starts, most_fits, iterations, false).cost;
  };
  ASSERT_LT(cost({first}, 1, 0), cost({leads}, 1, 0));
  ASSERT_LT(cost({leads}, 1, 12), cost({first}, 1, 12) - 1000.0);
  EXPECT_EQ(cost({leads, first}, 1, 12), cost({first}, 1, 12));
  EXPECT_EQ(cost({leads, first}, 2, 12), cost({leads}, 1, 12));
}

TEST(Fit, AParameterThatIsFarOffDoesNotCarryTheOthersAway) {
  // The offset begins a million times the signal away; the place and the power of the contact have to be found still.
  const Made made = Bead(1e-12);
  VectorXd start = made.model->Start();
  start << -6.0, 1.8, 1.2e-5, -0.07;
  const FitResult fit = BestFit(*made.model, made.rows, {start}, 1);
  EXPECT_NEAR(fit.theta[2], 2e-5, 1e-6);
  EXPECT_NEAR(fit.theta[3], 3e-9, 1e-11);
  EXPECT_LT(fit.error_sd, 3e-12);
}

/// Places of `rows` from `first` on.
std::vector<Eigen::Index> Places(Eigen::Index first, Eigen::Index count) {
  std::vector<Eigen::Index> places;
  for (Eigen::Index k = first; k < first + count; ++k) places.push_back(k);
  return places;
}

/// Side by side each group is left out as well as Fit does it alone. Where the rest determines the parameters well,
/// that is in the group, too.
void ExpectTheFitsAlone(const Made& made, const VectorXd& start, const std::vector<Eigen::Index>& rows,
                        const std::vector<std::vector<Eigen::Index>>& groups, bool well_determined = true) {
  std::vector<std::uint8_t> counted(made.rows.size(), 0);
  for (const Eigen::Index n : rows) counted[static_cast<std::size_t>(n)] = 1;
  const FitResult all = BestFit(*made.model, counted, {start}, 1);
  ASSERT_TRUE(all.valid);
  const FitsWithout fits = FitWithoutEach(*made.model, all, rows, groups, 60);
  for (std::size_t g = 0; g < groups.size(); ++g) {
    std::vector<std::uint8_t> rest = counted;
    for (const Eigen::Index k : groups[g]) rest[static_cast<std::size_t>(rows[static_cast<std::size_t>(k)])] = 0;
    const FitResult alone = Fit(*made.model, rest, all.theta, 60);
    const VectorXd expected = (made.model->target() - alone.prediction)(rows),
                   found = fits.error.col(static_cast<Eigen::Index>(g));
    const auto squares_of_rest = [&](const VectorXd& e) {
      double sum = e.squaredNorm();
      for (const Eigen::Index k : groups[g]) sum -= e[k] * e[k];
      return sum;
    };
    EXPECT_LT(squares_of_rest(found), (1.0 + 1e-3) * squares_of_rest(expected)) << "group " << g;
    if (well_determined) {
      EXPECT_LT((found - expected).norm(), 0.02 * expected.norm()) << "group " << g;
    }
    VectorXd prediction;
    ASSERT_TRUE(made.model->PredictOne(fits.theta.col(static_cast<Eigen::Index>(g)), &prediction));
    EXPECT_LT((found - (made.model->target() - prediction)(rows)).cwiseAbs().maxCoeff(), 1e-12 * expected.norm())
        << "parameters and errors belong together";
  }
}

TEST(FitWithoutEach, OfALinearLawIsWhatFitsAloneAre) {
  const Made made = Make(test::DescribedAxis(), Axis());
  std::vector<Eigen::Index> rows;
  for (Eigen::Index n = 3; n < 800; n += 2) rows.push_back(n);
  ExpectTheFitsAlone(made, made.model->Start(), rows, {Places(0, 80), Places(100, 200), {5, 77, 300}, {}});
}

TEST(FitWithoutEach, GoesAsFarAsTheRemovalOfARegionAsksFor) {
  // What gives way at depth moves power and place a long way when the deepest rows are left out.
  const Made made = Bead(2e-11, 0.4);
  VectorXd start = made.model->Start();
  start << -3.0, 1.5, 2e-5, 0.0;
  ExpectTheFitsAlone(made, start, Places(0, 400),
                     {Places(0, 100), Places(210, 190), Places(240, 160), Places(300, 100), Places(150, 60)}, false);
}

TEST(FitWithoutEach, AStateIsSimulatedThroughTheRowsThatAreLeftOut) {
  Series series = Swing(400);
  for (std::size_t n = 0; n < 400; ++n) series.signals[1][n] += 0.01 * std::sin(1.7 * static_cast<double>(n));
  const Made made = Make(Oscillator(), std::move(series));
  ExpectTheFitsAlone(made, made.model->Start(), Places(0, 400), {Places(0, 150), Places(100, 50), Places(300, 100)});
}

TEST(TrajectoryModel, RowsThatAreNotWantedAreZeroAndTheOthersTheSame) {
  const Made made = Bead(1e-10);
  const VectorXd theta{{-3.0, 1.5, 2e-5, 1e-9}};
  const std::vector<Eigen::Index> wanted{0, 7, 8, 250, 251, 252, 253, 254, 255, 256, 257, 399};
  Eigen::MatrixXd some, all;
  made.model->Predict(theta, &some, &wanted);
  made.model->Predict(theta, &all);
  EXPECT_EQ(some(wanted, 0), all(wanted, 0));
  EXPECT_EQ(some(100, 0), 0.0);
}

}  // namespace
}  // namespace armcmc::identify::fit_test
