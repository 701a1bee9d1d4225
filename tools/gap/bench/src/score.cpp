#include "armcmc/gap_bench/score.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "armcmc/gap/thresholds.hpp"
#include "armcmc/gap_bench/strata.hpp"
#include "armcmc/models/registry.hpp"
#include "armcmc/support/effect_library.hpp"
#include "hidden.hpp"

namespace armcmc::gap_bench {
namespace {

constexpr double kUnnoticed = 9.0;  // noise variances

/// An effect of any plant's catalogue; null for what is in none.
const EffectInfo* Listed(std::string_view name) {
  for (const ModelInfo* model : CompiledModels())
    if (const EffectInfo* info = FindEffect(*model, name)) return info;
  return nullptr;
}

/// Of an effect of any catalogue; nothing for what is in none.
std::optional<std::string> FamilyOf(const std::string& name) {
  if (const EffectInfo* info = Listed(name)) return std::string(info->family);
  static const std::vector<EffectEntry> entries = support::ReadEffectLibrary();
  const auto entry = std::find_if(entries.begin(), entries.end(), [&](const EffectEntry& e) { return e.name == name; });
  return entry == entries.end() ? std::nullopt : std::optional(entry->family);
}

/// The name given to an effect that the plant's own catalogue lacks, by the name in the sealed file.
std::string AsSealed(const Case& what, const Truth& truth, const std::string& answer) {
  const auto has = [](const auto& list, const auto& one) {
    return std::find(list.begin(), list.end(), one) != list.end();
  };
  for (const TrueEffect& effect : truth.effects) {
    const bool lacked = effect.kind == "outside" || has(what.without, effect.name);
    const auto names = HiddenInContact().also_called.find(effect.name);
    if (lacked && names != HiddenInContact().also_called.end() && has(names->second, answer)) return effect.name;
  }
  return answer;
}

std::string Joined(const Names& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : " + ") + name;
  return text;
}

/// "force_bias from 4.25 s", "adhesion (pull_off)" -> the name.
std::string NameIn(const std::string& text) { return text.substr(0, text.find(' ')); }

/// The truth that an answer is held against: what no catalogue lists needs no name where it only stands beside what one
/// does.
Truth NameableTruth(const Truth& truth) {
  const auto outside = [](const TrueEffect& effect) { return effect.kind == "outside"; };
  Truth named = truth;
  if (!std::all_of(truth.effects.begin(), truth.effects.end(), outside)) std::erase_if(named.effects, outside);
  return named;
}

/// The names given to the effects that are to be named, each once: what the recording holds by itself is left out, and
/// what is rightly named of the others.
Names Judged(const Case& what, const Truth& truth, Names answer) {
  const Names all = NamesOf(truth), names = NamesOf(NameableTruth(truth));
  const auto holds = [](const Names& list, const std::string& name) {
    return std::find(list.begin(), list.end(), name) != list.end();
  };
  for (std::string& name : answer) name = AsSealed(what, truth, name);
  std::erase_if(answer, [&](const std::string& name) {
    return !holds(names, name) && (holds(what.own, name) || holds(all, name));
  });
  std::sort(answer.begin(), answer.end());
  answer.erase(std::unique(answer.begin(), answer.end()), answer.end());
  return answer;
}

/// Whether the plant's own catalogue has the right name.
bool Nameable(const Case& what, const Truth& truth) {
  return std::all_of(truth.effects.begin(), truth.effects.end(), [&](const TrueEffect& effect) {
    return effect.kind != "outside" &&
           std::find(what.without.begin(), what.without.end(), effect.name) == what.without.end();
  });
}

/// @param repeated  A family may be named by more than one of its effects, as a latency by a delay and a lag.
bool AllOfFamily(const std::vector<Names>& sets, const Names& truth, bool repeated) {
  const auto families_of = [repeated](const Names& names) {
    Names families = FamiliesOf(names);
    if (repeated) families.erase(std::unique(families.begin(), families.end()), families.end());
    return families;
  };
  return std::all_of(sets.begin(), sets.end(), [&](const Names& set) {
    return set.size() >= truth.size() && families_of(set) == families_of(truth);
  });
}

}  // namespace

std::vector<Names> SetsOf(const gap::Result& result) {
  std::vector<Names> sets;
  if (result.verdict == gap::Verdict::kNamed) {
    Names names;
    for (const gap::EffectFinding& effect : result.effects) names.push_back(effect.name);
    sets.push_back(std::move(names));
  } else if (result.verdict == gap::Verdict::kAmbiguous) {
    sets = result.ambiguous_set;
  }
  for (Names& set : sets) std::sort(set.begin(), set.end());
  return sets;
}

Names NamesOf(const Truth& truth) {
  Names names;
  for (const TrueEffect& effect : truth.effects) names.push_back(effect.name);
  std::sort(names.begin(), names.end());
  return names;
}

Names FamiliesOf(const Names& names) {
  Names families;
  for (const std::string& name : names) families.push_back(FamilyOf(name).value_or(name));
  std::sort(families.begin(), families.end());
  return families;
}

std::vector<Names> ScoredSets(const Case& what, const Truth& truth, const gap::Result& result) {
  std::vector<Names> sets = SetsOf(result);
  for (Names& set : sets) set = Judged(what, truth, std::move(set));
  std::sort(sets.begin(), sets.end());
  sets.erase(std::unique(sets.begin(), sets.end()), sets.end());
  return sets;
}

