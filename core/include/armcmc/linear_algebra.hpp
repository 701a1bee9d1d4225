#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "armcmc/nonblocking.hpp"
#include "armcmc/types.hpp"

namespace armcmc {

// Bounded sizes live on the stack: no operation on them allocates. Never part of a type that the scoring kernels read:
// Eigen's alignment, and with it the layout, depends on the instruction set that a file is compiled for.
using ParamVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxParams, 1>;
using ParamMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxParams, kMaxParams>;

// Eigen's products and factorisations contain a branch for large sizes that goes to the heap, which is all that clang's
// analysis of function effects sees of them. They are called here only, for types whose bound is checked while
// compiling; that the branch is not taken is checked by RealtimeSanitizer and by the tests that count allocations.
ARMCMC_TRUST_NONBLOCKING_BEGIN

/// A type whose largest size is known and small, so that Eigen keeps it, and every temporary of it, on the stack.
template <class Matrix>
concept BoundedMatrix = Matrix::MaxSizeAtCompileTime != Eigen::Dynamic&& Matrix::MaxSizeAtCompileTime <= 256;

/// The value of an expression: a product, an inverse, a sum of them.
template <class Expression>
requires BoundedMatrix<typename Expression::PlainObject>
[[nodiscard]] typename Expression::PlainObject Evaluate(const Expression& expression) noexcept ARMCMC_NONBLOCKING {
  return expression;
}

/// L D L' of a symmetric matrix.
template <BoundedMatrix Matrix>
[[nodiscard]] Eigen::LDLT<Matrix> FactorSymmetric(const Matrix& a) noexcept ARMCMC_NONBLOCKING {
  return a.ldlt();
}

/// x of a x = b. Not finite where a is singular.
template <BoundedMatrix Matrix, BoundedMatrix Vector>
[[nodiscard]] Vector Solve(const Eigen::LDLT<Matrix>& factor_of_a, const Vector& b) noexcept ARMCMC_NONBLOCKING {
  return factor_of_a.solve(b);
}

/// Whether a symmetric matrix, of which the lower half is read, is a covariance that can be inverted.
template <BoundedMatrix Matrix>
[[nodiscard]] bool IsPositiveDefinite(const Matrix& a) noexcept ARMCMC_NONBLOCKING {
  const Eigen::LDLT<Matrix> factor = a.ldlt();
  return a.allFinite() && factor.info() == Eigen::Success && (factor.vectorD().array() > 0.0).all();
}

template <BoundedMatrix Matrix>
[[nodiscard]] double Determinant(const Matrix& a) noexcept ARMCMC_NONBLOCKING {
  return a.determinant();
}

/// Eigenvalues, ascending, and eigenvectors of a symmetric matrix; see info() of the result.
template <BoundedMatrix Matrix>
[[nodiscard]] Eigen::SelfAdjointEigenSolver<Matrix> SymmetricEigen(const Matrix& a) noexcept ARMCMC_NONBLOCKING {
  return Eigen::SelfAdjointEigenSolver<Matrix>(a);
}

ARMCMC_TRUST_NONBLOCKING_END

}  // namespace armcmc
