#include "armcmc/linear_algebra.hpp"
#include <limits>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>

namespace armcmc {

ARMCMC_TRUST_NONBLOCKING_BEGIN

ParamVector Multiply(const ParamMatrix& a, const ParamVector& b) noexcept ARMCMC_NONBLOCKING { return a * b; }
ParamMatrix Product(const ParamMatrix& a, const ParamMatrix& b) noexcept ARMCMC_NONBLOCKING { return a * b; }
ParamMatrix TimesOwnTranspose(const ParamMatrix& a) noexcept ARMCMC_NONBLOCKING { return a * a.transpose(); }
ParamMatrix Inverse(const ParamMatrix& a) noexcept ARMCMC_NONBLOCKING { return a.inverse(); }
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

double MultiplyByQuadratic(const JointVector& gradient, const JointMatrix& information, JointVector* mean,
                           JointMatrix* covariance) noexcept ARMCMC_NONBLOCKING {
  // C <- C (1 + H C)^-1, which needs no inverse of C: a velocity may be known exactly.
  JointMatrix spread = information.lazyProduct(*covariance);
  spread.diagonal().array() += 1.0;
  const Eigen::PartialPivLU<JointMatrix> factor(spread);
  const JointVector pulled = information.lazyProduct(*mean);
  const JointVector residual = gradient - pulled;
  const JointVector step = factor.solve(residual);
  const JointVector move = covariance->lazyProduct(step);
  const double log_integral =
      mean->dot(gradient) - 0.5 * mean->dot(pulled) + 0.5 * residual.dot(move) - 0.5 * std::log(factor.determinant());
  *mean += move;
  const JointMatrix inverse = factor.inverse();
  *covariance = JointMatrix(covariance->lazyProduct(inverse));
  *covariance = JointMatrix(0.5 * (*covariance + covariance->transpose()));
  return log_integral;
}

double LogDeterminant(const JointMatrix& a) noexcept ARMCMC_NONBLOCKING {
  const Eigen::LLT<JointMatrix> factor(a);
  if (factor.info() != Eigen::Success) return std::numeric_limits<double>::quiet_NaN();
  double log = 0.0;
  for (Eigen::Index i = 0; i < a.rows(); ++i) log += 2.0 * std::log(factor.matrixLLT()(i, i));
  return log;
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
