#pragma once

namespace armcmc::gap {

/// All thresholds of a verdict. Gains are relative to the noise variance: 2 nats / rows.
struct Thresholds {
  double min_gain = 0.005;         ///< A misfit with a smaller predictable part is never named.
  double min_remainder = 0.0015;   ///< A smaller predictable remainder counts as none.
  double min_nats = 20.0;          ///< Nor is a misfit of less evidence: the best spectral line of a short recording of
                                   ///< noise reaches half of it by chance.
  double visible_ratio = 0.15;     ///< Rms over noise from which an effect is named even if coloured noise keeps its
                                   ///< gain below the two above,
  double clear_nothing = 5e-3;     ///< if the probability that nothing is missing is below this.
  double largest_ratio = 30.0;     ///< Largest rms over noise of an effect.
  double remainder_share = 0.03;   ///< Largest share of the gap that an adequate hypothesis leaves.
  double p_missing = 0.95;         ///< Bootstrap probability above which something is reported missing.
  double p_reject = 0.98;          ///< Bootstrap probability of being worse above which a rival is rejected.
  double p_reject_lightly = 0.95;  ///< The same for a rival of the same family, or with a free onset.
  double adequate_closure = 0.8;   ///< Least share of the gap that an adequate hypothesis closes.
  double p_remainder = 0.70;       ///< Bootstrap probability of a remainder above which a hypothesis is inadequate.
  double p_outdone = 0.90;       ///< Bootstrap probability that unnamed physics is better above which no name is given.
  double tie_nats = 3.0;         ///< Differences below the largest of the next ones are ties: evidence,
  double tie_effect = 0.03;      ///< difference of the predictions relative to the noise sd,
  double tie_share = 0.015;      ///< share of the gap, between families,
  double tie_share_kin = 0.001;  ///< share of the gap, within a family.
  double sure = 0.80;            ///< Least probability of a single name,
  double sure_set = 0.90;        ///< of a set,
  double doubt = 0.50;           ///< and of any name at all.
  double confirmed = 0.90;       ///< Closed fraction on held-out data that the interval must contain to confirm a name,
  double at_least_closed = 0.50;      ///< and the least closed fraction,
  double confirmed_elsewhere = 0.97;  ///< or the closed fraction outside the worst fifth of the blocks.
  double family_closure = 0.92;       ///< Closed fraction that names a family without an adequate formula.
  double family_lead = 0.90;          ///< Largest gain of any other family, relative to the best.
  double corrected_closure = 0.70;    ///< Closed fraction of a flexible correction and an effect with a remainder,
  double corrected_lead = 0.70;  ///< and largest gain of other families beyond the correction, relative to its gain.
  double relaxed_share = 0.70;   ///< Least gain of a formula, relative to a flexible function of its variables.
  double event_nats = 30.0;      ///< Evidence above which an effect in too few blocks for leave-out scores is named.
  double event_excess = 10.0;    ///< Energy of a block, in robust standard deviations, above which it is an event,
  double event_rest = 5.0;       ///< and below which an event counts as explained.
  int min_active_blocks = 4;     ///< Least number of blocks in which an effect acts.
};

}  // namespace armcmc::gap
