#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace armcmc::expression {

/// The operations of an expression. Text (Syntax), graph (Graph) and compiled program (Tape) share this list. Arguments
/// a, b, c are in the order in which they are written; conditions are numbers, 0 or 1.
enum class Op : std::uint8_t {
  kNumber,  ///< A literal.
  kSymbol,  ///< A signal, parameter, state, constant or time.
  kAdd,
  kSubtract,
  kMultiply,
  kDivide,
  kPower,      ///< a ^ b.
  kNegate,     ///< -a.
  kLess,       ///< a < b; a > b is written with the arguments exchanged.
  kLessEqual,  ///< a <= b.
  kEqual,      ///< a == b.
  kNotEqual,   ///< a != b.
  kAnd,        ///< Both conditions hold.
  kOr,         ///< At least one condition holds.
  kNot,
  kAbs,
  kSign,  ///< -1, 0, 1.
  kSqrt,
  kExp,
  kLog,  ///< Natural logarithm.
  kLog2,
  kLog10,
  kSin,  ///< Argument in rad, as for all angles.
  kCos,
  kTan,
  kAsin,
  kAcos,
  kAtan,  ///< Result in rad, as of kAsin and kAcos.
  kTanh,
  kMin,    ///< The smaller of a and b.
  kMax,    ///< The larger of a and b.
  kClamp,  ///< clamp(x, lower, upper).
  kStep,   ///< 1 from 0 on, 0 below.
  kIf,     ///< if(condition, then, else).
  // With memory. All are exact for arguments that are linear between samples.
  kLowpass,   ///< lowpass(e, tau): tau y' = e - y, y = e at the first sample.
  kDelay,     ///< delay(e, tau): e at t - tau, e of the first sample before it.
  kIntegral,  ///< integral(e): from 0 at the first sample.
  kPrevious,  ///< previous(e): e one sample earlier, e at the first sample.
  kElapsed,   ///< elapsed(): s since the first sample.
  // In graphs only.
  kPast,  ///< Value of a line of kept samples, b samples before place a of it.
};

/// Largest number of arguments of an operation.
inline constexpr int kMaxArguments = 3;

/// Properties of an operation, for parser, checker and messages.
struct OpInfo {
  std::string_view name;  ///< Name of a function, or sign of an operator.
  int arguments;          ///< Number of arguments, 0 to kMaxArguments.
  bool function;          ///< Written name(arguments).
  bool condition;         ///< True or false: 1 or 0 where a number is expected.
  bool memory;            ///< Depends on earlier samples.
};

/// Properties of all operations, in the order of Op.
inline constexpr std::array<OpInfo, 40> kOps{{
    {"number", 0, false, false, false}, {"name", 0, false, false, false},   {"+", 2, false, false, false},
    {"-", 2, false, false, false},      {"*", 2, false, false, false},      {"/", 2, false, false, false},
    {"^", 2, false, false, false},      {"-", 1, false, false, false},      {"<", 2, false, true, false},
    {"<=", 2, false, true, false},      {"==", 2, false, true, false},      {"!=", 2, false, true, false},
    {"and", 2, false, true, false},     {"or", 2, false, true, false},      {"not", 1, false, true, false},
    {"abs", 1, true, false, false},     {"sign", 1, true, false, false},    {"sqrt", 1, true, false, false},
    {"exp", 1, true, false, false},     {"log", 1, true, false, false},     {"log2", 1, true, false, false},
    {"log10", 1, true, false, false},   {"sin", 1, true, false, false},     {"cos", 1, true, false, false},
    {"tan", 1, true, false, false},     {"asin", 1, true, false, false},    {"acos", 1, true, false, false},
    {"atan", 1, true, false, false},    {"tanh", 1, true, false, false},    {"min", 2, true, false, false},
    {"max", 2, true, false, false},     {"clamp", 3, true, false, false},   {"step", 1, true, false, false},
    {"if", 3, true, false, false},      {"lowpass", 2, true, false, true},  {"delay", 2, true, false, true},
    {"integral", 1, true, false, true}, {"previous", 1, true, false, true}, {"elapsed", 0, true, false, true},
    {"past", 2, false, false, false},
}};
static_assert(kOps.size() == static_cast<std::size_t>(Op::kPast) + 1);

/// Properties of an operation. @rt No heap, no lock, no throw. O(1).
[[nodiscard]] constexpr const OpInfo& InfoOf(Op op) noexcept { return kOps[static_cast<std::size_t>(op)]; }

}  // namespace armcmc::expression
