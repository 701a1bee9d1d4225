#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "armcmc/plant_sim/described_plant.hpp"
#include "armcmc/plant_sim/expression/expression.hpp"
#include "armcmc/plant_sim/expression/jet.hpp"

namespace armcmc::plant_sim {

/// How an input of a described plant moves, around `offset`:
///
///   sine       amplitude sin(2 pi frequency_hz t)
///   multisine  12 sines of random phase up to bandwidth_hz; its rms is half the amplitude, which is about its peak
///   chirp      amplitude sin, from frequency_hz at the start to bandwidth_hz at the end
///   steps      a level drawn from [-amplitude, amplitude] frequency_hz times a second; its derivatives are 0
///   expression of t and the plant's constants
///   state      the value of a state of the plant, offset and amplitude unused
struct InputProgram {
  enum class Kind : std::uint8_t { kMultisine, kSine, kChirp, kSteps, kExpression, kState };
  Kind kind = Kind::kMultisine;
  double amplitude = 1.0, offset = 0.0;
  double frequency_hz = 1.0, bandwidth_hz = 2.0;
  std::string text;  ///< Expression, or the name of the state.
};

/// An input as a function of time with exact derivatives.
class InputSignal {
 public:
  /// @param key  Of the expression, in errors. @throws DescribedError.
  InputSignal(const InputProgram& program, const DescribedPlant& plant, const std::string& key, double duration_s,
              std::uint64_t seed, std::uint64_t stream);

  /// Value and three derivatives at t (s).
  [[nodiscard]] expression::Jet At(double t);

 private:
  struct Line {
    double amplitude, omega, phase;
  };
  [[nodiscard]] double Level(double t) const;

  InputProgram program_;
  std::vector<Line> lines_;
  double sweep_ = 0.0;  ///< rad/s^2, of a chirp.
  std::uint64_t seed_, stream_;
  expression::Expression expression_;
  std::vector<double> values_;
};

}  // namespace armcmc::plant_sim
