#include "armcmc/linear_algebra.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>

#include "fixed_size.hpp"

namespace armcmc {

ARMCMC_TRUST_NONBLOCKING_BEGIN

namespace {

/// Column by column: Eigen unrolls the solution for a vector of known size, and not that for a matrix.
template <class Matrix>
Matrix InverseOf(const Eigen::PartialPivLU<Matrix>& factor) noexcept {
  Matrix inverse = Matrix::Identity(factor.rows(), factor.cols());
  for (Eigen::Index j = 0; j < factor.cols(); ++j) inverse.col(j) = factor.solve(inverse.col(j)).eval();
  return inverse;
}

}  // namespace

ParamVector Multiply(const ParamMatrix& a, const ParamVector& b) noexcept ARMCMC_NONBLOCKING {
  return a.lazyProduct(b);
}
ParamMatrix Product(const ParamMatrix& a, const ParamMatrix& b) noexcept ARMCMC_NONBLOCKING {
  const Eigen::Index size = a.rows();
  if (a.cols() != size || b.rows() != size || b.cols() != size) return a * b;
  ParamMatrix out(size, size);
  WithFixedSize(size, [&]<class F>(F) noexcept { F::Of(&out) = F::Of(a).lazyProduct(F::Of(b)); });
  return out;
}
ParamMatrix TimesOwnTranspose(const ParamMatrix& a) noexcept ARMCMC_NONBLOCKING { return a * a.transpose(); }
ParamMatrix Inverse(const ParamMatrix& a) noexcept ARMCMC_NONBLOCKING {
  ParamMatrix out(a.rows(), a.cols());
  WithFixedSize(a.rows(), [&]<class F>(F) noexcept {
    F::Of(&out) = InverseOf(Eigen::PartialPivLU<typename F::Matrix>(F::Of(a)));
  });
  return out;
}
double Determinant(const ParamMatrix& a) noexcept ARMCMC_NONBLOCKING {
  return WithFixedSize(
      a.rows(), [&]<class F>(F) noexcept { return Eigen::PartialPivLU<typename F::Matrix>(F::Of(a)).determinant(); });
}

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

void MakeSymmetric(ParamMatrix* m) noexcept ARMCMC_NONBLOCKING {
  for (Eigen::Index i = 0; i < m->rows(); ++i)
    for (Eigen::Index j = 0; j < i; ++j) (*m)(i, j) = (*m)(j, i) = 0.5 * ((*m)(i, j) + (*m)(j, i));
}

bool MapBetween(const ParamMatrix& c, const ParamMatrix& r, ParamMatrix* a) noexcept ARMCMC_NONBLOCKING {
  ParamMatrix root;
  if (!c.allFinite() || !r.allFinite() || !CholeskyFactor(c, &root)) return false;
  const ParamMatrix inverse = Inverse(root);
  ParamMatrix relative = Product(Product(inverse, r), inverse.transpose());
  MakeSymmetric(&relative);
  const SymmetricEigen eigen = EigenOfSymmetric(relative);
  if (!eigen.converged || !(eigen.values[0] > 0.0)) return false;
  ParamMatrix stretched = eigen.vectors;
  for (Eigen::Index i = 0; i < stretched.cols(); ++i) stretched.col(i) *= std::sqrt(eigen.values[i]);
  *a = Product(Product(root, Product(stretched, eigen.vectors.transpose())), inverse);
  return a->allFinite();
}

}  // namespace armcmc
