#include "repeated.hpp"

#include <algorithm>
#include <set>
#include <vector>

#include "armcmc/gap/effect_words.hpp"
#include "one_equation.hpp"

namespace armcmc::ladder {
namespace {

/// "h1 and h2": the signals, states and parameters that an effect is attached to.
std::string Quantities(const Candidate& effect) {
  std::set<std::string> names;
  for (const auto& [need, name] : effect.binding.symbols) names.insert(name);
  return JoinedWords({names.begin(), names.end()}, " and ");
}

template <class T>
bool AllDiffer(const std::vector<T>& values) {
  return std::set<T>(values.begin(), values.end()).size() == values.size();
}

std::string Reason(const std::vector<const Candidate*>& copies) {
  std::vector<std::string> quantities;
  std::vector<std::size_t> forms;
  for (const Candidate* copy : copies) {
    quantities.push_back(Quantities(*copy));
    forms.push_back(copy->binding.form);
  }
  if (AllDiffer(quantities) && std::find(quantities.begin(), quantities.end(), "") == quantities.end())
    return "it acts on " + JoinedWords(quantities, ", then on ");
  if (AllDiffer(forms)) return "each has another formula of it, since one alone leaves a part unexplained";
  return "the formula fitted once leaves a part that the same formula with other values explains";
}

}  // namespace

std::string WhyRepeated(const Ladder& ladder) {
  std::vector<const EffectEntry*> explained;
  std::string words;
  for (const Rung& first : ladder.rungs) {
    if (first.named.empty()) continue;
    const EffectEntry* entry = first.leader().candidate.entry;
    if (std::find(explained.begin(), explained.end(), entry) != explained.end()) continue;
    explained.push_back(entry);
    std::vector<const Candidate*> copies;
    for (const Rung& rung : ladder.rungs)
      if (!rung.named.empty() && rung.leader().candidate.entry == entry) copies.push_back(&rung.leader().candidate);
    if (copies.size() < 2) continue;
    const std::string times = copies.size() == 2 ? "twice" : std::to_string(copies.size()) + " times";
    words.append(" The effect ")
        .append(gap::EffectInSentence(entry->name))
        .append(" appears ")
        .append(times)
        .append(" because it was added ");
    words.append(times).append(", each time with its own parameters: ").append(Reason(copies)).append(".");
  }
  return words;
}

}  // namespace armcmc::ladder
