#include "armcmc/gap/blocks.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <random>

#include "gram.hpp"

namespace armcmc::gap {
namespace {

constexpr int kDraws = 2000;
// A block that is left out may hold all that a column says: the fit without it is then kept from being singular.
constexpr double kRelativeFloor = 1e-9;

}  // namespace

std::vector<Eigen::Index> BlockEdges(Eigen::Index rows) {
  std::vector<Eigen::Index> edges(kNumBlocks + 1);
  for (int b = 0; b <= kNumBlocks; ++b) edges[static_cast<std::size_t>(b)] = rows * b / kNumBlocks;
  return edges;
}

Vector BlockSquares(const Vector& series) {
  const auto edges = BlockEdges(series.size());
  Vector squares(kNumBlocks);
  for (std::size_t b = 0; b < kNumBlocks; ++b)
    squares[static_cast<Eigen::Index>(b)] = series.segment(edges[b], edges[b + 1] - edges[b]).squaredNorm();
  return squares;
}

BlockBootstrap::BlockBootstrap(unsigned long long seed) : weights_(kDraws, kNumBlocks) {
  std::mt19937_64 engine(seed);
  for (Eigen::Index i = 0; i < kDraws; ++i) {
    for (Eigen::Index b = 0; b < kNumBlocks; ++b)
      weights_(i, b) = -std::log1p(-static_cast<double>(engine() >> 11) * 0x1p-53);
    weights_.row(i) *= kNumBlocks / weights_.row(i).sum();
  }
}

double BlockBootstrap::ProbabilityAbove(const Vector& per_block, double threshold) const {
  return ((weights_ * per_block).array() > threshold).cast<double>().mean();
}

Vector BlockBootstrap::SoftShare(const Matrix& per_block, double temperature) const {
  const Matrix totals = weights_ * per_block;
  Vector share = Vector::Zero(per_block.cols());
  for (Eigen::Index i = 0; i < totals.rows(); ++i) {
    const Eigen::ArrayXd weight = ((totals.row(i).array() - totals.row(i).maxCoeff()) / temperature).exp().transpose();
    share += (weight / weight.sum()).matrix() / static_cast<double>(totals.rows());
  }
  return share;
}

double BlockBootstrap::RatioQuantile(const Vector& a, const Vector& b, double quantile) const {
  const Vector ratio = (weights_ * a).cwiseQuotient(weights_ * b);
  std::vector<double> sorted(ratio.data(), ratio.data() + ratio.size());
  const auto at = static_cast<std::ptrdiff_t>(quantile * static_cast<double>(sorted.size() - 1));
  std::nth_element(sorted.begin(), sorted.begin() + at, sorted.end());
  return sorted[static_cast<std::size_t>(at)];
}

Matrix BlockGrams::TotalGram() const {
  Matrix total = gram.front();
  for (std::size_t b = 1; b < gram.size(); ++b) total += gram[b];
  return total;
}

Vector BlockGrams::TotalCross() const {
  Vector total = cross.front();
  for (std::size_t b = 1; b < cross.size(); ++b) total += cross[b];
  return total;
}

BlockGrams BlockGrams::Only(const std::vector<Eigen::Index>& chosen) const {
  BlockGrams some;
  some.squares = squares;
  for (std::size_t b = 0; b < gram.size(); ++b) {
    some.gram.emplace_back(gram[b](chosen, chosen));
    some.cross.emplace_back(cross[b](chosen));
  }
  return some;
}

BlockGrams MakeGrams(const Matrix& columns, const Vector& residual) {
  const auto edges = BlockEdges(residual.size());
  BlockGrams grams;
  grams.squares = BlockSquares(residual);
  if (columns.cols() == 0) {
    grams.gram.assign(kNumBlocks, Matrix(0, 0));
    grams.cross.assign(kNumBlocks, Vector(0));
    return grams;
  }
  for (std::size_t b = 0; b < kNumBlocks; ++b) {
    const auto block = columns.middleRows(edges[b], edges[b + 1] - edges[b]);
    grams.gram.push_back(GramOf(columns, edges[b], edges[b + 1] - edges[b]));
    grams.cross.push_back(block.transpose() * residual.segment(edges[b], edges[b + 1] - edges[b]));
  }
  return grams;
}

Vector LeaveBlockOut(const BlockGrams& grams, const Vector& ridge) {
  return LeaveBlockOut(grams, grams.TotalGram(), grams.TotalCross(), ridge);
}

Vector LeaveBlockOut(const BlockGrams& grams, Matrix total, const Vector& cross, const Vector& ridge) {
  const Eigen::Index k = cross.size();
  if (k == 0) return grams.squares;
  total.diagonal() += ridge;
  // Columns in very different units would make the floor meaningless: it is relative to each.
  total.diagonal() += kRelativeFloor * total.diagonal();
  Vector squares(kNumBlocks), c(k), right(k), error(k);
  Matrix without(k, k);
  for (std::size_t b = 0; b < kNumBlocks; ++b) {
    without = total - grams.gram[b];
    right = cross - grams.cross[b];
    // A factor that fails leaves the matrix spoilt: only then is one made that pivots.
    const Eigen::LLT<Eigen::Ref<Matrix>> factor(without);
    if (factor.info() == Eigen::Success)
      c = factor.solve(right);
    else
      c = (total - grams.gram[b]).ldlt().solve(right);
    error.noalias() = grams.gram[b] * c;
    squares[static_cast<Eigen::Index>(b)] =
        grams.squares[static_cast<Eigen::Index>(b)] - 2.0 * c.dot(grams.cross[b]) + c.dot(error);
  }
  return squares;
}

}  // namespace armcmc::gap
