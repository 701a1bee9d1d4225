#pragma once

#include <Eigen/Core>
#include <vector>

#include "armcmc/gap/result.hpp"
#include "armcmc/ladder/features.hpp"

namespace armcmc::ladder {

/// Where the errors are larger than elsewhere: for each feature the tenth of the rows with the lowest values, with the
/// highest, or closest to zero, whichever has the largest share of the squared error; largest share first.
/// @param error  [row] Residual, unit of the explained quantity. @param rows  Rows to examine.
/// @param floor  Standard deviation of the noise.
[[nodiscard]] std::vector<gap::Where> WhereErrorsAre(const Eigen::VectorXd& error, const std::vector<Feature>& features,
                                                     const std::vector<Eigen::Index>& rows, double floor);

/// The shortest sum of simple terms in the features that describes the errors: at most three terms, each of which
/// removes at least 2 % of the squared error on every other segment of the data, which were not used to fit it.
[[nodiscard]] std::vector<gap::SparseTerm> SparseSum(const Eigen::VectorXd& error, const std::vector<Feature>& features,
                                                     const std::vector<Eigen::Index>& rows);

}  // namespace armcmc::ladder
