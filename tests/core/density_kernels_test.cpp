#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <random>
#include <vector>

#include "armcmc/density_fit.hpp"
#include "armcmc/proposal.hpp"
#include "armcmc/rng.hpp"
#include "core/kernel_sets.hpp"

namespace armcmc::density_kernels_test {
namespace {

/// A correlated, bent and tapered block with marginals of different shape: the fit to draws along a curved ridge.
struct Bent {
  MarginalTable tables[3];
  DensityBlock block;

  Bent() {
    constexpr std::size_t kCount = 4096;
    std::mt19937_64 g(6);
    std::normal_distribution<double> normal;
    std::vector<double> rows[3], scratch[kMaxParams + 2], weight(kCount, 1.0);
    for (std::size_t k = 0; k < kCount; ++k) {
      const double a = normal(g), b = normal(g), c = normal(g);
      rows[0].push_back(0.3 + 0.7 * a);
      rows[1].push_back(-1.2 + 0.4 * (a * a - 1.0) + 0.3 * b);
      rows[2].push_back(0.8 + 0.3 * a + 0.2 * a * b + 0.2 * std::exp(0.4 * c));
    }
    WeightedDraws draws{.dim = 3, .size = kCount, .u = {}, .weight = weight.data()};
    double* room[kMaxParams + 2];
    for (std::size_t r = 0; r < kMaxParams + 2; ++r) {
      scratch[r].resize(kCount);
      room[r] = scratch[r].data();
    }
    for (std::size_t d = 0; d < 3; ++d) draws.u[d] = rows[d].data();
    FitBlock(simd::Best(), draws, {}, room, tables, &block);
    EXPECT_TRUE(block.bent);
    block.tapered = true;
    block.thickness[1] = {0.2, -0.02};
    block.thickness[2] = {-0.1, 0.03};
  }
  Bent(const Bent&) = delete;  // the block points into tables
  Bent& operator=(const Bent&) = delete;
};

struct Points {
  std::vector<double> rows[3];
  const double* u[3];

