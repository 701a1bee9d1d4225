#include "armcmc/linear_algebra.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

namespace armcmc {

ARMCMC_TRUST_NONBLOCKING_BEGIN

ParamVector Multiply(const ParamMatrix& a, const ParamVector& b) noexcept ARMCMC_NONBLOCKING { return a * b; }
ParamMatrix Product(const ParamMatrix& a, const ParamMatrix& b) noexcept ARMCMC_NONBLOCKING { return a * b; }
ParamMatrix TimesOwnTranspose(const ParamMatrix& a) noexcept ARMCMC_NONBLOCKING { return a * a.transpose(); }
ParamMatrix Inverse(const ParamMatrix& a) noexcept ARMCMC_NONBLOCKING { return a.inverse(); }
void MakeSymmetric(ParamMatrix* a) noexcept {
  for (Eigen::Index i = 0; i < a->rows(); ++i)
    for (Eigen::Index j = 0; j < i; ++j) (*a)(i, j) = (*a)(j, i) = 0.5 * ((*a)(i, j) + (*a)(j, i));
}

double Determinant(const ParamMatrix& a) noexcept ARMCMC_NONBLOCKING { return a.determinant(); }

bool IsPositiveDefinite(const ParamMatrix& a) noexcept ARMCMC_NONBLOCKING {
  const Eigen::LDLT<ParamMatrix> factor = a.ldlt();
  return a.allFinite() && factor.info() == Eigen::Success && (factor.vectorD().array() > 0.0).all();
}

bool CholeskyFactor(const ParamMatrix& a, ParamMatrix* l) noexcept ARMCMC_NONBLOCKING {
  const Eigen::LLT<ParamMatrix> factor = a.llt();
  *l = factor.matrixL();
  return factor.info() == Eigen::Success && l->allFinite();
}

SymmetricFactor::SymmetricFactor(const ParamMatrix& a) noexcept ARMCMC_NONBLOCKING : factor_(a) {}
ParamVector SymmetricFactor::Solve(const ParamVector& b) const noexcept ARMCMC_NONBLOCKING { return factor_.solve(b); }
ParamVector SymmetricFactor::Diagonal() const noexcept ARMCMC_NONBLOCKING { return factor_.vectorD(); }

SymmetricEigen EigenOfSymmetric(const ParamMatrix& a) noexcept ARMCMC_NONBLOCKING {
  const Eigen::SelfAdjointEigenSolver<ParamMatrix> solver(a);
  SymmetricEigen eigen;
  eigen.converged = solver.info() == Eigen::Success;
  if (eigen.converged) {
    eigen.values = solver.eigenvalues();
    eigen.vectors = solver.eigenvectors();
    // The signs depend on the number of iterations of the solver, which the last bit of the matrix may change.
    constexpr double kGolden = 0.6180339887498949;  // components of equal magnitude and opposite sign do not cancel
    for (Eigen::Index j = 0; j < eigen.vectors.cols(); ++j) {
      double sum = 0.0;
      for (Eigen::Index i = eigen.vectors.rows(); i-- > 0;) sum = kGolden * sum + eigen.vectors(i, j);
      if (sum < 0.0) eigen.vectors.col(j) *= -1.0;
    }
  }
  return eigen;
}

ARMCMC_TRUST_NONBLOCKING_END

}  // namespace armcmc
