#pragma once

namespace armcmc::gap {

/// Every number that a verdict hangs on. Gains are shares of the noise variance: 2 nats / rows.
struct Thresholds {
  double min_gain = 0.005;         ///< What is predictable beyond the model below this is never named.
  double min_remainder = 0.0015;   ///< What stays predictable below this is nothing.
  double min_nats = 20.0;          ///< Nor is what is worth less than this: a line found by looking at every frequency
                                   ///< of a short recording is worth half of it by chance.
  double visible_ratio = 0.15;     ///< Rms over noise from which an effect is named although the colour of the noise
                                   ///< keeps its gain below the two above,
  double clear_nothing = 5e-3;     ///< where the probability of nothing is below this.
  double largest_ratio = 30.0;     ///< Rms over noise that an effect may have.
  double remainder_share = 0.03;   ///< An adequate hypothesis leaves less than this share of the gap.
  double p_missing = 0.95;         ///< Bootstrap probability that anything is missing, to say so.
  double p_reject = 0.98;          ///< Bootstrap probability that a rival is worse, to reject it.
  double p_reject_lightly = 0.95;  ///< Or one of the same family, which does less harm, or with a time to choose.
  double adequate_closure = 0.8;   ///< An adequate hypothesis closes this share of the gap, whatever is significant.
  double p_remainder = 0.70;       ///< Bootstrap probability that something is left, to call a hypothesis inadequate.
  double p_outdone = 0.90;       ///< Bootstrap probability that physics without a name is better, to withhold the name.
  double tie_nats = 3.0;         ///< Differences below the largest of these three are ties:
  double tie_effect = 0.03;      ///< predictions that differ by this share of the noise sd,
  double tie_share = 0.015;      ///< and this share of the gap, where formula errors decide,
  double tie_share_kin = 0.001;  ///< or this share between effects of the same family.
  double sure = 0.80;            ///< Probability that a single name must have,
  double sure_set = 0.90;        ///< or the set that it is widened to,
  double doubt = 0.50;           ///< and below which no name is given.
  double confirmed = 0.90;       ///< Closed fraction on sealed data that must be within the interval, to keep a name,
  double at_least_closed = 0.50;      ///< and the least that it may be.
  double confirmed_elsewhere = 0.97;  ///< or this share outside the worst fifth of the blocks.
  double family_closure = 0.92;       ///< Closure that names a family whose formula is not adequate.
  double family_lead = 0.90;          ///< Share of the best gain that every other family must stay below.
  double granted_closure = 0.70;      ///< Closure of a grant and an effect that leave something all the same,
  double granted_lead = 0.70;         ///< and share of what it gains beyond the grant, that other families stay below.
  double relaxed_share = 0.70;        ///< Of what its free shape gains, that the formula itself must gain.
  double event_nats = 30.0;           ///< Evidence that names an effect seen in too few blocks to leave any out.
  double event_excess = 10.0;         ///< Robust standard deviations of a block's energy that make it an event,
  double event_rest = 5.0;            ///< and up to which it may stay one once it is explained.
  int min_active_blocks = 4;          ///< Blocks in which an effect must act.
};

}  // namespace armcmc::gap