Grade GradeOf(const Case& what, const Truth& all, const gap::Result& result) {
  const Truth truth = NameableTruth(all);
  const std::vector<Names> sets = ScoredSets(what, all, result);
  const bool only_own = sets.size() == 1 && sets.front().empty();
  const bool none = result.verdict == gap::Verdict::kNone || only_own;
  if (truth.effects.empty()) return none ? Grade::kRight : sets.empty() ? Grade::kUnnamed : Grade::kWrong;
  if (none) return Grade::kNone;
  const bool nameable = Nameable(what, truth);
  if (sets.empty()) return nameable ? Grade::kUnnamed : Grade::kRight;
  const Names names = NamesOf(truth);
  if (std::find(sets.begin(), sets.end(), names) != sets.end()) return sets.size() == 1 ? Grade::kRight : Grade::kTie;
  // Where the plant is not the catalogue, two formulas of a family say no more than that.
  if (AllOfFamily(sets, names, Imperfect(what.stratum))) return Grade::kFamily;
  const bool nothing_false = std::all_of(sets.begin(), sets.end(), [&](const Names& set) {
    return std::includes(names.begin(), names.end(), set.begin(), set.end());
  });
  return nameable && nothing_false ? Grade::kPartial : Grade::kWrong;
}

std::optional<bool> EquationRight(const Truth& truth, const gap::Result& result) {
  if (result.equation.empty() || result.verdict == gap::Verdict::kNone) return std::nullopt;
  const auto listed = [](const TrueEffect& effect) { return Listed(effect.name) != nullptr; };
  if (std::none_of(truth.effects.begin(), truth.effects.end(), listed)) return std::nullopt;
  return std::any_of(truth.effects.begin(), truth.effects.end(),
                     [&](const TrueEffect& effect) { return WhatIsHidden().Changes(effect.name, result.equation); });
}

std::pair<std::string, double> TopLabel(const gap::Result& result) {
  std::map<std::string, double> probability = {{"none", result.probability_none},
                                               {"unnamed", result.probability_unnamed}};
  for (const gap::CandidateScore& candidate : result.candidates) {
    Names names;
    for (const std::string& text : candidate.effects) names.push_back(NameIn(text));
    std::sort(names.begin(), names.end());
    // Physics that competes without a name in the catalogue.
    const bool unlisted =
        std::any_of(names.begin(), names.end(), [](const std::string& name) { return !FamilyOf(name); });
    probability[unlisted ? "unnamed" : Joined(names)] += candidate.probability;
  }
  const auto top = std::max_element(probability.begin(), probability.end(),
                                    [](const auto& a, const auto& b) { return a.second < b.second; });
  return *top;
}

bool LabelRight(const Case& what, const Truth& all, const std::string& label, double model_error) {
  const Truth truth = NameableTruth(all);
  if (truth.effects.empty() && model_error >= gap::Thresholds{}.tie_effect) return label == "unnamed";
  if (truth.effects.empty())
    return label == "none" || std::find(what.own.begin(), what.own.end(), label) != what.own.end();
  if (label == "none") return false;
  if (label == "unnamed") return !Nameable(what, truth);
  const Names names = NamesOf(truth);
  Names answer;
  for (std::size_t at = 0; at <= label.size();) {
    const std::size_t end = std::min(label.find(" + ", at), label.size());
    answer.push_back(label.substr(at, end - at));
    at = end + 3;
  }
  answer = Judged(what, all, std::move(answer));
  if (answer == names) return true;
  const bool own_formula =
      !Imperfect(what.stratum) && std::all_of(truth.effects.begin(), truth.effects.end(),
                                              [](const TrueEffect& effect) { return effect.kind == "catalogue"; });
  if (Nameable(what, truth) && own_formula) return false;
  return FamiliesOf(answer) == FamiliesOf(names);
}

std::pair<double, double> OnsetInterval(const std::vector<double>& contribution, double dt, double onset_s,
                                        double noise_sd) {
  const double limit = kUnnoticed * noise_sd * noise_sd;
  const auto size = static_cast<long>(contribution.size());
  const long onset = std::clamp(std::lround(onset_s / dt), 0L, size);
  const auto squared = [&](long i) {
    const double value = contribution[static_cast<std::size_t>(i)];
    return value * value;
  };
  long first = onset, last = onset;
  for (double sum = 0.0; first > 0 && (sum += squared(first - 1)) < limit; --first) {
  }
  for (double sum = 0.0; last < size && (sum += squared(last)) < limit; ++last) {
  }
  return {static_cast<double>(first) * dt, static_cast<double>(last) * dt};
}

std::optional<double> OnsetError(const gap::Result& result, const std::string& effect,
                                 std::pair<double, double> interval) {
  for (const gap::EffectFinding& found : result.effects) {
    if (found.when.kind != gap::When::Kind::kFrom) continue;
    if (found.name != effect && FamiliesOf({found.name}) != FamiliesOf({effect})) continue;
    return std::max({0.0, interval.first - found.when.time_s, found.when.time_s - interval.second});
  }
  return std::nullopt;
}

}  // namespace armcmc::gap_bench
