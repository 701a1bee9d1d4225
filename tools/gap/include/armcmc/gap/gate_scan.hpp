#pragma once

#include <vector>

#include "armcmc/gap/fit.hpp"

namespace armcmc::gap {

/// A term that starts, ends, or acts in one mode only, with its gain over the parent.
struct GateCandidate {
  Term term;
  double gain = 0.0;         ///< Decrease of the squared whitened residual.
  double always_gain = 0.0;  ///< The same without a gate.
};

/// Scans every onset and every end of an effect at once.
///
/// With template c (the effect at unit amplitude, whitened) and Q an orthonormal basis of the parent's columns, the
/// gain of c from time t on is  (c_t'r)^2 / (|c_t|^2 - |Q'c_t|^2),  computed from running sums: O(rows) for all t
/// together.
/// @return the best gate of each kind, best first; only those that leave enough blocks active.
[[nodiscard]] std::vector<GateCandidate> ScanGates(const Fitter& fitter, const Fitted& parent, const EffectForm& form,
                                                   const std::vector<Vector>& templates, int min_active_blocks);

/// Whitened contributions of a form at its starts (and at `fitted`, where it is the last term) over the parent.
[[nodiscard]] std::vector<Vector> Templates(const Fitter& fitter, const Fitted& parent, const EffectForm& form,
                                            const Fitted* fitted);

}  // namespace armcmc::gap
