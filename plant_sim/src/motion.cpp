#include "armcmc/plant_sim/motion.hpp"

#include <algorithm>
#include <cmath>

namespace armcmc::plant_sim {
namespace {

using Weights = std::array<double, 6>;

/// Quintic cardinal B-splines that overlap between two knots, at the share s in [0, 1) of the way.
Weights Spline(double s) noexcept {
  const double r = 1.0 - s, s2 = s * s, s3 = s2 * s, s4 = s2 * s2, s5 = s4 * s;
  return {r * r * r * r * r / 120.0,
          (26.0 - 50.0 * s + 20.0 * s2 + 20.0 * s3 - 20.0 * s4 + 5.0 * s5) / 120.0,
          (66.0 - 60.0 * s2 + 30.0 * s4 - 10.0 * s5) / 120.0,
          (26.0 + 50.0 * s + 20.0 * s2 - 20.0 * s3 - 20.0 * s4 + 10.0 * s5) / 120.0,
          (1.0 + 5.0 * s + 10.0 * s2 + 10.0 * s3 + 5.0 * s4 - 5.0 * s5) / 120.0,
          s5 / 120.0};
}

/// Their derivatives with respect to s.
Weights SplineSlope(double s) noexcept {
  const double r = 1.0 - s, s2 = s * s, s3 = s2 * s, s4 = s2 * s2;
  return {-r * r * r * r / 24.0,
          (-10.0 + 8.0 * s + 12.0 * s2 - 16.0 * s3 + 5.0 * s4) / 24.0,
          (-24.0 * s + 24.0 * s3 - 10.0 * s4) / 24.0,
          (10.0 + 8.0 * s - 12.0 * s2 - 16.0 * s3 + 10.0 * s4) / 24.0,
          (1.0 + 4.0 * s + 6.0 * s2 + 4.0 * s3 - 5.0 * s4) / 24.0,
          s4 / 24.0};
}

/// sinc(f h)^6 = 1/sqrt(2) at f h = this.
constexpr double kKnotsPerBand = 0.18634;

}  // namespace

Motion::Motion(const Options& options, std::uint64_t seed)
    : path_(MakePath(options, seed)),
      depth_(options.Number("depth")),
      pace_(options.Number("pace")),
      spacing_(kKnotsPerBand / options.Number("band_hz")) {
  for (std::size_t j = 0; j < kSupport; ++j) knots_[j] = path_->At(static_cast<double>(j) * spacing_ * pace_);
}

Motion::State Motion::At(double t_s) noexcept {
  const double place = t_s / spacing_;
  const double cell = std::floor(place);
  for (; first_ < static_cast<long long>(cell); ++first_) {
    std::copy(knots_.begin() + 1, knots_.end(), knots_.begin());
    const auto last = static_cast<double>(first_ + static_cast<long long>(kSupport));
    knots_.back() = path_->At(last * spacing_ * pace_);
  }
  const Weights weight = Spline(place - cell), slope = SplineSlope(place - cell);
  State state{0.0, 0.0};
  for (std::size_t j = 0; j < kSupport; ++j) {
    state.x += knots_[j] * weight[j];
    state.v += knots_[j] * slope[j];
  }
  return {depth_ * state.x, depth_ / spacing_ * state.v};
}

std::vector<OptionSpec> MotionOptions() {
  return {OptionSpec::Choice("motion", "program",
                             {"rich", "sine", "slow_triangle", "fast_taps", "step_hold", "taps_of_depths",
                              "contact_chirp", "free_air_chirp", "free_air", "strokes", "recorded"}),
          OptionSpec::Number("motion", "depth", 1.0, 1e-9, 100.0),
          OptionSpec::Number("motion", "pace", 1.0, 1e-3, 1e3),
          OptionSpec::Number("motion", "band_hz", 14.0, 0.1, 1e3),
          OptionSpec::Series("motion", "recording", "x"),
          OptionSpec::Number("motion", "recording_start_s", 0.0, 0.0, 1e6)};
}

}  // namespace armcmc::plant_sim
