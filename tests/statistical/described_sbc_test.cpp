#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <vector>

#include "armcmc/adjust_result.hpp"
#include "armcmc/estimator.hpp"
#include "armcmc/parameter_space.hpp"
#include "armcmc/support/plant_file.hpp"
#include "support/packs.hpp"
#include "support/paths.hpp"

namespace armcmc::described_sbc_test {
namespace {

using test::Normal;

constexpr int kBins = 20;
constexpr int kRanks = 199;  // thinned draws; ranks 0..199 fill 20 bins of 10
constexpr int kSamples = 50;

/// Input and output of a plant that no file knows about, from sample to sample.
using Plant = std::function<void(const std::vector<double>& theta, double t, std::vector<double>* u, double* y)>;

struct Case {
  const char* name;
  double dt;
  /// Of each parameter: the priors of the files are for first trials on anything.
  std::vector<std::pair<double, double>> mean_sd;
  double noise_std;
  /// A new run of the plant: its inputs by `normal`.
  std::function<Plant(Normal* normal, double dt)> start;
};

struct Wave {
  explicit Wave(Normal* normal, double amplitude, double rad_s) {
    for (int i = 0; i < 3; ++i) {
      a[i] = amplitude * (0.3 + normal->Uniform());
      w[i] = rad_s * (0.5 + 1.5 * normal->Uniform());
      phase[i] = 6.28 * normal->Uniform();
    }
  }
  /// The wave and its derivative.
  [[nodiscard]] std::array<double, 2> At(double t) const {
    std::array<double, 2> value{};
    for (int i = 0; i < 3; ++i) {
      value[0] += a[i] * std::sin(w[i] * t + phase[i]);
      value[1] += a[i] * w[i] * std::cos(w[i] * t + phase[i]);
    }
    return value;
  }
  double a[3], w[3], phase[3];
};

/// Two states, place and speed, with an acceleration of the input; output the place.
Plant Moving(Normal* normal, double amplitude, double rad_s, double dt, int substeps,
             std::function<double(const std::vector<double>&, double x, double v, double u)> acceleration) {
  struct Run {
    Wave wave;
    double x = 0.0, v = 0.0;
    bool first = true;
  };
  auto run = std::make_shared<Run>(Run{Wave(normal, amplitude, rad_s)});
  return [=](const std::vector<double>& theta, double t, std::vector<double>* u, double* y) {
    const double u1 = run->wave.At(t)[0];
    const double u0 = run->wave.At(t - dt)[0];
    const double h = dt / substeps;
    for (int i = 0; i < substeps && !run->first; ++i) {
      const auto rate = [&](double x, double v, double part) {
        return std::array<double, 2>{v, acceleration(theta, x, v, u0 + (i + part) / substeps * (u1 - u0))};
      };
      const auto k1 = rate(run->x, run->v, 0.0);
      const auto k2 = rate(run->x + h / 2 * k1[0], run->v + h / 2 * k1[1], 0.5);
      const auto k3 = rate(run->x + h / 2 * k2[0], run->v + h / 2 * k2[1], 0.5);
      const auto k4 = rate(run->x + h * k3[0], run->v + h * k3[1], 1.0);
      run->x += h / 6 * (k1[0] + 2 * k2[0] + 2 * k3[0] + k4[0]);
      run->v += h / 6 * (k1[1] + 2 * k2[1] + 2 * k3[1] + k4[1]);
    }
    run->first = false;
    *u = {u1};
    *y = run->x;
  };
}

const std::vector<Case> kCases = {
    {"servo_axis",
     0.01,
     {{90.0, 30.0}, {200.0, 100.0}, {0.0, 10.0}},
     5.0,
     [](Normal* normal, double) -> Plant {
       return [wave = Wave(normal, 0.1, 5.0)](const std::vector<double>& theta, double t, std::vector<double>* u,
                                              double* y) {
         const double a = (wave.At(t + 1e-5)[1] - wave.At(t - 1e-5)[1]) / 2e-5;
         *u = {wave.At(t)[0], wave.At(t)[1], a};
         *y = theta[0] * a + theta[1] * wave.At(t)[1] + theta[2];
       };
     }},
    {"oscillator",
     1.0 / 610.0,
     {{std::log(5e-6), 0.4}, {2e-4, 1e-4}, {1.0, 0.3}},
     0.002,
     [](Normal* normal, double dt) {
       return Moving(normal, 0.05, 200.0, dt, 2, [](const std::vector<double>& theta, double x, double v, double u) {
         return (u - theta[1] * v - theta[2] * x) / std::exp(theta[0]);
       });
     }},
    {"pendulum",
     0.01,
     {{40.0, 10.0}, {0.8, 0.4}, {10.0, 4.0}},
     0.01,
     [](Normal* normal, double dt) {
       return Moving(normal, 0.7, 4.0, dt, 1, [](const std::vector<double>& theta, double x, double v, double u) {
         return theta[2] * u - theta[1] * v - theta[0] * std::sin(x);
       });
     }},
};

using Histogram = std::array<int, kBins>;

/// Rank histograms of simulation-based calibration (Talts et al. 2018), one a parameter, of the sampled parameters.
std::vector<Histogram> RankHistograms(const Case& c, int simulations, int packs, std::uint64_t seed) {
  const auto plant = support::ReadPlantProgram(test::SourceDir() / "core/plants" / c.name / "plant.toml");
  EstimatorSettings settings = DescribedSettings(plant);
  const std::size_t dim = c.mean_sd.size();
  for (std::size_t d = 0; d < dim; ++d) {
    settings.parameters[d].mean = c.mean_sd[d].first;
    settings.parameters[d].sd = c.mean_sd[d].second;
  }
  for (NoiseSettings& noise : settings.noise) {
    noise.std = c.noise_std;
    noise.estimate_std = false;
  }
  settings.sampler.seed = seed;
  std::vector<Histogram> histograms(dim);
  Normal normal(seed);
  Estimator estimator(settings);
  const auto result = estimator.MakeResult();
  const ParameterSpace space(settings, settings.noise[0]);
  for (int sim = 0; sim < simulations; ++sim) {
    estimator.Reset();
    std::vector<double> theta(dim);
    for (std::size_t d = 0; d < dim; ++d) {
      const ParameterSettings& p = settings.parameters[d];
      do theta[d] = p.mean + p.sd * normal();
      while (theta[d] < p.lower || theta[d] > p.upper);
    }
    const Plant run = c.start(&normal, c.dt);
    for (int k = 1; k <= packs; ++k) {
      DataPack pack = test::BlankPack(PlantNumber::kDescribed, sim * packs + k, kSamples, c.dt);
      pack.num_inputs = plant->info().num_inputs;
      pack.fingerprint = plant->plant().fingerprint();
      pack.t_last_s = k * kSamples * c.dt;
      for (std::size_t n = 0; n < kSamples; ++n) {
        std::vector<double> u;
        run(theta, ((k - 1) * kSamples + static_cast<int>(n)) * c.dt, &u, &pack.y[n]);
        std::copy(u.begin(), u.end(), pack.u[n].begin());
        pack.y[n] += c.noise_std * normal();
      }
      EXPECT_NE(estimator.Adjust(pack, 0, {}, result.get()), Status::kBadPack);
    }
    const ModeDraws& draws = result->modes[0];
    const int first = draws.burn_in;
    for (std::size_t d = 0; d < dim; ++d) {
      int rank = 0;
      for (int i = 0; i < kRanks; ++i) {
        const int at = first + static_cast<int>((static_cast<long>(draws.draws - first) * i) / kRanks);
        if (space.Theta(static_cast<int>(d), draws.u[d][draws.chain[at]]) < theta[d]) ++rank;
      }
      ++histograms[d][static_cast<std::size_t>(rank * kBins / (kRanks + 1))];
    }
  }
  return histograms;
}

double ChiSquare(const Histogram& counts) {
  double total = 0.0;
  for (const int c : counts) total += c;
  double chi2 = 0.0;
  for (const int c : counts) chi2 += (c - total / kBins) * (c - total / kBins) / (total / kBins);
  return chi2;
}

// Quantile 1 - 1e-4 / 9 of chi-square with 19 degrees of freedom.
constexpr double kPass = 55.6;

class DescribedCalibration : public ::testing::TestWithParam<std::size_t> {};

TEST_P(DescribedCalibration, RanksOfTheFirstPackAreUniform) {
  for (const Histogram& h : RankHistograms(kCases[GetParam()], 200, 1, 21)) EXPECT_LT(ChiSquare(h), kPass);
}

class DescribedRecursion : public ::testing::TestWithParam<std::size_t> {};

TEST_P(DescribedRecursion, RanksAfterThreePacksAreUniform) {
  for (const Histogram& h : RankHistograms(kCases[GetParam()], 250, 3, 22)) EXPECT_LT(ChiSquare(h), kPass);
}

class LongDescribedCalibration : public ::testing::TestWithParam<std::size_t> {};

TEST_P(LongDescribedCalibration, RanksOfTheFirstPackAreUniform) {
  for (const Histogram& h : RankHistograms(kCases[GetParam()], 1000, 1, 23)) EXPECT_LT(ChiSquare(h), kPass);
}

std::string NameOf(const ::testing::TestParamInfo<std::size_t>& info) { return kCases[info.param].name; }

INSTANTIATE_TEST_SUITE_P(Plants, DescribedCalibration, ::testing::Range<std::size_t>(0, kCases.size()), NameOf);
INSTANTIATE_TEST_SUITE_P(Plants, LongDescribedCalibration, ::testing::Range<std::size_t>(0, kCases.size()), NameOf);
// The recursion is the same for all; one that is linear is sampled in a tenth of the time.
INSTANTIATE_TEST_SUITE_P(Linear, DescribedRecursion, ::testing::Values<std::size_t>(0), NameOf);
INSTANTIATE_TEST_SUITE_P(LongWithStates, DescribedRecursion, ::testing::Range<std::size_t>(1, kCases.size()), NameOf);

}  // namespace
}  // namespace armcmc::described_sbc_test
