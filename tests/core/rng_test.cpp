#include "armcmc/rng.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <vector>

namespace armcmc {
namespace {

TEST(RandomStream, MatchesTheReferenceGenerator) {
  // Published first output of SplitMix64 seeded with 1234567.
  EXPECT_EQ(RandomStream::At(1234567u, 0), 6457827717110365317ULL);
  EXPECT_EQ(RandomStream::At(1234567u, 1), 3203168211198807973ULL);
}

TEST(RandomStream, CounterFormEqualsSequentialForm) {
  RandomStream stream(7, 3, 1);
  const std::uint64_t origin = stream.origin();
  for (std::uint64_t i = 0; i < 1000; ++i) EXPECT_EQ(stream.Bits(), RandomStream::At(origin, i));
}

TEST(RandomStream, EqualKeysGiveEqualNumbers) {
  RandomStream a(1, 2, 3), b(1, 2, 3);
  for (int i = 0; i < 100; ++i) EXPECT_EQ(a.Bits(), b.Bits());
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

TEST(RandomStream, StreamsOfNeighbouringKeysAreUncorrelated) {
  constexpr int kCount = 100'000;
  for (int which = 0; which < 3; ++which) {
    RandomStream a(5, 5, 1);
    RandomStream b(which == 0 ? 6 : 5, which == 1 ? 6 : 5, which == 2 ? 2 : 1);
    double product = 0.0;
    for (int i = 0; i < kCount; ++i) product += (a.Uniform() - 0.5) * (b.Uniform() - 0.5);
    // Standard error of the correlation of independent numbers.
    EXPECT_LT(std::fabs(12.0 * product / kCount), 4.0 / std::sqrt(kCount));
  }
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

TEST(RandomStream, ExtremeBitsStayInsideTheOpenInterval) {
  // The definition (i + 1/2) / 2^52 at the ends of i.
  constexpr double kFirst = (0.0 + 0.5) * 0x1p-52;
  constexpr double kLast = (0x1p52 - 1.0 + 0.5) * 0x1p-52;
  EXPECT_GT(kFirst, 0.0);
  EXPECT_LT(kLast, 1.0);
}

}  // namespace
}  // namespace armcmc
