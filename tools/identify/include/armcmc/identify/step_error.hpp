#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <string>

#include "armcmc/identify/trajectory_model.hpp"

namespace armcmc::identify {

/// Whether the states of a plant are integrated in steps that are short enough.
struct StepError {
  int substeps = 1;           ///< A sample, as the file has it.
  double change = 0.0;        ///< Of the law with steps half as long, rms; infinite: a trajectory diverges.
  std::optional<int> enough;  ///< Substeps from which halving them changes next to nothing; none up to the most.
  bool short_enough = true;   ///< Those of the file are.
};

/// Integrates with steps half as long, and again, until the law changes by less than a tenth of the noise (rms).
/// Looks at a few thousand rows in runs of a few hundred, so that an unstable plant, too, can be judged.
/// @param theta     Sampled coordinates, where the data are explained.
/// @param noise_sd  Of what is explained, > 0.
[[nodiscard]] StepError StepErrorOf(const Plant& plant, const Series& series, const Eigen::VectorXd& theta,
                                    double noise_sd);

/// What to do about it, one line; empty where nothing has to be done.
[[nodiscard]] std::string StepErrorText(const StepError& error, double dt, double noise_sd);

}  // namespace armcmc::identify
