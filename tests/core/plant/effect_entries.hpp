#pragma once

#include <string>

#include "armcmc/plant/effect.hpp"
#include "armcmc/plant/effect_scales.hpp"
#include "core/plant/plants.hpp"

// Effects as a catalogue may have them, and a plant that tests of effects need.
namespace armcmc::test {

inline EffectNeed Need(const std::string& name, const std::string& kind, const std::string& role) {
  EffectNeed need;
  need.name = name;
  need.kind = kind;
  if (!role.empty()) need.roles = {role};
  return need;
}

inline EffectParameter Amplitude(const std::string& name, const std::string& unit, const std::string& sd) {
  EffectParameter p;
  p.name = name;
  p.unit = unit;
  p.sd = sd;
  p.none = "0";
  return p;
}

/// Dry friction as the catalogue has it.
inline EffectEntry Friction() {
  EffectEntry entry;
  entry.name = "friction";
  entry.title = "Dry friction";
  entry.family = "dry friction";
  EffectForm form;
  form.explains = {"force"};
  form.needs = {Need("v", "signal", "velocity")};
  form.terms = {{"output", "", "Fc*sign(v)"}};
  form.parameters = {Amplitude("Fc", "output", "0.5*output")};
  form.parameters[0].lower = "0";
  entry.forms = {form};
  return entry;
}

inline EffectEntry WithTerm(const std::string& slot, const std::string& formula, const std::string& unit = "1") {
  EffectEntry entry = Friction();
  entry.name = "changed";
  entry.forms[0].needs.clear();
  entry.forms[0].terms = {{slot, "", formula}};
  entry.forms[0].parameters = {Amplitude("c", unit, "1")};
  return entry;
}

inline PlantDescription Added(const PlantDescription& plant, const EffectEntry& entry) {
  return AddEffect(plant, entry, Bindings(plant, entry).at(0), DefaultScales(plant));
}

/// A tank behind a valve: its law explains what the valve lets in.
inline PlantDescription Filled() {
  PlantDescription plant;
  plant.name = "filled";
  plant.output = "y";
  plant.signals = {{"u", "1", "drive", ""}, {"p", "Pa", "pressure", ""}, {"r", "Pa/s", "", "p"}, {"y", "m", "", ""}};
  plant.constants = {{"source", 5e5, "Pa"}};
  plant.parameters = {{"k", "s", "normal", 1.0, 1.0, 0.0, 10.0}};
  plant.lets = {{"head", "source - p"}};
  plant.modes = {{"open", "u > 0", "k*r", "u*head"}, {"shut", "", "", "", true}};
  return plant;
}

inline EffectEntry OnInput(const std::string& name, const std::string& kind, const std::string& formula) {
  EffectEntry entry = WithTerm(kind == "constant" ? "parameter" : "input", formula, name);
  entry.forms[0].explains.clear();
  entry.forms[0].needs = {Need(name, kind, "")};
  entry.forms[0].needs[0].used = true;
  entry.forms[0].terms[0].of = name;
  return entry;
}

}  // namespace armcmc::test
