#include "bend_fit.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "core/weighted_sample.hpp"

namespace armcmc::bend_fit_test {
namespace {

using Sample = test::WeightedSample;
using test::drawn_normal;

/// A block that whitens the law exactly, so that the draws' own covariance is only near the identity.
DensityBlock Whitened(int dim) {
  static const MarginalTable table = MarginalTable::Normal();
  DensityBlock block;
  SetElliptic(ParamVector::Zero(dim), ParamMatrix::Identity(dim, dim), 1.0, &table, &block);
  return block;
}

TEST(FitBends, StraightDrawsAreNotTakenForBentWhateverTheirScatter) {
  // Their variances differ from one by more than a bend has to take out.
  int bent = 0;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    Sample s(
        6, 4096,
        [](std::mt19937_64& g, double* u) {
          for (int d = 0; d < 6; ++d) u[d] = drawn_normal(g);
        },
        seed);
    for (std::size_t d = 0; d < 6; ++d) s.draws.u[d] = s.row[d].data();
    s.draws.weight = s.weight.data();
    DensityBlock block = Whitened(6);
    bent += FitBends(simd::Best(), s.draws, s.scratch, &block) ? 1 : 0;
    EXPECT_EQ(block.bent, block.tapered) << seed;
  }
  EXPECT_LE(bent, 1);  // a taper in a thousand
}

TEST(FitBends, FindsTheInteractionsOfCoordinatesStraightenedOneAfterTheOther) {
  // e_2 hangs on e_1 and its square, e_3 on e_2 as straightened, e_1 c and c: all in one pass over the draws.
  Sample s(4, 4096, [](std::mt19937_64& g, double* u) {
    const double c = drawn_normal(g), e1 = drawn_normal(g), e2 = 0.1 * drawn_normal(g), e3 = 0.1 * drawn_normal(g);
    u[0] = c;
    u[1] = e1 + 0.3 * c * c;
    u[2] = e2 + 0.5 * e1 + 0.2 * e1 * e1 - 0.4 * c;
    u[3] = e3 + 3.0 * e2 + 0.6 * e1 * c;
  });
  for (std::size_t d = 0; d < 4; ++d) s.draws.u[d] = s.row[d].data();
  s.draws.weight = s.weight.data();
  DensityBlock block = Whitened(4);  // the axes stay u's, since their variances are equal
  for (std::size_t i = 0; i < 4; ++i) {
    block.whiten[i].fill(0.0);
    block.unwhiten[i].fill(0.0);
    block.whiten[i][i] = block.unwhiten[i][i] = 1.0;
  }
  ASSERT_TRUE(FitBends(simd::Best(), s.draws, s.scratch, &block));
  EXPECT_NEAR(block.linear[2][1], 0.5, 0.02);
  EXPECT_NEAR(block.square[2], 0.2, 0.02);
  EXPECT_NEAR(block.linear[3][2], 3.0, 0.1);
  EXPECT_NEAR(block.linear[3][1], 0.0, 0.05);
  EXPECT_NEAR(block.cross[3], 0.6, 0.02);
}

TEST(FitBends, FindsAThicknessThatChangesAlongTheRidge) {
  Sample s(2, 4096, [](std::mt19937_64& g, double* u) {
    u[0] = drawn_normal(g);
    u[1] = std::exp(0.4 * u[0]) * drawn_normal(g);
  });
  for (std::size_t d = 0; d < 2; ++d) s.draws.u[d] = s.row[d].data();
  s.draws.weight = s.weight.data();
  DensityBlock block = Whitened(2);
  for (std::size_t i = 0; i < 2; ++i) {
    block.whiten[i].fill(0.0);
    block.unwhiten[i].fill(0.0);
    block.whiten[i][i] = block.unwhiten[i][i] = 1.0;
  }
  ASSERT_TRUE(FitBends(simd::Best(), s.draws, s.scratch, &block));
  ASSERT_TRUE(block.tapered);
  EXPECT_NEAR(block.thickness[1][0], 0.4, 0.06);
  EXPECT_NEAR(block.thickness[1][1], 0.0, 0.05);
}

}  // namespace
}  // namespace armcmc::bend_fit_test
