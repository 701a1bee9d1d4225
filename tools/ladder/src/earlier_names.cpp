#include "earlier_names.hpp"

#include <algorithm>

#include "rung.hpp"

namespace armcmc::ladder {

const Candidate* EarlierNames::Like(const EffectEntry& entry) const {
  const auto alike = std::find_if(effects.begin(), effects.end(),
                                  [&](const Candidate* named) { return AreKin(*named->entry, entry); });
  return alike == effects.end() ? nullptr : *alike;
}

bool EarlierNames::FormulaErrorExplains(const Contender& c) const {
  constexpr double kFormulaError = 1.0 / 3.0;  // of the amplitude: formulas for the same physics differ by this much
  return 1.0 - c.alone.folds < kFormulaError * kFormulaError * explained &&
         std::none_of(effects.begin(), effects.end(),
                      [&](const Candidate* e) { return e->entry->family == c.candidate.entry->family; });
}

}  // namespace armcmc::ladder
