#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "armcmc/ladder/candidates.hpp"
#include "armcmc/ladder/dataset.hpp"
#include "armcmc/ladder/features.hpp"
#include "armcmc/ladder/trial.hpp"

namespace armcmc::ladder {

/// The scales of the data with the ranges of signals and states over some rows, without the outermost ones.
[[nodiscard]] DataScales WithRanges(DataScales scales, const std::vector<Feature>& features,
                                    const std::vector<Eigen::Index>& rows);

/// Residual of y after a least-squares fit of the columns; columns of zero norm are skipped.
/// @param pull  [column] Precision of a prior about 0.
[[nodiscard]] Eigen::VectorXd LeftOf(const Eigen::VectorXd& y, const Eigen::MatrixXd& columns,
                                     const Eigen::VectorXd& pull);

/// The candidates that explain most of the residual of a fitted model, one for each different action, ranked by one
/// Gauss-Newton step.
/// @param plant  The plant that they extend.
/// @param base   Its fit.
[[nodiscard]] std::vector<Candidate> BestByOneStep(std::vector<Candidate> all, std::size_t count,
                                                   const std::shared_ptr<const Plant>& plant, const Dataset& data,
                                                   const Trial& base);

}  // namespace armcmc::ladder
