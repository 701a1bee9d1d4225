#pragma once

#include "armcmc/ladder/climb.hpp"

namespace armcmc::ladder {

inline constexpr double kLeastGain = 0.1;    // share of the squared error that a named effect must remove
inline constexpr double kLargerPart = 0.5;   // share, apart from the noise, that the first effect of a family may leave
inline constexpr double kFarBetter = 2.0;    // factor by which a larger effect must beat a simpler one
inline constexpr double kAsGood = 0.95;      // of the best's gain: a simpler effect that reaches it comes first
inline constexpr double kExplainsIt = 1.05;  // squared error of a rival that explains as much, over that of an effect

/// Mean squared error of the fit.
[[nodiscard]] inline double MeanSquare(const Trial& trial) { return trial.fit.error_sd * trial.fit.error_sd; }

/// Number of parameters that its effect adds.
[[nodiscard]] inline int NumParameters(const Contender& c) { return NumFormulaParameters(c.candidate.form()); }

/// Error of a contender on left-out rows, relative to its base model.
/// @param with_flexible  With the flexible function added to both.
[[nodiscard]] Comparison Compare(const View& view, const Contender& c, const Trial& base_trial, bool with_flexible);

/// "leaves 4.5 times less squared error on data left out"
[[nodiscard]] std::string LeavesLessText(double times);

/// Whether `a` has less error than `b` in folds, blocks and regions.
[[nodiscard]] bool BetterEverywhere(const Contender& a, const Contender& b);

/// Whether `a` has less error than `b` on long blocks and on regions, where short segments between fitted ones may
/// prefer `b`.
[[nodiscard]] bool ExtrapolatesBetter(const Contender& a, const Contender& b);

/// Share of the remaining squared error that a flexible function removes, from the folds.
[[nodiscard]] double FlexibleGain(const View& view, const Trial& trial);

/// Squared error of a model that is noise, as estimated from neighbouring samples, but not more than a flexible
/// function leaves.
[[nodiscard]] double NoiseIn(const View& view, const Trial& trial, double floor);

/// Squared error of a model, divided by the variance of what it explains.
[[nodiscard]] double UnexplainedShare(const View& view, const Trial& trial);

/// Whether a model errs by more than the output varies, so that a constant would do better.
[[nodiscard]] bool WorseThanConstant(const View& view, const Trial& trial);

/// Whether a trial leaves more than noise: a flexible function reduces the error, or the error exceeds the noise. An
/// excess of a few percent is accepted if the errors decorrelate within a tenth of the period.
/// @param floor  Standard deviation of the noise; 0: unknown.
[[nodiscard]] bool LeavesMore(const View& view, const Trial& trial, double floor);

}  // namespace armcmc::ladder
