#include "armcmc/linear_algebra.hpp"
#include <limits>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>

namespace armcmc {

ARMCMC_TRUST_NONBLOCKING_BEGIN

namespace {

/// Of so many rows and columns, as all matrices of one model are. With a size that the compiler knows, products of
/// small matrices take a third of the time.
template <int kSize>
using Square = Eigen::Map<const Eigen::Matrix<double, kSize, kSize>>;
template <int kSize>
ParamMatrix ProductOf(const ParamMatrix& a, const ParamMatrix& b) noexcept {
  ParamMatrix out(kSize, kSize);
  Eigen::Map<Eigen::Matrix<double, kSize, kSize>>(out.data()) =
      Square<kSize>(a.data()).lazyProduct(Square<kSize>(b.data()));
  return out;
}
/// Column by column: Eigen unrolls the solution for a vector of known size, and not that for a matrix.
template <class Matrix>
Matrix InverseOf(const Eigen::PartialPivLU<Matrix>& factor) noexcept {
  Matrix inverse = Matrix::Identity(factor.rows(), factor.cols());
  for (Eigen::Index j = 0; j < factor.cols(); ++j) inverse.col(j) = factor.solve(inverse.col(j)).eval();
  return inverse;
}
template <int kSize>
ParamMatrix InverseOf(const ParamMatrix& a) noexcept {
  ParamMatrix out(kSize, kSize);
  Eigen::Map<Eigen::Matrix<double, kSize, kSize>>(out.data()) =
      InverseOf(Eigen::PartialPivLU<Eigen::Matrix<double, kSize, kSize>>(Square<kSize>(a.data())));
  return out;
}

template <int kSize>
double DeterminantOf(const ParamMatrix& a) noexcept {
  return Eigen::PartialPivLU<Eigen::Matrix<double, kSize, kSize>>(Square<kSize>(a.data())).determinant();
}
template <int kSize>
double MultiplyBy(const JointVector& gradient, const JointMatrix& information, JointVector* mean,
                  JointMatrix* covariance) noexcept {
  constexpr int kMost = kSize == Eigen::Dynamic ? 2 * kMaxParams : kSize;
  using Matrix = Eigen::Matrix<double, kSize, kSize, 0, kMost, kMost>;
  using Vector = Eigen::Matrix<double, kSize, 1, 0, kMost, 1>;
  const Eigen::Map<const Matrix> h(information.data(), information.rows(), information.cols());
  const Matrix c = *covariance;
  const Vector m = *mean;
  // C <- C (1 + H C)^-1, which needs no inverse of C: a velocity may be known exactly.
  Matrix spread = h.lazyProduct(c);
  spread.diagonal().array() += 1.0;
  const Eigen::PartialPivLU<Matrix> factor(spread);
  const Vector pulled = h.lazyProduct(m);
  const Vector residual = gradient - pulled;
  const Vector step = factor.solve(residual);
  const Vector move = c.lazyProduct(step);
  *mean += move;
  const Matrix inverse = InverseOf(factor);
  const Matrix product = c.lazyProduct(inverse);
  *covariance = 0.5 * (product + product.transpose());
  return m.dot(gradient) - 0.5 * m.dot(pulled) + 0.5 * residual.dot(move) - 0.5 * std::log(factor.determinant());
}

}  // namespace

ParamVector Multiply(const ParamMatrix& a, const ParamVector& b) noexcept ARMCMC_NONBLOCKING {
  return a.lazyProduct(b);
}
ParamMatrix Product(const ParamMatrix& a, const ParamMatrix& b) noexcept ARMCMC_NONBLOCKING {
  const Eigen::Index size = a.rows();
  if (a.cols() == size && b.rows() == size && b.cols() == size) {
    if (size == 2) return ProductOf<2>(a, b);
    if (size == 3) return ProductOf<3>(a, b);
    if (size == 4) return ProductOf<4>(a, b);
  }
  return a * b;
}
ParamMatrix TimesOwnTranspose(const ParamMatrix& a) noexcept ARMCMC_NONBLOCKING { return a * a.transpose(); }
ParamMatrix Inverse(const ParamMatrix& a) noexcept ARMCMC_NONBLOCKING {
  if (a.rows() == 2) return InverseOf<2>(a);
  if (a.rows() == 3) return InverseOf<3>(a);
  if (a.rows() == 4) return InverseOf<4>(a);
  return a.inverse();
}
double Determinant(const ParamMatrix& a) noexcept ARMCMC_NONBLOCKING {
  if (a.rows() == 2) return DeterminantOf<2>(a);
  if (a.rows() == 3) return DeterminantOf<3>(a);
  if (a.rows() == 4) return DeterminantOf<4>(a);
  return a.determinant();
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

double MultiplyByQuadratic(const JointVector& gradient, const JointMatrix& information, JointVector* mean,
                           JointMatrix* covariance) noexcept ARMCMC_NONBLOCKING {
  if (mean->size() == 4) return MultiplyBy<4>(gradient, information, mean, covariance);
  if (mean->size() == 6) return MultiplyBy<6>(gradient, information, mean, covariance);
  if (mean->size() == 8) return MultiplyBy<8>(gradient, information, mean, covariance);
  return MultiplyBy<Eigen::Dynamic>(gradient, information, mean, covariance);
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
