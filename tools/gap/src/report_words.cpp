#include "report_words.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "armcmc/plots/html.hpp"

namespace armcmc::gap {
namespace {

using plots::EscapeHtml;
using plots::FixedText;
using plots::NumberText;

// <i> marks quantities. A name that several plants share has a text that applies to all of them.
constexpr std::array<std::pair<std::string_view, EffectWords>, 35> kWords{{
    {"force_bias", {"<i>f</i> + bias", "The zero of the force sensor has a constant offset, in free motion as well."}},
    {"force_drift", {"<i>f</i> + rate · <i>t</i>", "The zero of the force sensor drifts with time."}},
    {"coulomb_friction",
     {"<i>f</i> + <i>F</i><sub>c</sub> sign(<i>v</i>)", "Dry friction: a constant force against the motion."}},
    {"presliding_friction",
     {"<i>f</i> + <i>F</i> <i>z</i>, &ensp;d<i>z</i>/d<i>x</i> = (1 − <i>z</i> sign <i>v</i>) / <i>d</i>",
      "Dry friction that builds up over a short distance after each reversal."}},
    {"viscous_friction", {"<i>f</i> + <i>c</i> <i>v</i>", "Drag proportional to the speed, in free motion as well."}},
    {"inertia", {"<i>f</i> + <i>m</i> d<i>v</i>/d<i>t</i>", "A mass between the sensor and the contact."}},
    {"sensor_delay", {"<i>f</i>(<i>t</i> − <i>T</i>)", "The sensor signal arrives late by a constant time."}},
    {"sensor_lag",
     {"<i>T</i> d<i>g</i>/d<i>t</i> + <i>g</i> = <i>f</i>", "The sensor acts as a first-order low pass."}},
    {"stress_relaxation",
     {"<i>f</i> + <i>k</i> (<i>x</i> − <i>y</i>), &ensp;<i>T</i> d<i>y</i>/d<i>t</i> + <i>y</i> = <i>x</i>",
      "The material relaxes: the force decays while the deformation is held."}},
    {"adhesion",
     {"<i>f</i> − <i>F</i> exp(−<i>x</i> / <i>d</i>) while retracting",
      "The surfaces attract each other while they separate."}},
    {"contact_offset", {"<i>x</i> − <i>d</i> for <i>x</i>", "The surface is not where the model assumes it."}},
    {"sensor_saturation", {"min(<i>f</i>, limit)", "The sensor clips above a limit."}},
    {"periodic_disturbance",
     {"<i>f</i> + <i>a</i> cos(2π<i>ν</i><i>t</i>) + <i>b</i> sin(2π<i>ν</i><i>t</i>)",
      "A disturbance at one frequency, such as hum or an unbalanced motor."}},
    {"stiffness_drift", {"<i>K</i> (1 + rate · <i>t</i>)", "The stiffness changes slowly, through heat or fatigue."}},
    {"leak",
     {"flow − <i>c</i> (<i>p</i> − <i>p</i><sub>atm</sub>)",
      "Gas or liquid escapes at a rate proportional to the pressure."}},
    {"valve_dead_band",
     {"sign(<i>u</i>) max(|<i>u</i>| − <i>u</i><sub>d</sub>, 0)", "The valve does not respond to small commands."}},
    {"valve_lag",
     {"<i>T</i> d<i>s</i>/d<i>t</i> + <i>s</i> = <i>u</i>", "The valve follows its command with a first-order lag."}},
    {"supply_droop", {"<i>p</i><sub>s</sub> − <i>r</i> · flow", "The supply pressure falls with the flow."}},
    {"pressure_bias", {"<i>p</i> + bias", "The zero of the pressure sensor has a constant offset."}},
    {"angle_bias", {"<i>α</i> + bias", "The zero of the angle sensor has a constant offset."}},
    {"joint_friction", {"− <i>F</i> sign(d<i>α</i>/d<i>t</i>)", "Dry friction that opposes the bending."}},
    {"cubic_stiffness", {"+ <i>k</i><sub>3</sub> <i>q</i>³", "The spring stiffens at large deflections."}},
    {"quadratic_stiffness", {"+ <i>k</i><sub>2</sub> <i>q</i>|<i>q</i>|", "The spring stiffens with the deflection."}},
    {"hysteresis", {"Bouc–Wen", "The force depends on the history of the motion."}},
    {"gravity_load", {"+ <i>G</i> sin <i>α</i>", "A weight that the model does not include."}},
    {"payload_step", {"load from some time on", "A load was picked up or put down."}},
    {"asymmetric_friction",
     {"<i>F</i><sub>+</sub> for <i>v</i> > 0, <i>F</i><sub>−</sub> for <i>v</i> < 0",
      "Dry friction that differs with the direction."}},
    {"stribeck_friction",
     {"<i>F</i>(|<i>v</i>|) sign <i>v</i>", "Dry friction that decreases as the speed increases."}},
    {"overflow", {"level ≤ limit", "The tank overflows."}},
    {"absolute_value_sensor", {"|<i>y</i>|", "The sensor reads the absolute value."}},
    {"sensor_dead_zone", {"<i>y</i> beyond ±<i>w</i>, less <i>w</i>", "The sensor reads zero below a threshold."}},
    {"backlash", {"play of width <i>b</i>", "Lost motion at every reversal."}},
    {"pressure_dependent_friction",
     {"− <i>c</i> <i>p</i> sign <i>v</i>", "The friction of a seal grows with the pressure."}},
    {"baseline_tilt", {"+ slope · <i>x</i>", "The zero of the sensor depends linearly on the position."}},
    {"flexible_mode", {"a lightly damped resonance", "A flexible part between drive and sensor."}},
}};

int DecimalsFor(double sd) {
  return std::clamp(1 - static_cast<int>(std::floor(std::log10(sd))), 0, 12);  // two significant digits of the sd
}

std::string AsPrecise(double value, double sd) {
  const double size = std::max(std::abs(value), sd);
  if (!(sd > 0.0) || !std::isfinite(sd) || size >= 1e6 || size < 1e-4) return NumberText(value, 4);
  return FixedText(value, DecimalsFor(sd));
}

/// Except names of people.
std::string LowerFirst(std::string title) {
  if (!title.starts_with("Coulomb") && !title.starts_with("Stribeck") && !title.empty() && title[0] >= 'A' &&
      title[0] <= 'Z')
    title[0] = static_cast<char>(title[0] - 'A' + 'a');
  return title;
}

}  // namespace

std::string EffectTitle(std::string_view name) {
  const std::size_t space = std::min(name.find(' '), name.size());
  std::string title(name.substr(0, space));
  std::replace(title.begin(), title.end(), '_', ' ');
  if (!title.empty() && title[0] >= 'a' && title[0] <= 'z') title[0] = static_cast<char>(title[0] - 'a' + 'A');
  return title + std::string(name.substr(space));
}

std::string EffectInSentence(std::string_view name) { return LowerFirst(EffectTitle(name)); }

std::string EffectTitles(const std::vector<std::string>& names) {
  if (names.empty()) return "nothing";
  std::string out = EffectTitle(names.front());
  for (std::size_t i = 1; i < names.size(); ++i) out += " + " + EffectInSentence(names[i]);
  return out;
}

std::string InSentence(std::string_view names) {
  constexpr std::string_view kAnd = " + ";
  std::vector<std::string> parts;
  for (std::size_t end = 0; end != std::string_view::npos;) {
    end = names.find(kAnd);
    parts.emplace_back(names.substr(0, end));
    names.remove_prefix(end == std::string_view::npos ? names.size() : end + kAnd.size());
  }
  return LowerFirst(EffectTitles(parts));
}

EffectWords WordsOf(std::string_view name) {
  const auto* found =
      std::find_if(kWords.begin(), kWords.end(), [&](const auto& entry) { return entry.first == name; });
  return found == kWords.end() ? EffectWords{} : found->second;
}

std::string WhenText(const When& when) {
  switch (when.kind) {
    case When::Kind::kContact: return "in contact only";
    case When::Kind::kFree: return "in free motion only";
    case When::Kind::kFrom: return "from <i>t</i> = " + FixedText(when.time_s, 3) + " s on";
    case When::Kind::kUntil: return "until <i>t</i> = " + FixedText(when.time_s, 3) + " s";
    case When::Kind::kAlways: break;
  }
  return "always";
}

std::string MeanText(const ParameterEstimate& p) {
  // A confounded parameter is any of many values: three digits tell which one the model has.
  return (p.confounded_with.empty() ? AsPrecise(p.mean, p.sd) : NumberText(p.mean, 3)) +
         (p.unit.empty() ? "" : "&nbsp;" + EscapeHtml(p.unit));
}

std::string IntervalText(const ParameterEstimate& p) {
  if (!std::isfinite(p.sd) || !std::isfinite(p.mean)) return "not known";
  if (p.sd <= 0.0) return "held fixed";
  if (!p.confounded_with.empty()) {
    std::string names;
    for (const std::string& name : p.confounded_with) names += (names.empty() ? "" : ", ") + EscapeHtml(name);
    return "confounded with " + names;
  }
  return AsPrecise(p.mean - 1.96 * p.sd, p.sd) + " to " + AsPrecise(p.mean + 1.96 * p.sd, p.sd);
}

std::string WithUnit(double value, int digits, std::string_view unit) {
  return NumberText(value, digits) + (unit.empty() ? "" : "&nbsp;" + EscapeHtml(unit));
}

std::string CoverageReading(double coverage) {
  if (!std::isfinite(coverage)) return "not known";
  if (coverage < 0.93)
    return "too narrow: " + FixedText(100.0 * (1.0 - coverage), 1) + " % of the samples are outside the 95 % band";
  if (coverage > 0.97) return "too wide: fewer than 5 % of the samples are outside the band";
  return "correct: about 5 % of the samples are outside the band";
}

std::string WhitenessReading(double whiteness) {
  if (!std::isfinite(whiteness)) return "not known";
  // The statistic has 25 degrees of freedom: white noise exceeds 1.6 in 3 of 100 recordings.
  if (whiteness <= 1.6) return "white: the error cannot be predicted from its past";
  if (whiteness <= 3.0) return "nearly white: little structure remains";
  return "not white: the error can be predicted from its past";
}

}  // namespace armcmc::gap
