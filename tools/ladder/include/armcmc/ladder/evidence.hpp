#pragma once

#include <Eigen/Core>
#include <vector>

#include "armcmc/gap/result.hpp"
#include "armcmc/ladder/features.hpp"

namespace armcmc::ladder {

/// Where errors are larger than elsewhere: of every feature the tenth of the rows with the lowest values, the highest,
/// or those next to zero, whichever holds most; largest share first.
/// @param error  [row] Unit of what is explained. @param rows  That count.
/// @param floor  Standard deviation of the noise.
[[nodiscard]] std::vector<gap::Where> WhereErrorsAre(const Eigen::VectorXd& error, const std::vector<Feature>& features,
                                                     const std::vector<Eigen::Index>& rows, double floor);

/// The shortest sum of simple terms in the features that describes the errors: at most three, each of which takes 2 %
/// of the squared error on every other stretch of the data, to which it was not fitted.
[[nodiscard]] std::vector<gap::SparseTerm> SparseSum(const Eigen::VectorXd& error, const std::vector<Feature>& features,
                                                     const std::vector<Eigen::Index>& rows);

}  // namespace armcmc::ladder
