#pragma once

#include <vector>

#include "armcmc/gap/types.hpp"

namespace armcmc::gap {

inline constexpr int kNumBlocks = 40;  ///< Contiguous in time; each is left out once.

/// First row of each block, and the end.
[[nodiscard]] std::vector<Eigen::Index> BlockEdges(Eigen::Index rows);
/// Sum of the squares in each block.
[[nodiscard]] Vector BlockSquares(const Vector& series);

/// Bayesian bootstrap over blocks (Rubin 1981): shares of total weight kNumBlocks, Dirichlet(1, ..., 1) distributed.
/// A result that depends on few blocks has a wide distribution; no normal approximation is made.
class BlockBootstrap {
 public:
  explicit BlockBootstrap(unsigned long long seed);
  /// Share of the draws in which the weighted sum of `per_block` exceeds `threshold`.
  [[nodiscard]] double ProbabilityAbove(const Vector& per_block, double threshold) const;
  /// For per-block scores with one column per candidate: mean over the draws of exp(score / temperature), normalised
  /// over the candidates (pseudo-BMA+, Yao et al. 2018).
  [[nodiscard]] Vector SoftShare(const Matrix& per_block, double temperature) const;
  /// Quantile of the weighted ratio sum(a) / sum(b).
  [[nodiscard]] double RatioQuantile(const Vector& a, const Vector& b, double quantile) const;

 private:
  Matrix weights_;  ///< [draw][block]
};

/// The sums over blocks from which leave-block-out least squares is computed without another pass over the rows.
///
/// For whitened columns X and residual r with ridge L, the coefficients without block b are
///   c_b = (H - X_b'X_b + L)^-1 (g - X_b'r_b),   H = X'X, g = X'r,
/// and their squared error in b is r_b'r_b - 2 c_b'X_b'r_b + c_b'X_b'X_b c_b.
struct BlockGrams {
  std::vector<Matrix> gram;   ///< X_b'X_b
  std::vector<Vector> cross;  ///< X_b'r_b
  Vector squares;             ///< r_b'r_b

  [[nodiscard]] Matrix TotalGram() const;
  [[nodiscard]] Vector TotalCross() const;
  /// Of some of the columns.
  [[nodiscard]] BlockGrams Only(const std::vector<Eigen::Index>& chosen) const;
};
[[nodiscard]] BlockGrams MakeGrams(const Matrix& columns, const Vector& residual);

/// Squared error in each block of the fit to all other blocks.
[[nodiscard]] Vector LeaveBlockOut(const BlockGrams& grams, const Vector& ridge);
/// The same where the sums over all blocks are known.
[[nodiscard]] Vector LeaveBlockOut(const BlockGrams& grams, Matrix total_gram, const Vector& total_cross,
                                   const Vector& ridge);

}  // namespace armcmc::gap
