#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <memory>

#include "armcmc/adjust_result.hpp"
#include "armcmc/interleaved_estimator.hpp"
#include "armcmc/rt/publication_latency.hpp"
#include "armcmc/rt/step_engine.hpp"
#include "armcmc/rt/warm_up.hpp"
#include "core/estimator_rig.hpp"
#include "fake_engine.hpp"

namespace armcmc::rt::overlap_test {
namespace {

/// Notes which packs the warm-up makes.
class Noting final : public test::FakeEngine {
 public:
  explicit Noting(int overlap) : overlap_(overlap) {}
  [[nodiscard]] PackFormat pack_format() const noexcept ARMCMC_NONBLOCKING override {
    PackFormat format = FakeEngine::pack_format();
    format.overlap = overlap_;
    return format;
  }
  Status Adjust(const DataPack& pack, Nanos deadline_ns, ClockRef clock,
                int slot) noexcept ARMCMC_NONBLOCKING override {
    odd_packs += pack.num_samples % overlap_ == 0 ? 0 : 1;
    ++steps_of[static_cast<std::size_t>(pack.seq % overlap_)];
    return FakeEngine::Adjust(pack, deadline_ns, clock, slot);
  }
  int odd_packs = 0;                            ///< That the overlap does not divide.
  std::array<int, kMaxPackSamples> steps_of{};  ///< By recursion.

 private:
  int overlap_;
};

TEST(Overlap, TheWarmUpReachesEveryRecursionWithPacksThatItTakes) {
  for (const int overlap : {1, 2, 3, 10, 100, 256}) {
    Noting engine(overlap);
    WarmUp(&engine);
    EXPECT_EQ(engine.odd_packs, 0) << overlap;
    for (std::size_t recursion = 0; recursion < static_cast<std::size_t>(overlap); ++recursion)
      EXPECT_GE(engine.steps_of[recursion], 2) << "both halves of what recursion " << recursion << " remembers";
  }
}

TEST(Overlap, TheEngineDealsPacksOutAsTheInterleavedEstimatorDoes) {
  EstimatorSettings settings = BuiltinSettings("hunt_crossley");
  settings.overlap = 4;
  EstimatorEngine engine(settings);
  EXPECT_EQ(engine.pack_format().overlap, 4);
  WarmUp(&engine);
  InterleavedEstimator expected(settings);
  const auto result = expected.MakeResult();
  const auto by_engine = std::make_unique<Estimate>(), alone = std::make_unique<Estimate>();
  for (std::int64_t seq = 10; seq <= 24; ++seq) {
    const DataPack pack = armcmc::test::Contact{}.Pack(seq);
    const int slot = static_cast<int>(seq % LatestValue::kSlots);
    EXPECT_EQ(engine.Adjust(pack, 0, {}, slot), expected.Adjust(pack, 0, {}, result.get()));
    engine.Execute(slot, by_engine.get());
    engine.Remember({});
    expected.Execute(*result, alone.get());
    armcmc::test::ExpectSameBits(*by_engine, *alone);
  }
}

TEST(PublicationLatency, IsTheAgeOfTheDataWhenTheirEstimateIsSent) {
  PublicationLatency latency;
  latency.Add(1'000'000, 1'300'000, 2'000'000);
  EXPECT_EQ(latency.from_arrival().max(), 700'000.0);
  EXPECT_EQ(latency.from_sample().max(), 1'000'000.0);
  // The clock of another computer says nothing.
  constexpr Nanos kSecond = 1'000'000'000;
  for (const Nanos t_last : {21 * kSecond, std::numeric_limits<Nanos>::max(), std::numeric_limits<Nanos>::min(),
                             20 * kSecond - PublicationLatency::kMostAge - 1})
    latency.Add(t_last, 20 * kSecond - 5, 20 * kSecond);
  EXPECT_EQ(latency.from_arrival().count(), 5u);
  EXPECT_EQ(latency.from_sample().count(), 1u);
}

}  // namespace
}  // namespace armcmc::rt::overlap_test
