#include "armcmc/gap/blocks.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <vector>

#include "gram.hpp"
#include "tools/gap/gap_rig.hpp"

namespace armcmc::gap::blocks_test {
namespace {

using test::Noise;

Matrix NoiseColumns(Eigen::Index rows, Eigen::Index cols) {
  Matrix columns(rows, cols);
  for (Eigen::Index c = 0; c < cols; ++c)
    columns.col(c) = std::pow(10.0, static_cast<double>(c) - 2.0) * Noise(rows, 100u + static_cast<unsigned>(c));
  return columns;
}

TEST(Blocks, CoverEveryRowOnceWhateverTheCount) {
  for (const Eigen::Index rows : {40, 41, 79, 403, 7000, 7013, 12}) {
    const auto edges = BlockEdges(rows);
    ASSERT_EQ(edges.size(), static_cast<std::size_t>(kNumBlocks) + 1);
    EXPECT_EQ(edges.front(), 0);
    EXPECT_EQ(edges.back(), rows);
    for (std::size_t b = 1; b < edges.size(); ++b) {
      EXPECT_LE(edges[b - 1], edges[b]);
      EXPECT_LE(edges[b] - edges[b - 1], rows / kNumBlocks + 1);
    }
    const Vector series = Noise(rows, 1);
    EXPECT_NEAR(BlockSquares(series).sum(), series.squaredNorm(), 1e-10 * series.squaredNorm());
  }
}

// The closed form against 40 refits that never see the block that they are judged on.
TEST(LeaveBlockOut, EqualsRefitsOfAllOtherBlocks) {
  for (const Eigen::Index rows : {400, 403, 1999}) {
    for (const double strength : {0.0, 0.3}) {
      const Matrix columns = NoiseColumns(rows, 5);
      const Vector residual = columns * Vector{{30.0, -2.0, 0.4, 0.0, 0.001}} + Noise(rows, 7);
      Vector ridge(5);
      for (Eigen::Index c = 0; c < 5; ++c) ridge[c] = strength * columns.col(c).squaredNorm();
      const Vector closed = LeaveBlockOut(MakeGrams(columns, residual), ridge);
      const auto edges = BlockEdges(rows);
      for (std::size_t b = 0; b < kNumBlocks; ++b) {
        const Eigen::Index first = edges[b], count = edges[b + 1] - edges[b], others = rows - count;
        Matrix x(others + 5, 5);
        Vector y = Vector::Zero(others + 5);
        x << columns.topRows(first), columns.bottomRows(rows - first - count), Matrix(ridge.cwiseSqrt().asDiagonal());
        y.head(others) << residual.head(first), residual.tail(rows - first - count);
        const Vector c = x.colPivHouseholderQr().solve(y);
        const double squares = (residual.segment(first, count) - columns.middleRows(first, count) * c).squaredNorm();
        EXPECT_NEAR(closed[static_cast<Eigen::Index>(b)], squares, 1e-8 * squares) << rows << " rows, block " << b;
      }
    }
  }
}

// A column without anything in it makes the products singular.
TEST(LeaveBlockOut, AColumnOfZerosChangesNothing) {
  const Matrix columns = NoiseColumns(800, 3);
  const Vector residual = columns * Vector{{30.0, -2.0, 0.4}} + Noise(800, 9);
  Matrix wider = Matrix::Zero(800, 4);
  wider << columns.leftCols(1), Vector::Zero(800), columns.rightCols(2);
  const Vector without = LeaveBlockOut(MakeGrams(columns, residual), Vector::Zero(3));
  const Vector with = LeaveBlockOut(MakeGrams(wider, residual), Vector::Zero(4));
  for (Eigen::Index b = 0; b < kNumBlocks; ++b) EXPECT_NEAR(with[b], without[b], 1e-9 * without[b]);
}

TEST(BlockGrams, OfSomeColumnsAreAsIfThereWereNoOthers) {
  const Matrix columns = NoiseColumns(403, 6);
  const Vector residual = Noise(403, 11);
  const std::vector<Eigen::Index> chosen = {1, 2, 5};
  const BlockGrams some = MakeGrams(columns, residual).Only(chosen);
  const BlockGrams own = MakeGrams(columns(Eigen::all, chosen), residual);
  EXPECT_TRUE(some.TotalGram().isApprox(own.TotalGram(), 1e-12));
  EXPECT_TRUE(some.TotalCross().isApprox(own.TotalCross(), 1e-12));
  EXPECT_EQ(some.squares, own.squares);
}

TEST(GramOf, IsTheProductWhateverTheCounts) {
  for (const Eigen::Index rows : {0, 1, 7, 8, 9, 175, 256, 1001})
    for (const Eigen::Index cols : {1, 2, 3, 6, 7}) {
      const Matrix columns = NoiseColumns(rows + 5, cols);
      const Matrix block = columns.middleRows(3, rows), product = block.transpose() * block;
      const Matrix gram = GramOf(columns, 3, rows);
      ASSERT_EQ(gram.rows(), cols);
      EXPECT_EQ(gram, Matrix(gram.transpose()));
      EXPECT_TRUE(rows == 0 || gram.isApprox(product, 1e-13)) << rows << " x " << cols;
      EXPECT_TRUE(rows > 0 || gram.isZero(0.0));
    }
  EXPECT_EQ(GramOf(NoiseColumns(9, 0), 3, 5).size(), 0);
}

TEST(LeaveBlockOut, WithoutColumnsIsTheResidual) {
  const Vector residual = Noise(500, 3);
  const Vector squares = LeaveBlockOut(MakeGrams(Matrix(500, 0), residual), Vector(0));
  EXPECT_EQ(squares, BlockSquares(residual));
}

TEST(LeaveBlockOut, AColumnThatLivesInOneBlockExplainsNothingThere) {
  Matrix columns = Matrix::Zero(800, 2);
  columns.col(0).setOnes();
  columns.col(1).segment(100, 20).setOnes();  // block 5
  const Vector residual = columns.col(1) * 5.0 + 0.1 * Noise(800, 3);
  const Vector squares = LeaveBlockOut(MakeGrams(columns, residual), Vector::Zero(2));
  ASSERT_TRUE(squares.allFinite());
  EXPECT_GT(squares[5], 400.0) << "5^2 x 20 rows that no other block says anything on";
}

TEST(LeaveBlockOut, AColumnThatSaysNothingDoesNoHarm) {
  Matrix columns = Matrix::Zero(800, 2);
  columns.col(0).setOnes();
  const Vector residual = Noise(800, 3);
  const Vector with = LeaveBlockOut(MakeGrams(columns, residual), Vector::Constant(2, 1e-6));
  const Vector without = LeaveBlockOut(MakeGrams(columns.leftCols(1), residual), Vector::Constant(1, 1e-6));
  ASSERT_TRUE(with.allFinite());
  EXPECT_TRUE(with.isApprox(without, 1e-12));
}

TEST(BlockBootstrap, IsTheSameForASeedAndAnotherForAnother) {
  const Vector scores = Noise(kNumBlocks, 5);
  const BlockBootstrap a(4), b(4), c(5);
  EXPECT_EQ(a.ProbabilityAbove(scores, 1.0), b.ProbabilityAbove(scores, 1.0));
  EXPECT_EQ(a.RatioQuantile(scores, Vector::Ones(kNumBlocks), 0.3),
            b.RatioQuantile(scores, Vector::Ones(kNumBlocks), 0.3));
  EXPECT_NE(a.RatioQuantile(scores, Vector::Ones(kNumBlocks), 0.3),
            c.RatioQuantile(scores, Vector::Ones(kNumBlocks), 0.3));
}

TEST(BlockBootstrap, WeightsAreSharesOfAllBlocks) {
  const BlockBootstrap bootstrap(1);
  const Vector ones = Vector::Ones(kNumBlocks);
  EXPECT_EQ(bootstrap.ProbabilityAbove(ones, kNumBlocks - 1e-9), 1.0);
  EXPECT_EQ(bootstrap.ProbabilityAbove(ones, kNumBlocks + 1e-9), 0.0);
  EXPECT_EQ(bootstrap.ProbabilityAbove(-ones, 0.0), 0.0);
  EXPECT_EQ(bootstrap.ProbabilityAbove(Vector::Zero(kNumBlocks), 0.0), 0.0);
}

TEST(BlockBootstrap, WhatOneBlockDecidesIsNotSure) {
  const BlockBootstrap bootstrap(1);
  Vector one = Vector::Constant(kNumBlocks, -0.5);
  one[17] = 30.0;  // the sum is 10.5
  const double p = bootstrap.ProbabilityAbove(one, 0.0);
  EXPECT_GT(p, 0.3);
  EXPECT_LT(p, 0.7);
  EXPECT_GT(bootstrap.ProbabilityAbove(Vector::Constant(kNumBlocks, 10.5 / kNumBlocks), 0.0), 0.999);
}

TEST(BlockBootstrap, SpreadOfASumIsThatOfItsBlocks) {
  const BlockBootstrap bootstrap(1);
  const Vector scores = Noise(kNumBlocks, 9);
  const Vector share = Vector::Constant(kNumBlocks, 1.0 / kNumBlocks);
  const double width = bootstrap.RatioQuantile(scores, share * kNumBlocks, 0.975) -
                       bootstrap.RatioQuantile(scores, share * kNumBlocks, 0.025);
  const double mean = scores.mean();
  const double sd = std::sqrt((scores.array() - mean).square().mean() / kNumBlocks);
  EXPECT_NEAR(width / (2.0 * 1.96 * sd), 1.0, 0.1);
}

TEST(BlockBootstrap, SoftShareIsAProbability) {
  const BlockBootstrap bootstrap(1);
  Matrix scores(kNumBlocks, 3);
  scores.col(0) = Noise(kNumBlocks, 2);
  scores.col(1) = scores.col(0);
  scores.col(2) = scores.col(0).array() - 1.0;  // 40 nats worse, in every block
  const Vector share = bootstrap.SoftShare(scores, 1.0);
  EXPECT_NEAR(share.sum(), 1.0, 1e-12);
  EXPECT_NEAR(share[0], 0.5, 1e-12);
  EXPECT_NEAR(share[1], 0.5, 1e-12);
  EXPECT_LT(share[2], 1e-12);
  EXPECT_NEAR(bootstrap.SoftShare(scores, 1e6)[2], 1.0 / 3.0, 1e-4) << "no difference is worth anything";
  EXPECT_TRUE(bootstrap.SoftShare(1e5 * scores, 1.0).allFinite());
}

TEST(BlockBootstrap, RatioOfProportionalSumsHasNoSpread) {
  const BlockBootstrap bootstrap(1);
  const Vector b = Noise(kNumBlocks, 2).cwiseAbs();
  for (const double q : {0.0, 0.025, 0.5, 1.0}) EXPECT_NEAR(bootstrap.RatioQuantile(0.7 * b, b, q), 0.7, 1e-12);
}

}  // namespace
}  // namespace armcmc::gap::blocks_test
