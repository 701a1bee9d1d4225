#pragma once

#include "armcmc/baselines/regression_form.hpp"

namespace armcmc {

/// The paper's log-linearisation of the contact (equations `hnt`, `hnt3`, `hnt44`),
///
///   log f = log K + (B/K) v + p log x,   z = (log K, B/K, p),
///
/// which drops the second and higher powers of (B/K) v. Better than published: a sample has r = (s / f)^2, the variance
/// that force noise has in log f, and samples below kLeastForce noise scales, whose logarithm says nothing, are left
/// out. Saturation: (K, B, p) is held inside the bounds.
extern const RegressionForm kLogLinearForm;

}  // namespace armcmc
