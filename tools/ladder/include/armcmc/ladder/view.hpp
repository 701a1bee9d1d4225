#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "armcmc/identify/trajectory_model.hpp"
#include "armcmc/ladder/dataset.hpp"

namespace armcmc::ladder {

/// Why rows are left out together.
enum class GroupKind {
  kFold,    ///< A fifth of short stretches of time, all over the data: interpolation.
  kBlock,   ///< One long stretch of time.
  kRegion,  ///< The lowest or the highest values of a quantity: extrapolation.
};

/// Rows that are left out together.
struct RowGroup {
  std::string name;
  GroupKind kind = GroupKind::kBlock;
  std::vector<Eigen::Index> rows;  ///< Indices into View::looked_at.
};

/// The view of the data in which models are compared: the same rows, groups and flexible function for all of them.
struct View {
  Dataset data;                         ///< Training rows only.
  double period = 0.0;                  ///< s, in which the output goes to and fro.
  std::vector<Eigen::Index> looked_at;  ///< Training rows where a mode acts, thinned to a few thousand.
  std::vector<RowGroup> groups;
  std::vector<int> stretch;  ///< [looked at] Short stretch that the row belongs to.
  int num_stretches = 0;
  Eigen::MatrixXd flexible;  ///< [looked at][feature] See FlexibleFeatures().
};

/// The view through a base model that has been fitted.
/// @param period  s, in which the output goes to and fro.
[[nodiscard]] View MakeView(const Dataset& data, const identify::TrajectoryModel& base, const Eigen::VectorXd& theta,
                            double period);

}  // namespace armcmc::ladder
