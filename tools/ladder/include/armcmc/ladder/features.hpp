#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "armcmc/identify/trajectory_model.hpp"
#include "armcmc/ladder/dataset.hpp"

namespace armcmc::ladder {

/// A quantity that an error may depend on.
struct Feature {
  std::string name;
  std::string unit;
  Eigen::VectorXd value;  ///< [row]
};

/// What there is to depend on: signals but the output, states of the plant at `theta`, and time. What stands still is
/// left out.
[[nodiscard]] std::vector<Feature> FeaturesOf(const identify::TrajectoryModel& model, const Eigen::VectorXd& theta);

/// A flexible function of the features and of their recent past: `count` random Fourier features
/// sqrt(2 / count) cos(w'x + b) of standardised quantities, w ~ N(0, 1), the same at every call.
[[nodiscard]] Eigen::MatrixXd FlexibleFeatures(const Dataset& data, const std::vector<Feature>& features,
                                               const std::vector<Eigen::Index>& looked_at, double period, int count);

}  // namespace armcmc::ladder
