#include "gram.hpp"

#include <algorithm>
#include <cstring>

#include "armcmc/support/wider_lanes.hpp"

namespace armcmc::gap {
namespace {

/// Adds the products of all pairs of columns to the lower triangle of `gram`, four pairs at a time.
/// @param rows    A multiple of 8.
/// @param stride  Numbers from one column to the next.
ARMCMC_FOR_WIDER_LANES void AddProducts(const double* x, Eigen::Index stride, Eigen::Index rows, Eigen::Index columns,
                                        double* gram) {
  constexpr Eigen::Index kLanes = 8;
  using Lanes __attribute__((vector_size(kLanes * sizeof(double)))) = double;
  for (Eigen::Index j = 0; j < columns; j += 2)
    for (Eigen::Index i = j; i < columns; i += 2) {
      // The last of an odd number of columns is paired with itself.
      const Eigen::Index next_i = std::min(i + 1, columns - 1), next_j = std::min(j + 1, columns - 1);
      const double* const from[4] = {x + i * stride, x + next_i * stride, x + j * stride, x + next_j * stride};
      Lanes sums[4] = {};
      for (Eigen::Index r = 0; r < rows; r += kLanes) {
        Lanes value[4];
        for (int c = 0; c < 4; ++c) std::memcpy(&value[c], from[c] + r, sizeof(Lanes));
        sums[0] += value[0] * value[2];
        sums[1] += value[1] * value[2];
        sums[2] += value[0] * value[3];
        sums[3] += value[1] * value[3];
      }
      double total[4] = {};
      for (int c = 0; c < 4; ++c)
        for (Eigen::Index l = 0; l < kLanes; ++l) total[c] += sums[c][l];
      gram[j * columns + i] += total[0];
      if (next_i > i) gram[j * columns + next_i] += total[1];
      if (next_j > j && i > j) gram[next_j * columns + i] += total[2];
      if (next_j > j && next_i > i) gram[next_j * columns + next_i] += total[3];
    }
}

}  // namespace

Matrix GramOf(const Matrix& x, Eigen::Index first, Eigen::Index rows) {
  constexpr Eigen::Index kChunk = 256;  // rows that stay in a fast cache while all pairs are multiplied
  constexpr Eigen::Index kPadded = 8;
  const Eigen::Index columns = x.cols(), whole = rows / kPadded * kPadded;
  Matrix gram = Matrix::Zero(columns, columns);
  if (columns == 0) return gram;
  for (Eigen::Index at = 0; at < whole; at += kChunk)
    AddProducts(x.data() + first + at, x.rows(), std::min(kChunk, whole - at), columns, gram.data());
  if (whole < rows) {
    Matrix rest = Matrix::Zero(kPadded, columns);
    rest.topRows(rows - whole) = x.middleRows(first + whole, rows - whole);
    AddProducts(rest.data(), kPadded, kPadded, columns, gram.data());
  }
  gram.triangularView<Eigen::StrictlyUpper>() = gram.transpose();
  return gram;
}

}  // namespace armcmc::gap
