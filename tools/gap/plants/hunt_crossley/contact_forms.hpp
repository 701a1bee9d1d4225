#pragma once

#include <vector>

#include "armcmc/gap/effect_form.hpp"
#include "armcmc/gap/form_tools.hpp"

namespace armcmc::gap {

/// An effect of the estimator's catalogue: name, family, formula and feature are the estimator's. `coordinates` are its
/// amplitudes and shapes; the feature is given the physical values of the shapes.
[[nodiscard]] EffectForm FromCore(const char* name, std::vector<Coordinate> coordinates);
/// A further formula of an effect, with coordinates of its own; features and starts are the caller's.
[[nodiscard]] EffectForm Reformulated(const EffectForm& base, const char* variant, const char* formula,
                                      std::vector<Coordinate> coordinates, int num_amplitudes);

// The parts of the contact catalogue.
void AddMaterial(const Signals& signals, std::vector<EffectForm>* out);
void AddSurfaceAndStiffness(const Signals& signals, std::vector<EffectForm>* out);
/// Physics that is not in the catalogue. It competes and is described, never named.
void AddUnlisted(const Signals& signals, std::vector<EffectForm>* out);

}  // namespace armcmc::gap
