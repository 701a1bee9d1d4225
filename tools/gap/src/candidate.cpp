#include <algorithm>
#include <cstddef>

#include "armcmc/gap/search.hpp"

namespace armcmc::gap {

std::vector<Term> Candidate::added() const {
  return {fit.hypothesis.terms.begin() + static_cast<std::ptrdiff_t>(num_known), fit.hypothesis.terms.end()};
}

std::vector<std::string> Candidate::names() const {
  std::vector<std::string> names;
  for (const Term& term : added()) names.push_back(term.form->effect);
  std::sort(names.begin(), names.end());
  return names;
}

std::vector<std::string> Candidate::families() const {
  std::vector<std::string> families;
  for (const Term& term : added()) families.push_back(term.form->family);
  std::sort(families.begin(), families.end());
  return families;
}

bool Candidate::exact() const {
  const std::vector<Term> effects = added();
  return std::all_of(effects.begin(), effects.end(), [](const Term& term) { return term.form->exact(); });
}

bool Candidate::always() const {
  const std::vector<Term> effects = added();
  return std::all_of(effects.begin(), effects.end(),
                     [](const Term& term) { return term.when.kind == When::Kind::kAlways; });
}

void SortByScore(std::vector<CandidatePtr>* candidates) {
  std::stable_sort(candidates->begin(), candidates->end(),
                   [](const auto& a, const auto& b) { return a->fit.score() > b->fit.score(); });
}

}  // namespace armcmc::gap
