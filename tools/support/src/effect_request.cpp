#include "armcmc/support/effect_request.hpp"

#include <algorithm>

#include "armcmc/support/effect_library.hpp"
#include "armcmc/support/strict_toml.hpp"
#include "nearest.hpp"

namespace armcmc::support {
namespace {

std::string BindText(const EffectBinding& binding) {
  std::string text;
  for (const auto& [need, symbol] : binding.symbols) text += (text.empty() ? "" : ", ") + need + " = " + symbol;
  return text;
}

void CheckVariant(const EffectEntry& entry, const std::string& variant, const std::string& where) {
  if (variant.empty()) return;
  std::vector<std::string> names;
  std::string known;
  for (const EffectForm& form : entry.forms) {
    if (!form.variant) continue;
    names.push_back(form.name);
    known += (known.empty() ? "; available: " : ", ") + form.name;
  }
  if (std::find(names.begin(), names.end(), variant) == names.end())
    throw ConfigError(where + entry.name + " has no variant \"" + variant + '"' + DidYouMean(variant, names) + known);
}

EffectBinding Chosen(const PlantDescription& plant, const EffectEntry& entry, const EffectRequest& request,
                     const std::string& where) {
  CheckVariant(entry, request.variant, where);
  std::vector<EffectBinding> fit;
  for (EffectBinding& binding : Bindings(plant, entry)) {
    const bool as_asked = std::all_of(request.bind.begin(), request.bind.end(), [&](const auto& bind) {
      const auto found = binding.symbols.find(bind.first);
      return found != binding.symbols.end() && found->second == bind.second;
    });
    if (as_asked && entry.forms[binding.form].name == request.variant) fit.push_back(std::move(binding));
  }
  if (fit.size() == 1) return fit.front();
  if (fit.empty()) {
    const std::string why = WhyNot(plant, entry);
    throw ConfigError(where + request.name + " does not fit " + plant.name +
                      (why.empty() ? " as requested" : ": " + why));
  }
  std::string ways;
  for (const EffectBinding& binding : fit) ways += (ways.empty() ? "" : "; or ") + BindText(binding);
  throw ConfigError(where + request.name + " fits " + plant.name + " in " + std::to_string(fit.size()) +
                    " ways, say which: " + ways);
}

void TakePriors(const EffectEntry& entry, const EffectBinding& binding, const EffectRequest& request,
                const std::string& where, const auto& added_name, PlantDescription* plant) {
  for (const auto& [name, wanted] : request.prior) {
    std::vector<std::string> names;
    for (const EffectParameter& p : entry.forms[binding.form].parameters) names.push_back(p.name);
    if (std::find(names.begin(), names.end(), name) == names.end())
      throw ConfigError(where + entry.name + " has no parameter \"" + name + '"' + DidYouMean(name, names));
    const auto p = std::find_if(plant->parameters.begin(), plant->parameters.end(),
                                [&, n = name](const auto& at) { return at.name == added_name(n); });
    if (p->prior == "uniform" && (wanted.mean || wanted.sd)) p->prior = "normal";
    if (wanted.mean) p->mean = *wanted.mean;
    if (wanted.sd) p->sd = *wanted.sd;
    if (wanted.lower) p->lower = *wanted.lower;
    if (wanted.upper) p->upper = *wanted.upper;
  }
}

}  // namespace

EffectRequest RequestFromWord(const std::string& word) {
  EffectRequest request;
  std::size_t begin = word.find(':');
  request.name = word.substr(0, begin);
  if (request.name.empty()) throw ConfigError('"' + word + "\": expected the name of an effect");
  while (begin != std::string::npos) {
    const std::size_t end = word.find(':', begin + 1);
    const std::string part = word.substr(begin + 1, end == std::string::npos ? std::string::npos : end - begin - 1);
    const std::size_t equal = part.find('=');
    if (part.empty() || equal == 0 || (equal == std::string::npos && !request.variant.empty()))
      throw ConfigError('"' + word + "\": expected NAME, NAME:VARIANT or NAME:x=SYMBOL");
    if (equal == std::string::npos) {
      request.variant = part;
    } else {
      request.bind[part.substr(0, equal)] = part.substr(equal + 1);
    }
    begin = end;
  }
  return request;
}

PlantDescription WithEffects(PlantDescription plant, const std::vector<EffectEntry>& entries,
                             const std::vector<EffectRequest>& requests, const DataScales* scales,
                             const std::string& where) {
  const DataScales guess = scales == nullptr ? DefaultScales(plant) : *scales;
  for (const EffectRequest& request : requests) {
    const EffectEntry& entry = FindEffect(entries, request.name, where);
    const EffectBinding binding = Chosen(plant, entry, request, where);
    const auto added_name = [&, before = plant](const std::string& name) { return AddedName(before, entry, name); };
    try {
      PlantDescription composed = AddEffect(plant, entry, binding, guess);
      TakePriors(entry, binding, request, where, added_name, &composed);
      plant = std::move(composed);
    } catch (const PlantError& error) {
      throw ConfigError(where + error.what());
    }
  }
  return plant;
}

}  // namespace armcmc::support
