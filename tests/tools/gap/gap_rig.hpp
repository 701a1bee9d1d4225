#pragma once

#include <memory>
#include <string>
#include <vector>

#include "armcmc/gap/equation.hpp"
#include "armcmc/gap/fit.hpp"
#include "armcmc/gap/recording.hpp"
#include "core/effects/contact_series.hpp"

namespace armcmc::gap::test {

/// A recording by column.
[[nodiscard]] Recording MakeRecording(const Vector& t, const Vector& x, const Vector& v, const Vector& f);

/// Standard normal numbers.
[[nodiscard]] Vector Noise(Eigen::Index rows, unsigned seed);

/// A simulated series as it is measured, its force with white noise.
[[nodiscard]] Recording RecordingOf(const armcmc::test::Series& series, double noise_sd, unsigned seed);

struct Made {
  Recording recording;
  Vector clean;  ///< Force without noise, N.
};

/// A contact of K = 4, B = 2.3, p = 1.7 with the effects in it: taps of several depths, free motion between them. The
/// force is that of the textbook formulas of armcmc::test::Simulate, which share nothing with the library.
[[nodiscard]] Made Measure(const std::vector<armcmc::test::HiddenEffect>& effects, int rows, double noise_sd,
                           unsigned seed, double dt = 1e-3);

/// The catalogue's values of an effect, in SI units.
[[nodiscard]] armcmc::test::HiddenEffect Hidden(const std::string& name);

/// A recording as the contact equation sees it, and its catalogue.
struct Bench {
  explicit Bench(Recording recording, int window = 15);

  [[nodiscard]] const EffectForm& Form(const std::string& effect, const std::string& variant = "") const;
  /// The base model alone.
  [[nodiscard]] Fitted Base(const Fitter& fitter) const { return fitter.Fit({}, equation->Start(signals), 30); }

  std::unique_ptr<Equation> equation;
  Recording recording;
  Signals signals;
  std::vector<EffectForm> catalogue;
};

/// Noise model of white noise of that standard deviation.
[[nodiscard]] Whitener White(double sd);

}  // namespace armcmc::gap::test
