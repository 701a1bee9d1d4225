#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include "armcmc/models/registry.hpp"
#include "armcmc/rng.hpp"
#include "core/kernel_sets.hpp"
#include "plants/soft_actuator/model.hpp"

namespace armcmc::kernel_bits_test {
namespace {

constexpr int kCount = 1024;

/// FNV-1a over the bits of doubles; all that are not a number count as the same one.
class Checksum {
 public:
  void Add(double value) {
    const std::uint64_t bits = value == value ? std::bit_cast<std::uint64_t>(value) : 0x7ff8000000000000ULL;
    for (int shift = 0; shift < 64; shift += 8) sum_ = (sum_ ^ ((bits >> shift) & 0xff)) * 0x100000001b3ULL;
  }
  template <class Values>
  void AddAll(const Values& values) {
    for (const double value : values) Add(value);
  }
  [[nodiscard]] std::uint64_t sum() const { return sum_; }

 private:
  std::uint64_t sum_ = 0xcbf29ce484222325ULL;
};

/// Uniform between bounds, from integers alone: a function of the mathematical library may round differently elsewhere.
std::vector<double> Values(std::uint64_t purpose, double lower, double upper) {
  RandomStream stream(7, 1, purpose);
  std::vector<double> values(kCount);
  for (double& value : values) value = lower + (upper - lower) * stream.Uniform();
  return values;
}

std::uint64_t OfElementaryFunctions(const simd::Kernels& kernels) {
  using expression::Op;
  Checksum checksum;
  std::vector<double> out(kCount);
  const std::vector<double> wide = Values(1, -50.0, 50.0), positive = Values(2, 1e-6, 50.0), b = Values(3, -2.0, 3.0);
  for (const Op op : {Op::kExp, Op::kSin, Op::kCos, Op::kTan, Op::kAtan, Op::kTanh, Op::kLog, Op::kPower}) {
    const std::vector<double>& a = op == Op::kLog || op == Op::kPower ? positive : wide;
    EXPECT_TRUE(kernels.elementary(op, kCount, a.data(), b.data(), out.data()));
    checksum.AddAll(out);
  }
  return checksum.sum();
}

std::uint64_t OfPredictionsAndScores(const simd::Kernels& kernels) {
  Checksum checksum;
  const auto pack = std::make_unique<DataPack>();
  const auto data = std::make_unique<ModeData>();
  const auto theta = std::make_unique<ThetaTile>();
  const auto tile = std::make_unique<PredictionTile>();
  const std::vector<double> a = Values(4, 102e3, 200e3), b = Values(5, -1e6, 1e6), c = Values(6, -1.0, 1.0);
  pack->num_samples = 100;
  for (std::size_t n = 0; n < 100; ++n) {
    pack->u[n] = {0.05, 0.0, a[n], b[n]};
    pack->y[n] = 1e3 * c[n];
  }
  SoftActuator::Prepare(*pack, ActuatorConstants{}, 0, data.get());
  alignas(64) std::array<double, kTileLanes> log_scale{}, out{};
  for (std::size_t lane = 0; lane < kTileLanes; ++lane) {
    theta->value[0][lane] = 5e-3 * c[lane];
    theta->value[1][lane] = 5e-8 * c[100 + lane];
    log_scale[lane] = 6.0 + c[200 + lane];
  }
  const int model = FindModel("soft_actuator");
  kernels.predict(model, *data, *theta, tile.get());
  for (std::size_t n = 0; n < static_cast<std::size_t>(data->num_samples); ++n) checksum.AddAll(tile->value[n]);
  for (const bool weighted : {true, false}) {
    data->weighted = weighted;
    for (std::size_t n = 0; n < 100; ++n) data->weight[n] = weighted ? 0.75 + 0.25 * c[300 + n] : 1.0;
    for (const NoiseKind kind :
         {NoiseKind::kGaussian, NoiseKind::kStudentT, NoiseKind::kLaplace, NoiseKind::kMixture}) {
      const NoiseModel noise(NoiseSettings{.kind = kind, .std = 500.0});
      kernels.log_likelihood(noise, *data, *tile, log_scale.data(), out.data());
      checksum.AddAll(out);
      kernels.score(model, noise, *data, *theta, log_scale.data(), tile.get(), out.data());
      checksum.AddAll(out);
      kernels.predict(model, *data, *theta, tile.get());  // score() leaves nothing of use in it
    }
  }
  return checksum.sum();
}

std::uint64_t OfWeightsAndMoments(const simd::Kernels& kernels) {
  Checksum checksum;
  std::vector<double> weight(kCount), out(kCount);
  kernels.uniforms(3, 0, 5, kCount, out.data());
  checksum.AddAll(out);
  const std::vector<double> log_likelihood = Values(7, -30.0, 0.0), u0 = Values(8, -2.0, 2.0),
                            u1 = Values(9, -3.0, 1.0);
  kernels.relative_likelihood(log_likelihood.data(), -1.0, kCount, weight.data());
  checksum.AddAll(weight);
  const std::array<const double*, 2> u = {u0.data(), u1.data()};
  const std::array<double, 2> mean = {0.1, -0.3};
  std::array<double, 4> first{};
  std::array<double, 3> second{};
  kernels.first_moments(2, u.data(), weight.data(), kCount, first.data());
  kernels.second_moments(2, u.data(), weight.data(), mean.data(), kCount, second.data());
  checksum.AddAll(first);
  checksum.AddAll(second);
  kernels.ratio(u0.data(), u1.data(), kCount, out.data());
  checksum.AddAll(out);
  checksum.Add(kernels.reweigh(test::kControl, u.data(), log_likelihood.data(), kCount, weight.data()));
  return checksum.sum();
}

std::uint64_t OfTilts(const simd::Kernels& kernels) {
  Checksum checksum;
  std::vector<double> weight(kCount, 1.0);
  const std::vector<double> log_likelihood = Values(10, -3.0, 3.0), u0 = Values(11, -2.0, 2.0),
                            u1 = Values(12, -1.0, 1.0);
  const std::array<const double*, 2> u = {u0.data(), u1.data()};
  kernels.tilt(test::kControl, u.data(), log_likelihood.data(), kCount, weight.data());
  checksum.AddAll(weight);
  return checksum.sum();
}

// The checksums were taken on x86-64; AArch64, and every other compiler, has to give the same.
TEST(KernelBits, AreThoseOfEveryArchitectureThatFusesMultiplyAndAdd) {
  for (const simd::Kernels* kernels : test::FusedKernels()) {
    EXPECT_EQ(OfElementaryFunctions(*kernels), 0x99745fb8a90712d3ULL) << kernels->name;
    EXPECT_EQ(OfPredictionsAndScores(*kernels), 0x61f7f5dd9d0e909aULL) << kernels->name;
    EXPECT_EQ(OfWeightsAndMoments(*kernels), 0x587a0f7c46adfab7ULL) << kernels->name;
    EXPECT_EQ(OfTilts(*kernels), 0x70d733b804c9f016ULL) << kernels->name;
  }
}

TEST(KernelBits, AreThoseOfEveryArchitectureWithoutFusedOperations) {
  const simd::Kernels& kernels = simd::kPortableKernels;
  EXPECT_EQ(OfElementaryFunctions(kernels), 0x9eb81cc9c7c51e01ULL);
  EXPECT_EQ(OfPredictionsAndScores(kernels), 0xd75456497b3a1426ULL);
  EXPECT_EQ(OfWeightsAndMoments(kernels), 0x165a322c78673aaaULL);
  EXPECT_EQ(OfTilts(kernels), 0x53d5a32a1c263059ULL);
}

}  // namespace
}  // namespace armcmc::kernel_bits_test
