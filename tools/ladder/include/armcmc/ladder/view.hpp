#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "armcmc/identify/trajectory_model.hpp"
#include "armcmc/ladder/dataset.hpp"

namespace armcmc::ladder {

/// Kind of cross-validation group.
enum class GroupKind {
  kFold,    ///< A fifth of the short segments, spread over the data: interpolation.
  kBlock,   ///< One long interval of time.
  kRegion,  ///< The lowest or the highest values of a quantity: extrapolation.
};

/// Rows that are left out together.
struct RowGroup {
  std::string name;
  GroupKind kind = GroupKind::kBlock;
  std::vector<Eigen::Index> rows;  ///< Indices into View::active_rows.
};

/// Rows, groups and flexible function with which all models of a rung are compared.
struct View {
  Dataset data;                           ///< Training rows only.
  double period = 0.0;                    ///< s, dominant period of the output.
  std::vector<Eigen::Index> active_rows;  ///< Training rows on which a mode acts, thinned to a few thousand.
  std::vector<RowGroup> groups;
  std::vector<int> stretch;  ///< [active_rows] Short segment to which the row belongs.
  int num_stretches = 0;
  Eigen::MatrixXd flexible;  ///< [active_rows][feature] See FlexibleFeatures().
};

/// Makes the groups from the features of a fitted base model.
/// @param period  s, dominant period of the output.
[[nodiscard]] View MakeView(const Dataset& data, const identify::TrajectoryModel& base, const Eigen::VectorXd& theta,
                            double period);

}  // namespace armcmc::ladder
