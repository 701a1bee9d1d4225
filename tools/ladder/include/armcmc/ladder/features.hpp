#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "armcmc/identify/trajectory_model.hpp"
#include "armcmc/ladder/dataset.hpp"

namespace armcmc::ladder {

/// A quantity on which the residual may depend.
struct Feature {
  std::string name;
  std::string unit;
  Eigen::VectorXd value;  ///< [row]
};

/// Whether a law explains just this signal. A function of it explains any error, its noise included.
[[nodiscard]] bool IsExplained(const PlantDescription& plant, const std::string& signal);

/// The features of a plant: its signals except the output and those that a law explains, and its states at `theta`,
/// without those that are constant.
[[nodiscard]] std::vector<Feature> FeaturesOf(const identify::TrajectoryModel& model, const Eigen::VectorXd& theta);

/// Basis of a flexible function of the features and their recent past: `count` random Fourier features sqrt(2 / count)
/// cos(w'x + b) of the standardised quantities, w ~ N(0, 1), b ~ U(0, 2 pi), with a fixed seed (Rahimi and Recht,
/// 2007).
/// @param active_rows  Rows of the result. @param period  s, of the motion: sets the delays of the past values.
/// @return [active_rows][count].
[[nodiscard]] Eigen::MatrixXd FlexibleFeatures(const Dataset& data, const std::vector<Feature>& features,
                                               const std::vector<Eigen::Index>& active_rows, double period, int count);

}  // namespace armcmc::ladder
