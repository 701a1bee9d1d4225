#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "armcmc/gap/effect_form.hpp"

namespace armcmc::gap {

/// Effects that serve one kind of law, from a file of forms/, scaled to a recording.
///
///   schema = 1
///   [[form]]
///   effect, family, text                words; `text`: the formula for people
///   variant = "stribeck"                another formula of the physics of the form before it, which gives it what it
///                                       leaves out: words, amplitudes with shapes and starts, groups and gates
///   listed = false                      it competes, and is never named
///   slot                                where it acts:
///     output      the formula is added to the prediction
///     elastic     the same; it filters `law`, the elastic part of the law
///     input       it takes the place of the input `of` ("x" or "p")
///     drive       it takes the place of the opening u
///     parameter   the first parameter of the law is multiplied by one plus the formula
///     rate        it is added to the acceleration of the motion that the law simulates
///   takes = "coulomb_friction/smooth"   the formula is that of this effect of the catalogue, with
///   with = { Fc = "force" }             its names, where they are not names of the form, written in those; or
///   formula = "force*tanh(v/speed)"     in the language of plant files
///   [form.let] NAME = "expression"
///   [form.states] NAME = { start, rate }, or { start, next }: the value one sample later
///   amplitudes = [{ name, unit, size, positive, sd, upper, lower, mean, event, stop }]
///                                       linear in them, except in the slots drive (it has none) and rate
///   shapes = [{ name, unit, size, from, to, mean, sd, stop, .. }]    log-normal from `from` to `to`; else as above
///   starts = [6, 2]                     values of each shape from which fits start; or
///   start_at = [[0.003], ..]            all coordinates; or
///   start_at_line = "whole" | "parts"   the strongest spectral line of the residual, or of its ends as well
///   own_groups, plain_error, gates_by_mode, gates_by_time, from_surface     see EffectForm
///   [[form]] sensor = "latency"         the forms of the output sensor by that name (delay, lag, latency, saturation,
///                                       dead_zone), with effect, family, text, listed and own_groups in place of
///                                       theirs
///
/// Names in formulas: coordinates, states, lets, constants; t, dt; origin, where drifts begin; x, v, a, p, u by role;
/// active, retreating; law (elastic); drive, base (rate). Names in sizes: dt, record, output (rms), and
/// x, v, a, p, u (rms of that role); constants.
///
/// @param constants  Of the plant, by name.
/// @throws support::ConfigError with the place of what is wrong.
[[nodiscard]] std::vector<EffectForm> FormsFromText(std::string_view text, std::string_view name,
                                                    const Signals& signals,
                                                    const std::map<std::string, double>& constants);

/// FormsFromText of the file that comes with the workflow: "contact", "bending", "valve_flow".
/// @throws std::out_of_range for any other.
[[nodiscard]] std::vector<EffectForm> FormsFor(std::string_view law, const Signals& signals,
                                               const std::map<std::string, double>& constants);

}  // namespace armcmc::gap
