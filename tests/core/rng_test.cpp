#include "armcmc/rng.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <vector>

namespace armcmc::rng_test {
namespace {

TEST(RandomStream, MatchesTheReferenceGenerator) {
  // Published first output of SplitMix64 seeded with 1234567.
  EXPECT_EQ(RandomStream::At(1234567u, 0), 6457827717110365317ULL);
  EXPECT_EQ(RandomStream::At(1234567u, 1), 3203168211198807973ULL);
}

TEST(RandomStream, SeedPackAndPurposeSelectDifferentNumbers) {
  std::set<std::uint64_t> seen;
  for (std::uint64_t seed = 0; seed < 10; ++seed)
    for (std::uint64_t pack = 0; pack < 10; ++pack)
      for (std::uint64_t purpose = 0; purpose < 6; ++purpose) {
        RandomStream stream(seed, pack, purpose);
        for (int i = 0; i < 100; ++i) seen.insert(stream.Bits());
      }
  EXPECT_EQ(seen.size(), 10u * 10u * 6u * 100u);
}

TEST(RandomStream, UniformsFillTheOpenIntervalEvenly) {
  constexpr int kCount = 1'000'000;
  constexpr int kBins = 100;
  RandomStream stream(0x5eed, 1, 0);
  std::vector<int> bins(kBins);
  double sum = 0.0, square = 0.0, serial = 0.0, before = 0.0, smallest = 1.0, largest = 0.0;
  for (int i = 0; i < kCount; ++i) {
    const double u = stream.Uniform();
    smallest = std::fmin(smallest, u);
    largest = std::fmax(largest, u);
    const double c = u - 0.5;
    sum += c;
    square += c * c;
    serial += c * before;
    before = c;
    ++bins[static_cast<std::size_t>(u * kBins)];
  }
  EXPECT_GT(smallest, 0.0);
  EXPECT_LT(largest, 1.0);
  EXPECT_LT(smallest, 1e-4);
  EXPECT_GT(largest, 1.0 - 1e-4);
  // Four standard errors: sd of u is sqrt(1/12), of (u - 1/2)^2 is sqrt(1/180), of a product of two is 1/12.
  EXPECT_LT(std::fabs(sum / kCount), 4.0 * std::sqrt(1.0 / 12.0 / kCount));
  EXPECT_LT(std::fabs(square / kCount - 1.0 / 12.0), 4.0 * std::sqrt(1.0 / 180.0 / kCount));
  EXPECT_LT(std::fabs(serial / kCount), 4.0 / 12.0 / std::sqrt(kCount));
  double chi_square = 0.0;
  for (const int n : bins) chi_square += (n - kCount / kBins) * static_cast<double>(n - kCount / kBins);
  chi_square /= kCount / kBins;
  EXPECT_NEAR(chi_square, kBins - 1, 4.0 * std::sqrt(2.0 * (kBins - 1)));
}

}  // namespace
}  // namespace armcmc::rng_test
