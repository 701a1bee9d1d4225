#include "armcmc/plant_sim/law_error.hpp"

#include <cmath>
#include <numbers>

#include "armcmc/plant_sim/rng.hpp"

namespace armcmc::plant_sim {
namespace {

constexpr std::uint64_t kLawStream = 0xf0;  // of the seed; nothing else draws from it
constexpr double kMostShare = 0.5;

}  // namespace

LawError::LawError(double share, std::uint64_t seed)
    : amplitude_(share * std::sqrt(2.0 / static_cast<double>(kNumWaves))) {
  Rng rng(seed, kLawStream);
  const auto wave_number = [&] { return 2.0 * std::numbers::pi * (2.0 * rng.Uniform() - 1.0); };
  for (Wave& wave : waves_) {
    wave.k = wave_number();
    wave.l = wave_number();
    wave.phase = 2.0 * std::numbers::pi * rng.Uniform();
  }
}

double LawError::Factor(double a, double b) const noexcept {
  if (amplitude_ == 0.0) return 1.0;
  double sum = 0.0;
  for (const Wave& wave : waves_) sum += std::cos(wave.k * a + wave.l * b + wave.phase);
  return 1.0 + amplitude_ * sum;
}

OptionSpec LawErrorOption() { return OptionSpec::Number("law", "error", 0.0, 0.0, kMostShare); }

}  // namespace armcmc::plant_sim
