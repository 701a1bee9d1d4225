#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "armcmc/plant/description.hpp"
#include "armcmc/plant/effect_scales.hpp"
#include "armcmc/plant/error.hpp"

namespace armcmc {

/// Something of a plant that an effect acts on or is computed from. In the effect's texts it has a name of its own.
struct EffectNeed {
  std::string name;
  /// "signal" (never the output), "state", "parameter", or "constant": one that a law, a target or a rate reads
  /// together with all other needs.
  std::string kind = "signal";
  std::vector<std::string> roles;  ///< One of these; empty: any role.
  std::string unit;                ///< That it must have; empty: any.
  std::string per;                 ///< Its unit is the output's over a power above 0 of what this need is bound to.
  std::string reads;               ///< Of a state: its rate reads what this need is bound to.
  std::string rate_of;             ///< Of a signal: the derivative of the signal that this need is bound to.
  bool used = false;               ///< The law, or what it explains, reads it.
};

/// A parameter of an effect. Sizes are texts over the scales of data (see ScaleValue), so that they fit any plant.
struct EffectParameter {
  std::string name;
  std::string unit;  ///< Of units and names: "output/v^2" is the unit of the output over that of what v is bound to.
  std::string prior = "normal";
  std::string mean = "0";
  std::string sd;
  std::string lower;  ///< Empty: 8 sd below the mean.
  std::string upper;
  std::string none;  ///< Value at which the effect is absent; empty: a shape, which has no such value.
};

/// A number that the scales decide once, when the effect is added.
struct EffectConstant {
  std::string name;
  std::string unit;
  std::string value;
};

/// Where a formula goes.
///   output     added to what explains the output; of an effect that resists motion, subtracted where the output is the
///              force that the plant passes on, as in F = p A - m a - c v
///   law        takes the place of what explains the output
///   rate       added to the rate of the state `of`; where it says `rate`, it takes that one's place
///   input      takes the place of the input `of` wherever the plant reads it, or of the state `of` wherever the law
///              and other states read it
///   parameter  takes the place of the parameter or constant `of` likewise
///
/// What a mode explains instead of the output, its target T, is made of signals alone and stays so. Where an input or a
/// constant in it is replaced, which makes T' of it, the law explains T with T - (T' - law) S: the error is that of law
/// against T'. S is T / T' at one place, inputs with the role "drive", and signals that vary by more than their mean,
/// at their most, other signals at their mean:
/// without it an effect that makes T' small would leave a small error with a law that is small. Such a mode goes on to
/// be chosen by what was measured.
struct EffectTerm {
  std::string slot = "output";
  std::string of;
  std::string formula;
};

/// One way in which an effect enters a plant.
///
/// Its texts are in the language of plant files. Names in them: needs, parameters, constants, lets and states of the
/// form; t; `law` (what explains the output so far), `rate` (in a rate: that so far), `rate_NAME` (the rate of the
/// state that NAME is bound to), `output` (in a start: the measured output).
struct EffectForm {
  std::string name;                   ///< Of a variant; empty: the usual one.
  std::string title;                  ///< Of a variant.
  bool variant = false;               ///< Another formula of the same physics.
  std::vector<std::string> explains;  ///< Roles of the output that it fits; none: all.
  std::vector<EffectNeed> needs;
  std::vector<EffectTerm> terms;
  std::vector<EffectConstant> constants;
  std::vector<EffectParameter> parameters;
  std::vector<LetDescription> lets;
  std::vector<StateDescription> states;
  bool online = true;
  std::string reason;  ///< Why it is not for the estimator.
};

/// What the catalogue says about an effect.
struct EffectEntry {
  std::string name;
  std::vector<std::string> aliases;  ///< Names that it has for plants of some kind.
  std::string title;                 ///< For people to read.
  std::string family;
  std::vector<std::string> kin;  ///< Effects that act alike.
  bool single = false;           ///< Two of them in one place are pieces of some curve.
  bool resists = false;    ///< Its terms of the slot `output` resist motion: subtracted where the law falls with it.
  std::string experiment;  ///< Experiment that would reveal it.
  std::vector<EffectForm> forms;
};

/// What the names of a form represent in a plant.
struct EffectBinding {
  std::size_t form = 0;                        ///< In EffectEntry::forms.
  std::map<std::string, std::string> symbols;  ///< Need -> signal, state or parameter of the plant.
};

/// Finds what is wrong with an entry before any plant is at hand: names, texts, slots, sizes.
/// @throws PlantError; its key is "form[1].formula", or "formula" of the first form.
void CheckEffect(const EffectEntry& entry);

/// All ways in which the entry fits the plant: every binding of the first form that has one, then every binding of its
/// variants. Empty where the plant lacks what it needs.
/// @pre Plant(plant) and CheckEffect(entry) pass.
[[nodiscard]] std::vector<EffectBinding> Bindings(const PlantDescription& plant, const EffectEntry& entry);

/// Why Bindings has none, in words: "needs a velocity state"; empty where it has some.
[[nodiscard]] std::string WhyNot(const PlantDescription& plant, const EffectEntry& entry);

/// The plant with the effect in it: an ordinary plant description.
///
/// New names are EFFECT_NAME (coulomb_friction_Fc), with a number where that is taken. A rate that an effect wraps
/// becomes the let EFFECT_rate_of_STATE: what is added to that rate later is added there, inside the wrap. Where the
/// effect acts in every mode, passive ones become active: they show it. Modes become one law where memory or a moved
/// condition goes through them.
///
/// @param scales  Sizes of the data; DefaultScales(plant) where there are none.
/// @return A description that Plant() takes.
/// @throws PlantError where a binding does not fit, or the plant would be past a limit.
[[nodiscard]] PlantDescription AddEffect(const PlantDescription& plant, const EffectEntry& entry,
                                         const EffectBinding& binding, const DataScales& scales);

/// Name that a parameter of the effect gets in AddEffect.
[[nodiscard]] std::string AddedName(const PlantDescription& plant, const EffectEntry& entry, std::string_view name);

/// How many parameters the formulas of a form have: those that say only where a state begins are of the recording, and
/// do not count.
[[nodiscard]] int NumFormulaParameters(const EffectForm& form);

/// Value of `none` of the form's parameters in that plant; those without one are left out.
[[nodiscard]] std::map<std::string, double> NoEffect(const PlantDescription& plant, const EffectEntry& entry,
                                                     const EffectBinding& binding, const DataScales& scales);

}  // namespace armcmc