  explicit Points(std::size_t count, unsigned seed = 1) {
    std::mt19937_64 g(seed);
    std::normal_distribution<double> normal(0.0, 1.5);
    for (std::size_t d = 0; d < 3; ++d) {
      for (std::size_t k = 0; k < count; ++k) rows[d].push_back(normal(g));
      u[d] = rows[d].data();
    }
  }
};

TEST(AddDensityKernel, EqualsTheScalarDensity) {
  const Bent bent;
  const Points points(512);
  for (const simd::Kernels* kernels : test::RunnableKernels())
    for (int first = 0; first < 512; first += kTileLanes) {
      alignas(64) double out[kTileLanes];
      for (double& v : out) v = 0.25;
      kernels->add_density(bent.block, points.u, first, 3.0, out);
      for (int l = 0; l < kTileLanes; ++l) {
        const double u[3] = {points.u[0][first + l], points.u[1][first + l], points.u[2][first + l]};
        EXPECT_NEAR(out[l], 0.25 + 3.0 * bent.block.Density(u), 1e-12) << kernels->name;
      }
    }
}

TEST(AddDensityKernel, AgreesAtNodesAndEdgesOfTheTables) {
  const MarginalTable table = MarginalTable::Uniform(1.0);
  DensityBlock block;
  SetAxisAligned(1, {&table}, &block);
  alignas(64) double x[kTileLanes];
  for (int l = 0; l < kTileLanes; ++l) x[l] = -1.0 + 0.125 * (l / 2) + (l % 2 == 0 ? 0.0 : 1e-12);
  x[30] = std::nan("");
  x[31] = 1e300;
  const double* u[] = {x};
  for (const simd::Kernels* kernels : test::RunnableKernels()) {
    alignas(64) double out[kTileLanes] = {};
    kernels->add_density(block, u, 0, 1.0, out);
    for (int l = 0; l < 30; ++l) EXPECT_NEAR(out[l], block.Density(&x[l]), 1e-12) << kernels->name << " " << x[l];
    EXPECT_EQ(out[30], 0.0);
    EXPECT_EQ(out[31], 0.0);
  }
}

/// Uniform numbers in rows, as draws start from.
std::vector<std::vector<double>> UniformRows(std::size_t dim, std::size_t count) {
  RandomStream stream(3, 0, 0);
  std::vector<std::vector<double>> rows(dim);
  for (std::size_t k = 0; k < count; ++k)
    for (auto& row : rows) row.push_back(stream.Uniform());
  return rows;
}

TEST(DrawBlockKernel, EqualsTheScalarDraw) {
  const Bent bent;
  const auto uniforms = UniformRows(3, 512);
  for (const simd::Kernels* kernels : test::RunnableKernels()) {
    auto x = uniforms;
    double* const rows[] = {x[0].data(), x[1].data(), x[2].data()};
    kernels->draw_block(bent.block, 512, rows);
    for (std::size_t k = 0; k < 512; ++k) {
      const double one[] = {uniforms[0][k], uniforms[1][k], uniforms[2][k]};
      double u[3];
      bent.block.Draw(one, u);
      for (std::size_t d = 0; d < 3; ++d) EXPECT_NEAR(x[d][k], u[d], 1e-11) << kernels->name << " " << k;
    }
  }
}

TEST(Proposal, DrawsEveryComponentByItsShareWhateverTheBatches) {
  const MarginalTable table = MarginalTable::Normal();
  const double shares[] = {2.0, 1.0, 5.0};
  DensityBlock blocks[3];
  Proposal proposal;
  for (int c = 0; c < 3; ++c) {
    ParamVector mean(2);
    mean << 10.0 * c, -10.0 * c;
    SetElliptic(mean, ParamMatrix::Identity(2, 2) * 0.01, 1.0, &table, &blocks[c]);
    proposal.Add(&blocks[c], shares[c]);
  }
  proposal.Normalise();

  constexpr int kCount = 8000;
  struct Drawn {
    std::vector<double> u[2];
    std::vector<std::int8_t> component;
  };
  const auto draw = [&](int batch) {
    constexpr std::size_t kRoom = kCount + 8;  // batches are padded to whole vectors
    Drawn drawn{{std::vector<double>(kRoom), std::vector<double>(kRoom)}, std::vector<std::int8_t>(kRoom)};
    std::vector<double> scratch[2];
    for (auto& row : scratch) row.resize(Proposal::kMaxBatch + 8);
    double* const rows[] = {drawn.u[0].data(), drawn.u[1].data()};
    double* const scratch_rows[] = {scratch[0].data(), scratch[1].data()};
    const RandomStream stream(4, 0, 0);
    for (int first = 0; first < kCount; first += batch)
      proposal.Draw(simd::Best(), stream, first, std::min(batch, kCount - first), rows,
                    &drawn.component[static_cast<std::size_t>(first)], scratch_rows);
    for (auto& row : drawn.u) row.resize(kCount);
    drawn.component.resize(kCount);
    return drawn;
  };
  const Drawn drawn = draw(Proposal::kMaxBatch);
  for (int c = 0; c < 3; ++c) {
    const double share = shares[c] / 8.0;
    const auto count = static_cast<double>(std::count(drawn.component.begin(), drawn.component.end(), c));
    EXPECT_NEAR(count, kCount * share, 4.0 * std::sqrt(kCount * share * (1.0 - share))) << c;
  }
  for (std::size_t k = 0; k < kCount; ++k) {
    ASSERT_NEAR(drawn.u[0][k], 10.0 * drawn.component[k], 1.0) << k;
    ASSERT_NEAR(drawn.u[1][k], -10.0 * drawn.component[k], 1.0) << k;
  }
  // A candidate has numbers of its own: the same ones in batches of other sizes.
  const Drawn again = draw(100);
  EXPECT_EQ(again.component, drawn.component);
  for (std::size_t d = 0; d < 2; ++d) EXPECT_EQ(again.u[d], drawn.u[d]);
}

ParameterSpace MixedSpace() {
  EstimatorSettings settings = BuiltinSettings("hunt_crossley");
  settings.parameters[1].prior = PriorKind::kUniform;
  return {settings, settings.noise[0]};
}

TEST(InitialPriorKernel, IntegratesToOne) {
  const ParameterSpace space = MixedSpace();
  constexpr int kGrid = 64;  // midpoints; the integrand is smooth inside the bounds
  std::vector<double> rows[3];
  double cell = 1.0;
  for (std::size_t d = 0; d < 3; ++d) cell *= (space.upper[d] - space.lower[d]) / kGrid;
  for (int k = 0; k < kGrid * kGrid * kGrid; ++k) {
    const int index[] = {k % kGrid, k / kGrid % kGrid, k / kGrid / kGrid};
    for (std::size_t d = 0; d < 3; ++d)
      rows[d].push_back(space.lower[d] + (space.upper[d] - space.lower[d]) * (index[d] + 0.5) / kGrid);
  }
  const double* u[] = {rows[0].data(), rows[1].data(), rows[2].data()};
  for (const simd::Kernels* kernels : test::RunnableKernels()) {
    double sum = 0.0;
    for (int k = 0; k < kGrid * kGrid * kGrid; k += kTileLanes) {
      alignas(64) double out[kTileLanes];
      kernels->initial_prior(space, u, k, out);
      for (const double v : out) sum += v;
    }
    EXPECT_NEAR(sum * cell, 1.0, 1e-4) << kernels->name;
  }
}

TEST(InitialPriorKernel, IsZeroOutsideTheBounds) {
  const ParameterSpace space = MixedSpace();
  for (const simd::Kernels* kernels : test::RunnableKernels())
    for (std::size_t d = 0; d < 3; ++d) {
      alignas(64) double rows[3][kTileLanes] = {};
      const double* u[] = {rows[0], rows[1], rows[2]};
      rows[d][0] = std::nextafter(space.upper[d], HUGE_VAL);
      rows[d][1] = std::nextafter(space.lower[d], -HUGE_VAL);
      rows[d][2] = space.upper[d];
      rows[d][3] = space.lower[d];
      rows[d][4] = std::nan("");
      alignas(64) double out[kTileLanes];
      kernels->initial_prior(space, u, 0, out);
      EXPECT_EQ(out[0], 0.0);
      EXPECT_EQ(out[1], 0.0);
      EXPECT_GT(out[2], 0.0);
      EXPECT_GT(out[3], 0.0);
      EXPECT_EQ(out[4], 0.0);
      EXPECT_GT(out[5], 0.0);
    }
}

TEST(ToPhysicalKernel, UndoesTheStandardisation) {
  EstimatorSettings settings = BuiltinSettings("hunt_crossley");
  for (const bool estimate_std : {false, true}) {
    settings.noise[0].estimate_std = estimate_std;
    const ParameterSpace space(settings, settings.noise[0]);
    const Points points(64);
    const double* u[] = {points.u[0], points.u[1], points.u[2], points.u[0]};
    for (const simd::Kernels* kernels : test::RunnableKernels()) {
      ThetaTile theta;
      alignas(64) double log_scale[kTileLanes];
      kernels->to_physical(space, u, 32, &theta, log_scale);
      for (std::size_t l = 0; l < kTileLanes; ++l) {
        for (std::size_t d = 0; d < 3; ++d)
          EXPECT_NEAR(theta.value[d][l], settings.parameters[d].mean + settings.parameters[d].sd * u[d][32 + l], 1e-13);
        EXPECT_NEAR(log_scale[l], std::log(0.1) + (estimate_std ? u[3][32 + l] : 0.0), 1e-13);
      }
    }
  }
}

TEST(UniformsKernel, EqualsTheStream) {
  RandomStream stream(9, 8, 7);
  const std::uint64_t origin = stream.origin();
  std::vector<double> expected;
  for (int i = 0; i < 4000; ++i) expected.push_back(stream.Uniform());
  for (const simd::Kernels* kernels : test::RunnableKernels())
    for (const std::uint64_t stride : {1u, 9u}) {
      std::vector<double> out(256);
      kernels->uniforms(origin, 17, stride, 256, out.data());
      for (std::size_t k = 0; k < 256; ++k) EXPECT_EQ(out[k], expected[17 + k * stride]) << kernels->name;
    }
}

TEST(DensityKernels, FusedInstructionSetsGiveTheSameBits) {
  const auto sets = test::FusedKernels();
  if (sets.size() < 2) GTEST_SKIP() << "this CPU runs one fused instruction set only";
  const Bent bent;
  const Points points(512);
  const ParameterSpace space = MixedSpace();
  for (int first = 0; first < 512; first += kTileLanes) {
    alignas(64) double a[kTileLanes] = {}, b[kTileLanes] = {};
    sets[0]->add_density(bent.block, points.u, first, 0.7, a);
    sets[1]->add_density(bent.block, points.u, first, 0.7, b);
    EXPECT_EQ(std::memcmp(a, b, sizeof a), 0);
    sets[0]->initial_prior(space, points.u, first, a);
    sets[1]->initial_prior(space, points.u, first, b);
    EXPECT_EQ(std::memcmp(a, b, sizeof a), 0);
  }
  auto x = UniformRows(3, 512), y = x;
  double* const x_rows[] = {x[0].data(), x[1].data(), x[2].data()};
  double* const y_rows[] = {y[0].data(), y[1].data(), y[2].data()};
  sets[0]->draw_block(bent.block, 512, x_rows);
  sets[1]->draw_block(bent.block, 512, y_rows);
  EXPECT_EQ(x, y);
}

}  // namespace
}  // namespace armcmc::density_kernels_test
