#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "armcmc/expression/features.hpp"
#include "armcmc/mode_data.hpp"
#include "armcmc/nonblocking.hpp"
#include "armcmc/types.hpp"

namespace armcmc::expression {

inline constexpr int kMaxTapeInstructions = 384;
inline constexpr int kMaxTapeRegisters = 128;
inline constexpr int kMaxTapeScalars = 48;  ///< Numbers per sample, constants included.
inline constexpr int kMaxTapeResults = 8;   ///< As many as there may be states.

/// What one instruction does with all candidates of a tile. R: a register, one number per candidate; S: a scalar,
/// one number per sample.
enum class TapeOp : std::uint8_t {
  kSplat,         ///< R = S a
  kCopy,          ///< R = R a
  kLinear,        ///< R = S a + sum of `b` terms S x R, which follow, two per instruction
  kAddLinear,     ///< R = R a + sum of `b` terms
  kAdd,           ///< R = R a + R b
  kSubtract,      ///< R = R a - R b
  kMultiply,      ///< R = R a x R b
  kMultiplyAdd,   ///< R = R a x R b + R c
  kAddProduct,    ///< R = R a + R b x R c
  kTakeProduct,   ///< R = R c - R a x R b
  kLessProduct,   ///< R = R a - R b x R c
  kScale,         ///< R = R a x S b
  kScaleAdd,      ///< R = R a x S c + R b
  kMultiplyAddS,  ///< R = R a x R b + S c
  kDivide,        ///< R = R a / R b
  kNegate,
  kReciprocal,
  kAbs,
  kSign,
  kSqrt,
  kExp,
  kExp2S,  ///< R = 2^(R a x S b): a power of a number known per sample
  kLog,
  kLog2,
  kLog10,
  kPower,     ///< R = R a ^ R b; not a number where R a is negative
  kPowerInt,  ///< R = R a ^ b, b a small whole number
  kSin,
  kCos,
  kTan,
  kAsin,
  kAcos,
  kAtan,
  kTanh,
  kMin,
  kMax,
  kMinS,  ///< R = the smaller one of R a and S b, a number
  kMaxS,
  kStep,
  kLess,  ///< Conditions: 1 or 0.
  kLessEqual,
  kEqual,
  kNotEqual,
  kAnd,
  kOr,
  kNot,
  kSelect,  ///< R = R a != 0 ? R b : R c
  kPast,    ///< R = what was kept R a samples before place S b of its line
};

/// If R a is the result of the previous instruction, it is still in a processor register and is not loaded; a result
/// that no later instruction reads is not stored. In a chain of operations, memory accesses dominate the cost.
struct TapeInstruction {
  TapeOp op = TapeOp::kCopy;
  bool loads = false;   ///< R a comes from its register; else it is already loaded, or there is none.
  bool stores = false;  ///< The result goes to its register.
  std::uint8_t to = 0, a = 0, b = 0, c = 0;
};

/// Forms of code that have a loop of their own, in which all values stay in registers.
enum class TapeShape : std::uint8_t {
  kGeneral,
  kLinear,  ///< scalar + sum of scalars x parameters or states.
  kPower,   ///< One or two of 2^(parameter x scalar) x (scalar + sum), + scalar + sum.
};
inline constexpr int kMaxShapeTerms = 8;   ///< Terms in each sum of a shape.
inline constexpr int kMaxShapePowers = 2;  ///< Powers in a shape.

/// scalar `constant` + sum of scalars x parameters or states.
struct TapeSum {
  static constexpr std::uint8_t kNone = 255;  ///< As a constant 0, as a scalar 1.
  std::uint8_t constant = kNone;
  std::uint8_t count = 0;
  std::array<std::uint8_t, kMaxShapeTerms> parameter{};  ///< Register of it.
  std::array<std::uint8_t, kMaxShapeTerms> scalar{};     ///< kNone: 1.
};

/// 2^(parameter x scalar) x factor.
struct TapePower {
  TapeSum factor;
  std::uint8_t exponent = 0, log2 = 0;  ///< Parameter and scalar.
};

/// Straight-line code for all candidates of a tile at one sample. Registers 0 to num_parameters - 1 hold the
/// parameters, the next num_states the states; both may be read only, but for states that are results.
struct Tape {
  std::vector<TapeInstruction> code;
  int once = 0;  ///< The first instructions need no sample: they run once per tile.
  int num_parameters = 0;
  int num_states = 0;
  int num_registers = 0;                               ///< At most kMaxTapeRegisters, parameters and states included.
  int num_scalars = 0;                                 ///< At most kMaxTapeScalars.
  int num_results = 0;                                 ///< At most kMaxTapeResults.
  std::array<std::uint8_t, kMaxTapeResults> result{};  ///< Registers.

  TapeShape shape = TapeShape::kGeneral;  ///< Form of the first result.
  TapeSum rest;                           ///< kLinear: `rest` alone.
  int num_powers = 0;
  std::array<TapePower, kMaxShapePowers> power{};
  double largest_exponent = 1e300;  ///< Upper bound of the magnitude of all, if known when the tape is made.

  /// Instructions per sample.
  [[nodiscard]] int size() const noexcept { return static_cast<int>(code.size()) - once; }
};

/// Lines of kept samples, one behind the other: in a line entry 0 is what is further back than the line, NaN where that
/// is no longer known; then the samples before the pack, the newest at kMaxDelaySamples; then those of the pack.
struct PastLines {
  static constexpr int kLength = 1 + kMaxDelaySamples + kMaxPackSamples;
  alignas(64) std::array<double, static_cast<std::size_t>(kMaxDelays) * kLength> value;

  /// Place of sample n of the pack, from -1 for the last one before it, in a line.
  [[nodiscard]] static constexpr int Place(int line, int n) noexcept {
    return line * kLength + 1 + kMaxDelaySamples + n;
  }
};

/// The scalars of the samples of one pack: row n holds those of sample n.
struct TapeScalars {
  int stride = 0;  ///< Scalars of one sample.
  alignas(64) std::array<double, static_cast<std::size_t>(kMaxPackSamples) * kMaxTapeScalars> value;

  /// Scalars of sample n, `stride` of them. @pre 0 <= n < kMaxPackSamples.
  [[nodiscard]] const double* Row(int n) const noexcept { return value.data() + n * stride; }
  [[nodiscard]] double* Row(int n) noexcept { return value.data() + n * stride; }
};

}  // namespace armcmc::expression
