#pragma once

#include "armcmc/linear_algebra.hpp"

namespace armcmc {

/// Vectors and matrices of a size that the compiler knows: for small ones its loops take a third of the time of those
/// that count. Include it in few files, and see there to the effects of Eigen's branches for large sizes.
/// @tparam kSize  Number of parameters, or Eigen::Dynamic.
template <int kSize>
struct FixedSize {
  static constexpr int kDim = kSize;
  static constexpr int kMost = kDim == Eigen::Dynamic ? kMaxParams : kDim;
  static constexpr int kJoint = kDim == Eigen::Dynamic ? Eigen::Dynamic : 2 * kDim;
  using Vector = Eigen::Matrix<double, kDim, 1, 0, kMost, 1>;
  using Matrix = Eigen::Matrix<double, kDim, kDim, 0, kMost, kMost>;
  using JointVector = Eigen::Matrix<double, kJoint, 1, 0, 2 * kMost, 1>;
  using JointMatrix = Eigen::Matrix<double, kJoint, kJoint, 0, 2 * kMost, 2 * kMost>;

  /// The same numbers with the size in their type. @pre The size is kSize.
  static Eigen::Map<const Vector> Of(const ParamVector& v) noexcept { return {v.data(), v.size()}; }
  static Eigen::Map<Vector> Of(ParamVector* v) noexcept { return {v->data(), v->size()}; }
  static Eigen::Map<const Matrix> Of(const ParamMatrix& m) noexcept { return {m.data(), m.rows(), m.cols()}; }
  static Eigen::Map<Matrix> Of(ParamMatrix* m) noexcept { return {m->data(), m->rows(), m->cols()}; }
};

/// use(FixedSize<dim>{}) for the sizes that most plants have, use(FixedSize<Eigen::Dynamic>{}) for the others.
template <class Use>
auto WithFixedSize(Eigen::Index dim, const Use& use) noexcept {
  switch (dim) {
    case 1: return use(FixedSize<1>{});
    case 2: return use(FixedSize<2>{});
    case 3: return use(FixedSize<3>{});
    case 4: return use(FixedSize<4>{});
    default: return use(FixedSize<Eigen::Dynamic>{});
  }
}

}  // namespace armcmc
