#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "armcmc/gap/effect_words.hpp"
#include "armcmc/gap/result.hpp"

// Texts of the report. Return values are HTML unless marked plain text.
namespace armcmc::gap {

/// "coulomb_friction from 4.25 s" -> "Coulomb friction from 4.25 s". Plain text.
[[nodiscard]] std::string EffectTitle(std::string_view name);

/// "Coulomb friction + sensor lag"; "nothing" for no effect. Plain text.
[[nodiscard]] std::string EffectTitles(const std::vector<std::string>& names);

/// "coulomb_friction + sensor_lag" -> "Coulomb friction + sensor lag", "sensor_lag" -> "sensor lag": for the middle of
/// a sentence. Plain text.
[[nodiscard]] std::string InSentence(std::string_view names);

/// How an effect of the catalogue changes the equations, and one sentence that explains it. Empty for unknown effects.
struct EffectWords {
  std::string_view formula;
  std::string_view meaning;
};
[[nodiscard]] EffectWords WordsOf(std::string_view name);

/// "in contact only", "from t = 4.250 s on".
[[nodiscard]] std::string WhenText(const When& when);

/// Mean with unit: as many digits as the sd justifies.
[[nodiscard]] std::string MeanText(const ParameterEstimate& p);
/// "0.392 to 0.432", the central 95 % of a normal distribution; "held fixed" for sd 0, "not known" without;
/// "confounded with a, b" where those could make up for a change of it.
[[nodiscard]] std::string IntervalText(const ParameterEstimate& p);

/// Number and unit, escaped.
[[nodiscard]] std::string WithUnit(double value, int digits, std::string_view unit);

/// Interpretation of the share of samples inside the 95 % band.
[[nodiscard]] std::string CoverageReading(double coverage);
/// Interpretation of a Ljung-Box statistic divided by its degrees of freedom.
[[nodiscard]] std::string WhitenessReading(double whiteness);

}  // namespace armcmc::gap
