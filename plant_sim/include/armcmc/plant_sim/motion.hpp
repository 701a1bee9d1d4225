#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "armcmc/plant_sim/options.hpp"

namespace armcmc::plant_sim {

/// The path that a motion follows, in units of its depth, before it is smoothed: 1 is the deepest, negative is free.
class Path {
 public:
  virtual ~Path() = default;
  /// Position at a time of the path (s); times never decrease. @rt No heap, no lock, no throw.
  [[nodiscard]] virtual double At(double time_s) noexcept = 0;
};

/// A smooth prescribed motion: a path, sampled at knots h apart and spread by quintic B-splines,
///
///   x(t) = depth sum_k path(pace k h) b(t / h - k),     v = dx/dt exactly, four times differentiable.
///
/// That is a low pass without phase, sinc(f h)^6, whose gain at the band limit is 1/sqrt(2).
class Motion {
 public:
  struct State {
    double x, v;  ///< m, m/s.
  };

  /// @param seed of the programs that draw; the others ignore it.
  Motion(const Options& options, std::uint64_t seed);

  /// Times never decrease and begin at t_s >= 0. @rt No heap, no lock, no throw. O(knots since the last time).
  [[nodiscard]] State At(double t_s) noexcept;

 private:
  static constexpr std::size_t kSupport = 6;  ///< Splines that are not zero at one time.

  std::unique_ptr<Path> path_;
  double depth_, pace_, spacing_;
  std::array<double, kSupport> knots_{};  ///< Path at the knots around the last time.
  long long first_ = 0;                   ///< Index of knots_[0], counted from two knots before t = 0.
};

/// program, depth, pace, band_hz, recording and recording_start_s of the table [motion].
[[nodiscard]] std::vector<OptionSpec> MotionOptions();
/// The path that the program of the options names.
/// @throws std::invalid_argument when the program is "recorded" without a recording, or another one with it.
[[nodiscard]] std::unique_ptr<Path> MakePath(const Options& options, std::uint64_t seed);

}  // namespace armcmc::plant_sim
