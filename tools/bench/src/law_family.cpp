#include "armcmc/bench/law_family.hpp"

#include <cmath>
#include <memory>
#include <numbers>
#include <stdexcept>

#include "armcmc/plant/program.hpp"
#include "armcmc/rng.hpp"
#include "armcmc/support/plant_file.hpp"

namespace armcmc::bench {
namespace {

constexpr double kNoise = 5e-3;  // N
constexpr double kK = 4.0, kB = 2.3, kP = 1.7, kFixedP = 1.5, kC = 0.2, kQ = 1.4, kM = 5e-3;

struct Sample {
  double x, v, a;
};

/// Two sines: with one alone, a is x again.
Sample Motion(double t) {
  Sample s{0.25, 0.0, 0.0};
  for (const auto& [stroke, frequency] : {std::pair{0.15, 2.7}, std::pair{0.05, 7.1}}) {
    const double rate = 2.0 * std::numbers::pi * frequency;
    s.x += stroke * std::sin(rate * t);
    s.v += stroke * rate * std::cos(rate * t);
    s.a -= stroke * rate * rate * std::sin(rate * t);
  }
  return s;
}

double Force(int num_parameters, const Sample& s) {
  const double p = num_parameters > 2 ? kP : kFixedP, q = num_parameters > 4 ? kQ : p;
  return kK * std::pow(s.x, p) + kB * s.v * std::pow(s.x, q) + (num_parameters > 3 ? kC : 0.0) +
         (num_parameters > 5 ? kM * s.a : 0.0);
}

}  // namespace

std::string LawText(int num_parameters) {
  if (num_parameters < kFewestLawParameters || num_parameters > kMostLawParameters)
    throw std::out_of_range("there is no law of " + std::to_string(num_parameters) + " parameters");
  std::string law = num_parameters == 2 ? "(K + B*v)*x^1.5" : num_parameters <= 4 ? "(K + B*v)*x^p" : "K*x^p + B*v*x^q";
  const std::string exponent = num_parameters == 2 ? "1.5" : "p";
  std::string parameters = "K = { unit = \"N/m^" + exponent +
                           "\", mean = 2.5, sd = 2.0, lower = 0.0, upper = 8.0 }\n"
                           "B = { unit = \"N s/m^" +
                           (num_parameters == 2 ? "2.5" : "(p+1)") +
                           "\", mean = 2.5, sd = 2.0, lower = 0.0, upper = 8.0 }\n";
  if (num_parameters > 2) parameters += "p = { unit = \"1\", mean = 1.5, sd = 0.35, lower = 1.0, upper = 2.5 }\n";
  if (num_parameters > 3) {
    law += " + c";
    parameters += "c = { unit = \"N\", mean = 0.0, sd = 0.5, lower = -2.0, upper = 2.0 }\n";
  }
  if (num_parameters > 4) parameters += "q = { unit = \"1\", mean = 1.5, sd = 0.35, lower = 1.0, upper = 2.5 }\n";
  if (num_parameters > 5) {
    law += " + m*a";
    parameters += "m = { unit = \"kg\", mean = 0.01, sd = 0.01, lower = 0.0, upper = 0.1 }\n";
  }
  return "schema = 1\nname = \"law_of_" + std::to_string(num_parameters) + "\"\noutput = \"f\"\n" +
         "[signals]\nx = { unit = \"m\", role = \"position\" }\nv = { unit = \"m/s\", role = \"velocity\" }\n"
         "a = { unit = \"m/s^2\", role = \"acceleration\" }\nf = { unit = \"N\", role = \"force\" }\n[parameters]\n" +
         parameters + "[[mode]]\nname = \"contact\"\nwhen = \"x >= 0\"\nlaw = \"" + law +
         "\"\n[[mode]]\nname = \"free\"\npassive = true\nlaw = \"0\"\n[noise]\nlaw = \"gaussian\"\nstd = " +
         std::to_string(kNoise) + "\n";
}

EstimatorSettings LawSettings(int num_parameters) {
  const std::string text = LawText(num_parameters);
  auto plant =
      std::make_shared<const armcmc::Plant>(support::PlantFromText(text, "law_of_" + std::to_string(num_parameters)));
  return DescribedSettings(std::make_shared<const PlantProgram>(std::move(plant)));
}

std::vector<DataPack> LawPacks(int num_parameters, const EstimatorSettings& settings, int count, int samples) {
  constexpr double kDt = 1e-3;
  std::vector<DataPack> packs(static_cast<std::size_t>(count));
  for (int index = 0; index < count; ++index) {
    DataPack& pack = packs[static_cast<std::size_t>(index)];
    pack.seq = index + 1;
    pack.run_id = 1;
    pack.dt = kDt;
    pack.plant = PlantNumber::kDescribed;
    pack.fingerprint = settings.plant->plant().fingerprint();
    pack.num_samples = samples;
    pack.num_inputs = 3;
    RandomStream stream(1, static_cast<std::uint64_t>(index), 0);
    for (int n = 0; n < samples; ++n) {
      const auto i = static_cast<std::size_t>(n);
      const double t = kDt * (index * samples + n);
      const Sample s = Motion(t);
      const double radius = std::sqrt(-2.0 * std::log(stream.Uniform()));
      const double normal = radius * std::cos(2.0 * std::numbers::pi * stream.Uniform());
      pack.u[i] = {s.x, s.v, s.a};
      pack.y[i] = Force(num_parameters, s) + kNoise * normal;
      pack.t_last_s = t;
    }
    pack.t_last_ns = static_cast<Nanos>(1e9 * pack.t_last_s);
  }
  return packs;
}

}  // namespace armcmc::bench
