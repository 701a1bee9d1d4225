#include "plain_rivals.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "action.hpp"
#include "fitted_rivals.hpp"
#include "one_step.hpp"

namespace armcmc::ladder {
namespace {

constexpr const char* kMostDrift = "0.33";  // of a parameter, on either side: what drifts by more is a change of state
constexpr std::size_t kMostFitted = 2;      // of a kind, with different action
constexpr const char* kPast = "past";
constexpr const char* kStraight = "straight";

EffectEntry ShiftedLimit() {
  EffectNeed x;
  x.name = "x";
  x.kind = "signal";
  x.used = true;
  EffectForm form;
  form.needs = {x};
  form.parameters.push_back({"d", "x", "normal", "0", "0.2*x", "", "", "0"});
  form.terms.push_back({"input", "x", "x - d"});
  EffectEntry entry;
  entry.name = entry.family = "limit";
  entry.forms = {form};
  return entry;
}

/// @param drifts  Or is off by a constant.
EffectEntry ShiftedZero(bool drifts) {
  EffectForm form;
  form.parameters.push_back({"b", "output", "normal", "0", "0.3*output", "", "", "0"});
  form.terms.push_back({"output", "", "b"});
  if (drifts) {
    form.constants = {{"m", "s", "start + 0.5*record"}, {"w", "s", "0.5*record"}};
    form.parameters.push_back({"r", "output", "normal", "0", "0.3*output", "", "", "0"});
    form.terms.front().formula = "b + r*(t - m)/w";
  }
  EffectEntry entry;
  entry.name = entry.family = "zero";
  entry.forms = {form};
  return entry;
}

EffectEntry DriftingParameter() {
  EffectNeed p;
  p.name = "p";
  p.kind = "parameter";
  p.used = true;
  EffectForm form;
  form.needs = {p};
  form.constants = {{"m", "s", "start + 0.5*record"}, {"w", "s", "0.5*record"}};
  form.parameters.push_back({"e", "1", "uniform", "0", "", std::string("-") + kMostDrift, kMostDrift, "0"});
  form.terms.push_back({"parameter", "p", "p*(1 + e*(t - m)/w)"});
  EffectEntry entry;
  entry.name = entry.family = "drifting";
  entry.forms = {form};
  return entry;
}

/// Forms that differ in what they follow, and in where the fit of the time constant begins.
EffectEntry Past() {
  EffectEntry entry;
  entry.name = entry.family = kPast;
  for (const std::string of : {"law", "signal", "state"})
    for (const char* const tau : {"0.03*period", "0.1*period", "0.3*period", "period"}) {
      EffectForm form;
      form.variant = true;  // all forms are tried
      // With c = -1 it would be the lag of a sensor, which is another thing than a body that relaxes.
      if (of == "law") {
        form.parameters.push_back({"c", "1", "normal", "0", "0.5", "0", "10", "0"});
        form.terms.push_back({"output", "", "c*(law - lowpass(law, tau))"});
      } else {
        EffectNeed x;
        x.name = "x";
        x.kind = of;
        form.needs = {x};
        form.parameters.push_back({"c", "output/x", "normal", "0", "output/x", "", "", "0"});
        form.terms.push_back({"output", "", "c*(x - lowpass(x, tau))"});
      }
      form.parameters.push_back({"tau", "s", "lognormal", tau, "1.5", "dt", "10*record", ""});
      entry.forms.push_back(std::move(form));
    }
  return entry;
}

EffectEntry Straight() {
  EffectEntry entry;
  entry.name = entry.family = kStraight;
  for (const char* const kind : {"signal", "state"}) {
    EffectNeed x;
    x.name = "x";
    x.kind = kind;
    EffectForm form;
    form.variant = true;  // all forms are tried
    form.needs = {x};
    form.constants = {{"m", "x", "mean_x"}};
    form.parameters.push_back({"c", "output/x", "normal", "0", "output/x", "", "", "0"});
    form.terms.push_back({"output", "", "c*(x - m)"});
    entry.forms.push_back(std::move(form));
  }
  return entry;
}

std::string Bound(const Candidate& rival, const char* need) {
  const auto at = rival.binding.symbols.find(need);
  return at == rival.binding.symbols.end() ? "" : at->second;
}

/// Whether it is the zero of the output that is elsewhere.
bool IsOfZero(const Candidate& rival) { return rival.form().needs.empty() && rival.entry->name != kPast; }

/// "K drifted"
std::string AsIf(const Candidate& rival) {
  if (IsOfZero(rival)) return Reads(rival, "t") ? "the zero of the output drifted" : "the output had another zero";
  if (const std::string p = Bound(rival, "p"); !p.empty()) return p + " drifted";
  const std::string x = Bound(rival, "x");
  if (rival.entry->name == kPast) return x.empty() ? "the output relaxed" : "the output followed the past of " + x;
  if (rival.entry->name == kStraight) return "a term in proportion to " + x + " were added to the output";
  return "the modes changed at another " + x;
}

/// Whether the condition of a mode reads a signal.
bool Limits(const Plant& plant, const std::string& name) {
  const std::vector<SignalDescription>& signals = plant.description().signals;
  const auto at = std::find_if(signals.begin(), signals.end(), [&](const auto& signal) { return signal.name == name; });
  if (at == signals.end()) return false;
  const int node = plant.NodeOf(expression::SymbolKind::kSignal, static_cast<int>(at - signals.begin()));
  return std::any_of(plant.modes().begin(), plant.modes().end(),
                     [&](const PlantMode& mode) { return mode.when >= 0 && plant.graph().DependsOn(mode.when, node); });
}

}  // namespace

PlainRivals::PlainRivals(const std::shared_ptr<const Plant>& plant, const Dataset& data, const View& view,
                         const Trial& base, const DataScales& scales, const std::vector<Contender>& contenders)
    : plant_(plant),
      data_(data),
      view_(view),
      base_(base),
      scales_(scales),
      contenders_(contenders),
      plain_entries_{ShiftedZero(false), ShiftedZero(true), ShiftedLimit()},
      slow_entries_{DriftingParameter()},
      past_entries_{Past()},
      straight_entries_{Straight()} {}

bool PlainRivals::IsNotInCatalogue(const Candidate& rival) const {
  if (IsOfZero(rival))
    return std::none_of(contenders_.begin(), contenders_.end(), [&](const Contender& c) {
      return c.candidate.form().terms.front().slot == "output" && IsIndependentOfSignals(c.candidate) &&
             Reads(c.candidate, "t") == Reads(rival, "t") && c.candidate.Frequencies().empty();
    });
  const std::string signal = Bound(rival, "x"), parameter = Bound(rival, "p");
  if (!signal.empty() && IsExplained(plant_->description(), signal)) return false;
  if (rival.entry->name == kPast)
    return std::none_of(contenders_.begin(), contenders_.end(),
                        [](const Contender& c) { return Relaxes(c.candidate); });
  if (rival.entry->name == kStraight)
    return std::none_of(contenders_.begin(), contenders_.end(),
                        [&](const Contender& c) { return IsProportionalTo(c.candidate, signal); });
  if (!signal.empty() && !Limits(*plant_, signal)) return false;
  // A constant of the law that drifts is no other than an output that does.
  if (!parameter.empty() && IsIndependentOfSignals(rival)) return false;
  return std::none_of(contenders_.begin(), contenders_.end(), [&](const Contender& c) {
    if (!parameter.empty()) return ActsOn(c.candidate, "parameter", parameter) && Reads(c.candidate, "t");
    return ActsOn(c.candidate, "input", signal) && !Remembers(c.candidate);
  });
}

std::optional<Rival> PlainRivals::RivalOf(const Contender& c) {
  const auto lacked = [&](const std::vector<EffectEntry>& entries) {
    std::vector<std::string> notes;  // what does not fit a limit of plants is no rival
    std::vector<Candidate> all = Candidates(plant_->description(), entries, scales_, &notes);
    std::erase_if(all, [&](const Candidate& candidate) { return !IsNotInCatalogue(candidate); });
    return all;
  };
  if (!plain_) plain_ = FittedRivals(lacked(plain_entries_), data_, base_);
  const Contender* rival = FirstThatExplainsAsMuch(&*plain_, view_, base_, c);
  if (rival == nullptr && (Remembers(c.candidate) || IsIndependentOfSignals(c.candidate))) {
    if (!slow_)
      slow_ = FittedRivals(BestByOneStep(lacked(slow_entries_), kMostFitted, plant_, data_, base_), data_, base_);
    rival = FirstThatExplainsAsMuch(&*slow_, view_, base_, c);
  }
  // A lag of the output or of an input is a memory of it, too, and has a name of its own.
  if (rival == nullptr && Remembers(c.candidate) && Adds(c.candidate)) {
    if (!past_)
      past_ = FittedRivals(BestByOneStep(lacked(past_entries_), kMostFitted, plant_, data_, base_), data_, base_);
    rival = FirstThatExplainsAsMuch(&*past_, view_, base_, c);
  }
  std::vector<Contender> straight;
  if (rival == nullptr) {
    std::vector<Candidate> same = lacked(straight_entries_);
    // A branch that forgets at once is a damper, and one that never does a spring.
    const bool relaxes = Relaxes(c.candidate);
    std::erase_if(same, [&](const Candidate& one) { return !relaxes && !ActOnSameQuantity(one, c.candidate); });
    straight = FittedRivals(std::move(same), data_, base_);
    rival = FirstThatExplainsAsMuch(&straight, view_, base_, c);
  }
  if (rival == nullptr) return std::nullopt;
  return Rival{AsIf(rival->candidate), "explains as much"};
}

}  // namespace armcmc::ladder
