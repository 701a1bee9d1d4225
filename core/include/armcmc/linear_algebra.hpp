#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "armcmc/nonblocking.hpp"
#include "armcmc/types.hpp"

namespace armcmc {

// Bounded sizes live on the stack: no operation on them allocates. Never part of a type that the scoring kernels read:
// Eigen's alignment, and with it the layout, depends on the instruction set that a file is compiled for.
using ParamVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxParams, 1>;
using ParamMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxParams, kMaxParams>;

// Products and factorisations of parameter vectors and matrices (d <= kMaxParams). They are functions of one source
// file, and not Eigen's expressions, for two reasons: Eigen's templates take seconds to compile wherever they are used,
// and contain a branch for large sizes that goes to the heap, which is all that clang's analysis of function effects
// sees of them. That the branch is not taken is checked by RealtimeSanitizer and by the tests that count allocations.

/// A b.
[[nodiscard]] ParamVector Multiply(const ParamMatrix& a, const ParamVector& b) noexcept ARMCMC_NONBLOCKING;
/// A B.
[[nodiscard]] ParamMatrix Product(const ParamMatrix& a, const ParamMatrix& b) noexcept ARMCMC_NONBLOCKING;
/// A A'.
[[nodiscard]] ParamMatrix TimesOwnTranspose(const ParamMatrix& a) noexcept ARMCMC_NONBLOCKING;
/// A^-1; not finite where A is singular.
[[nodiscard]] ParamMatrix Inverse(const ParamMatrix& a) noexcept ARMCMC_NONBLOCKING;
[[nodiscard]] double Determinant(const ParamMatrix& a) noexcept ARMCMC_NONBLOCKING;
/// Whether a symmetric matrix, of which the lower half is read, is a covariance that can be inverted.
[[nodiscard]] bool IsPositiveDefinite(const ParamMatrix& a) noexcept ARMCMC_NONBLOCKING;
/// L of A = L L', the lower half of A being read. @return false, with *l undefined, where A is not positive definite.
[[nodiscard]] bool CholeskyFactor(const ParamMatrix& a, ParamMatrix* l) noexcept ARMCMC_NONBLOCKING;

/// L D L' of a symmetric matrix, of which the lower half is read.
class SymmetricFactor {
 public:
  explicit SymmetricFactor(const ParamMatrix& a) noexcept ARMCMC_NONBLOCKING;
  /// x of A x = b; not finite where A is singular.
  [[nodiscard]] ParamVector Solve(const ParamVector& b) const noexcept ARMCMC_NONBLOCKING;
  /// The diagonal of D, in the order of the pivots: its product is the determinant.
  [[nodiscard]] ParamVector Diagonal() const noexcept ARMCMC_NONBLOCKING;

 private:
  Eigen::LDLT<ParamMatrix> factor_;
};

/// Eigenvalues, ascending, and eigenvectors, by columns, of a symmetric matrix.
struct SymmetricEigen {
  bool converged = false;
  ParamVector values;
  ParamMatrix vectors;
};
[[nodiscard]] SymmetricEigen EigenOfSymmetric(const ParamMatrix& a) noexcept ARMCMC_NONBLOCKING;

/// (A + A') / 2.
void MakeSymmetric(ParamMatrix* a) noexcept ARMCMC_NONBLOCKING;
/// A with A C A' = R for two covariances. @return false if C or R is none.
[[nodiscard]] bool MapBetween(const ParamMatrix& c, const ParamMatrix& r, ParamMatrix* a) noexcept ARMCMC_NONBLOCKING;

}  // namespace armcmc
