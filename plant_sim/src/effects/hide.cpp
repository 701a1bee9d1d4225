#include "armcmc/plant_sim/effects/hide.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>

#include "armcmc/plant_sim/effects/gap_meter.hpp"
#include "armcmc/plant_sim/rng.hpp"

namespace armcmc::plant_sim {
namespace {

// Streams of the seed that no sensor channel uses.
constexpr std::uint64_t kRequestStream = 0xe0, kDrawStream = 0xe1;
constexpr int kMaxDraws = 100;

std::size_t Pick(std::size_t count, Rng* rng) {
  return std::min(static_cast<std::size_t>(rng->Uniform() * static_cast<double>(count)), count - 1);
}

std::string Joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

/// Every parameter drawn from its range; of the strength only the sign matters.
std::vector<double> DrawValues(const EffectSpec& spec, const EffectScales& scales, Rng* rng) {
  std::vector<double> values;
  for (const EffectParameter& parameter : spec.parameters) {
    const double u = rng->Uniform();
    const double share = parameter.lo > 0.0 ? parameter.lo * std::pow(parameter.hi / parameter.lo, u)
                                            : parameter.lo + u * (parameter.hi - parameter.lo);
    const bool negative = parameter.either_sign && rng->Uniform() < 0.5;
    values.push_back((negative ? -share : share) * scales[static_cast<std::size_t>(parameter.scale)]);
  }
  return values;
}

/// Sets the parameters that a request gives. @return whether the strength is among them.
bool SetValues(const EffectRequest& request, HiddenEffect* effect) {
  bool strength_given = false;
  for (const auto& [name, value] : request.values) {
    const std::vector<EffectParameter>& parameters = effect->spec->parameters;
    const auto it = std::find_if(parameters.begin(), parameters.end(),
                                 [&name = name](const EffectParameter& p) { return p.name == name; });
    if (it == parameters.end()) throw std::invalid_argument(request.name + " has no parameter " + name);
    const bool signed_value = it->either_sign || it->lo <= 0.0;
    if (!std::isfinite(value) || (!signed_value && value <= 0.0))
      throw std::invalid_argument(request.name + ": " + name + " must be positive");
    effect->values[static_cast<std::size_t>(it - parameters.begin())] = value;
    strength_given = strength_given || it == parameters.begin();
  }
  return strength_given;
}

const EffectSpec& ChooseSpec(const PlantFamily& family, const EffectRequest& request, Rng* rng) {
  std::vector<const EffectSpec*> fitting;
  std::vector<std::string> variants;
  for (const EffectSpec& spec : EffectRegistry(family)) {
    if (spec.name != request.name) continue;
    variants.push_back(spec.variant);
    if (request.variant.empty() || spec.variant == request.variant) fitting.push_back(&spec);
  }
  if (variants.empty())
    throw std::invalid_argument("\"" + request.name + "\": expected one of " + Joined(EffectNames(family)));
  if (fitting.empty())
    throw std::invalid_argument("\"" + request.name + ":" + request.variant + "\": expected one of " +
                                Joined(variants));
  return *fitting[Pick(fitting.size(), rng)];
}

Gate DrawGate(const EffectSpec& spec, double duration_s, Rng* rng) {
  if (rng->Uniform() < 0.5) return {};
  // Away from the ends, so that there is a before and an after.
  const double at_s = duration_s * (0.2 + 0.6 * rng->Uniform());
  switch (Pick(spec.mode_gates ? 4 : 2, rng)) {
    case 0: return {Gate::Kind::kFrom, at_s};
    case 1: return {Gate::Kind::kUntil, at_s};
    case 2: return {Gate::Kind::kContact};
    default: return {Gate::Kind::kFree};
  }
}

/// One effect, in or outside the catalogue, of any name but `taken`: names, then formulas, are equally likely.
HiddenEffect DrawEffect(const Scenario& scenario, const GapMeter& meter, double gap_ratio,
                        const std::optional<Gate>& gate, bool outside, const std::string& taken, Rng* rng) {
  std::vector<std::string> names;
  for (const EffectSpec& spec : EffectRegistry(*scenario.family))
    if ((spec.kind == FormulaKind::kOutside) == outside && spec.name != taken &&
        std::find(names.begin(), names.end(), spec.name) == names.end())
      names.push_back(spec.name);
  for (int i = 0; i < kMaxDraws; ++i) {
    HiddenEffect effect;
    EffectRequest request;
    request.name = names[Pick(names.size(), rng)];
    effect.spec = &ChooseSpec(*scenario.family, request, rng);
    effect.values = DrawValues(*effect.spec, meter.scales(), rng);
    const Gate drawn = DrawGate(*effect.spec, scenario.duration_s, rng);
    effect.gate = gate.value_or(drawn);
    if (FindStrength(meter, gap_ratio, &effect)) return effect;
  }
  throw std::invalid_argument("no effect reaches a gap ratio of " + std::to_string(gap_ratio) + " in this scenario");
}

}  // namespace

const char* HiddenKindName(HiddenKind kind) noexcept {
  switch (kind) {
    case HiddenKind::kNone: return "none";
    case HiddenKind::kSingle: return "single";
    case HiddenKind::kPair: return "pair";
    case HiddenKind::kOutside: return "outside";
  }
  return "";
}

HiddenKind KindOf(const std::vector<HiddenEffect>& effects) noexcept {
  if (effects.empty()) return HiddenKind::kNone;
  for (const HiddenEffect& effect : effects)
    if (effect.spec->kind == FormulaKind::kOutside) return HiddenKind::kOutside;
  return effects.size() == 1 ? HiddenKind::kSingle : HiddenKind::kPair;
}

std::vector<EffectRequest> ParseEffectRequests(const std::string& text, const Gate& gate, double gap_ratio) {
  std::vector<EffectRequest> requests;
  std::size_t from = 0;
  while (from <= text.size()) {
    const std::size_t comma = std::min(text.find(',', from), text.size());
    const std::string word = text.substr(from, comma - from);
    const std::size_t colon = word.find(':');
    EffectRequest request;
    request.name = word.substr(0, colon);
    if (colon != std::string::npos) request.variant = word.substr(colon + 1);
    if (request.name.empty() || (colon != std::string::npos && request.variant.empty()))
      throw std::invalid_argument("\"" + text + "\": expected NAME[:VARIANT][,NAME[:VARIANT]]");
    request.gate = gate;
    request.gap_ratio = gap_ratio;
    requests.push_back(request);
    from = comma + 1;
  }
  return requests;
}

std::vector<HiddenEffect> DecideEffects(const Scenario& scenario, const std::vector<EffectRequest>& requests,
                                        std::uint64_t seed) {
  if (requests.empty()) return {};
  if (requests.size() > 2) throw std::invalid_argument("at most two effects can be hidden");
  if (requests.size() == 2 && requests[0].name == requests[1].name)
    throw std::invalid_argument("\"" + requests[0].name + "\" is requested twice");
  const std::unique_ptr<GapMeter> meter = MakeGapMeter(scenario);
  std::vector<HiddenEffect> effects;
  for (std::size_t i = 0; i < requests.size(); ++i) {
    const EffectRequest& request = requests[i];
    Rng rng(seed, kRequestStream + (i << 8));
    HiddenEffect effect;
    effect.spec = &ChooseSpec(*scenario.family, request, &rng);
    effect.values = DrawValues(*effect.spec, meter->scales(), &rng);
    effect.gate = request.gate;
    if (!scenario.family->makes_contact &&
        (effect.gate.kind == Gate::Kind::kContact || effect.gate.kind == Gate::Kind::kFree))
      throw std::invalid_argument("a plant of the family " + scenario.family->name + " makes no contact: no gate " +
                                  effect.gate.Text());
    if (SetValues(request, &effect)) {
      effect.gap_ratio = meter->GapRatio({effect});
    } else if (!FindStrength(*meter, request.gap_ratio, &effect)) {
      char ratio[32];
      std::snprintf(ratio, sizeof(ratio), "%g", request.gap_ratio);
      throw std::invalid_argument(request.name + " (" + effect.spec->variant + ", " + effect.gate.Text() +
                                  ") cannot reach a gap ratio of " + ratio + " in this scenario");
    }
    effects.push_back(effect);
  }
  return effects;
}

std::vector<HiddenEffect> DrawEffects(const Scenario& scenario, double gap_ratio, const std::optional<Gate>& gate,
                                      std::uint64_t seed) {
  Rng rng(seed, kDrawStream);
  const auto kind = static_cast<HiddenKind>(Pick(4, &rng));
  if (kind == HiddenKind::kNone) return {};
  const std::unique_ptr<GapMeter> meter = MakeGapMeter(scenario);
  if (gate && !scenario.family->makes_contact &&
      (gate->kind == Gate::Kind::kContact || gate->kind == Gate::Kind::kFree))
    throw std::invalid_argument("no gate " + gate->Text() + " without contact");
  const bool outside = kind == HiddenKind::kOutside;
  std::vector<HiddenEffect> effects = {DrawEffect(scenario, *meter, gap_ratio, gate, outside, "", &rng)};
  if (kind == HiddenKind::kPair)
    effects.push_back(DrawEffect(scenario, *meter, gap_ratio, gate, outside, effects[0].spec->name, &rng));
  return effects;
}

}  // namespace armcmc::plant_sim
