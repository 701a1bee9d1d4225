// Packs of described plants: how samples are cut into them, and when they are sent.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <iterator>
#include <limits>
#include <string>
#include <tuple>
#include <vector>

#include "armcmc/plant_sim/described_pack_builder.hpp"
#include "armcmc/plant_sim/monotonic_clock.hpp"
#include "armcmc/plant_sim/playback.hpp"

namespace armcmc::plant_sim::described_pack_test {
namespace {

using testing::ElementsAre;

/// Three signals of which the middle one is the output: row n holds n, 100 + n, 200 + n.
SampleRuns Rows(std::size_t rows, std::vector<std::size_t> first_rows) {
  SampleRuns runs;
  runs.plant = "axis";
  runs.fingerprint = 0xfedcba9876543210ULL;
  runs.signals = {{"q", "m", {}}, {"F", "N", {}}, {"v", "m/s", {}}};
  runs.output = 1;
  runs.dt = 0.01;
  runs.runs = std::move(first_rows);
  for (std::size_t s = 0; s < runs.signals.size(); ++s)
    for (std::size_t n = 0; n < rows; ++n)
      runs.signals[s].value.push_back(100.0 * static_cast<double>(s) + static_cast<double>(n));
  return runs;
}

/// Up to the first zero.
template <typename Byte, std::size_t kSize>
std::string TextOf(const Byte (&field)[kSize]) {
  const std::string padded(std::begin(field), std::end(field));
  return padded.substr(0, padded.find('\0'));
}

class KeepingSink final : public MessageSink {
 public:
  bool Send(const char* channel, const void* data, int size, std::int64_t) noexcept override {
    channels.emplace_back(channel);
    data_pack_v2_t pack{};
    if (pack.decode(data, 0, size) == size) packs.push_back(pack);
    if (!packs.empty() && MonotonicNow() < packs.back().t_last_ns) ++early;
    return !broken;
  }
  std::vector<std::string> channels;
  std::vector<data_pack_v2_t> packs;
  int early = 0;
  bool broken = false;
};

TEST(DescribedPackBuilder, SaysWhichPlantItIsAndPutsTheOutputApart) {
  const SampleRuns runs = Rows(4, {0});
  DescribedPackBuilder builder(runs, 4, 7);
  ASSERT_TRUE(builder.Next());
  const data_pack_v2_t& pack = builder.pack();
  EXPECT_EQ(TextOf(pack.plant), "axis");
  EXPECT_EQ(static_cast<std::uint64_t>(pack.fingerprint), 0xfedcba9876543210ULL);
  EXPECT_EQ(pack.n_samples, 4);
  EXPECT_EQ(pack.n_inputs, 2);
  EXPECT_EQ(TextOf(pack.y_name) + TextOf(pack.u_name[0]) + TextOf(pack.u_name[1]), "Fqv");
  EXPECT_EQ(TextOf(pack.y_unit) + ' ' + TextOf(pack.u_unit[0]) + ' ' + TextOf(pack.u_unit[1]), "N m m/s");
  EXPECT_EQ(pack.y[3], 103.0);
  EXPECT_EQ(pack.u[3][0], 3.0);
  EXPECT_EQ(pack.u[3][1], 203.0);
  EXPECT_EQ(pack.y[4], 0.0) << "past n_samples";
  EXPECT_EQ(pack.u[3][2], 0.0) << "past n_inputs";
}

TEST(DescribedPackBuilder, EveryRunIsARestartAndARemainderIsLeftOut) {
  const SampleRuns runs = Rows(18, {0, 7, 9});  // 7, 2 and 9 samples: 2, 0 and 3 packs of 3
  DescribedPackBuilder builder(runs, 3, 40);
  EXPECT_EQ(builder.num_packs(), 5);
  EXPECT_EQ(builder.left_out(), 3u);
  EXPECT_DOUBLE_EQ(builder.pack_period_s(), 0.03);
  std::vector<std::tuple<std::int64_t, std::int64_t, double>> seen;
  std::vector<double> last_s;
  while (builder.Next()) {
    seen.emplace_back(builder.pack().run_id, builder.pack().seq, builder.pack().y[0]);
    last_s.push_back(builder.pack().t_last_s);
  }
  using Seen = std::tuple<std::int64_t, std::int64_t, double>;
  EXPECT_THAT(seen, ElementsAre(Seen(40, 1, 100.0), Seen(40, 2, 103.0), Seen(42, 1, 109.0), Seen(42, 2, 112.0),
                                Seen(42, 3, 115.0)));
  EXPECT_THAT(last_s, ElementsAre(0.02, 0.05, 0.02, 0.05, 0.08));
  EXPECT_FALSE(builder.Next());
}

TEST(DescribedPackBuilder, PacksMayOverlapInsideARun) {
  const SampleRuns runs = Rows(18, {0, 8, 10});  // 8, 2 and 8 samples
  DescribedPackBuilder builder(runs, 4, 40, 2);
  EXPECT_EQ(builder.num_packs(), 6);
  EXPECT_EQ(builder.left_out(), 2u);
  EXPECT_DOUBLE_EQ(builder.pack_period_s(), 0.02);
  using Seen = std::tuple<std::int64_t, std::int64_t, double, double>;
  std::vector<Seen> seen;
  std::vector<double> last_s;
  while (builder.Next()) {
    const data_pack_v2_t& pack = builder.pack();
    seen.emplace_back(pack.run_id, pack.seq, pack.y[0], pack.y[3]);
    last_s.push_back(pack.t_last_s);
  }
  EXPECT_THAT(seen, ElementsAre(Seen(40, 1, 100.0, 103.0), Seen(40, 2, 102.0, 105.0), Seen(40, 3, 104.0, 107.0),
                                Seen(42, 1, 110.0, 113.0), Seen(42, 2, 112.0, 115.0), Seen(42, 3, 114.0, 117.0)));
  EXPECT_THAT(last_s, ElementsAre(0.03, 0.05, 0.07, 0.03, 0.05, 0.07));
}

TEST(DescribedPackBuilder, TheStrideDividesAPack) {
  const SampleRuns runs = Rows(18, {0});
  for (const int stride : {3, 5, -1, 8}) EXPECT_THROW(DescribedPackBuilder(runs, 4, 1, stride), std::invalid_argument);
  EXPECT_NO_THROW(DescribedPackBuilder(runs, 4, 1, 1));
}

TEST(DescribedPackBuilder, PassesOnWhatIsNotFinite) {
  SampleRuns runs = Rows(3, {0});
  runs.signals[1].value[1] = std::nan("");
  runs.signals[2].value[2] = std::numeric_limits<double>::infinity();
  DescribedPackBuilder builder(runs, 3, 1);
  ASSERT_TRUE(builder.Next());
  EXPECT_TRUE(std::isnan(builder.pack().y[1]));
  EXPECT_TRUE(std::isinf(builder.pack().u[2][1]));
}

TEST(DescribedPackBuilder, CutsATextThatIsTooLong) {
  SampleRuns runs = Rows(3, {0});
  runs.signals[1].unit = "sqrt(Pa) s/Pa^2 m";  // 17 characters for 16 bytes
  DescribedPackBuilder builder(runs, 3, 1);
  EXPECT_EQ(std::string(std::begin(builder.pack().y_unit), std::end(builder.pack().y_unit)), "sqrt(Pa) s/Pa^2 ");
  EXPECT_EQ(TextOf(builder.pack().u_unit[0]), "m");
}

TEST(DescribedPackBuilder, RefusesWhatNoPackTakes) {
  const SampleRuns good = Rows(3, {0});
  EXPECT_THROW(DescribedPackBuilder(good, 0, 1), std::invalid_argument);
  EXPECT_THROW(DescribedPackBuilder(good, 257, 1), std::invalid_argument);
  SampleRuns many = good;
  while (many.signals.size() < 10) many.signals.push_back(many.signals.front());
  EXPECT_THROW(DescribedPackBuilder(many, 3, 1), std::invalid_argument);
  SampleRuns alone = good;
  alone.signals.resize(1);
  alone.output = 0;
  EXPECT_THROW(DescribedPackBuilder(alone, 3, 1), std::invalid_argument);
  SampleRuns uneven = good;
  uneven.signals[2].value.pop_back();
  EXPECT_THROW(DescribedPackBuilder(uneven, 3, 1), std::invalid_argument);
  SampleRuns frozen = good;
  frozen.dt = 0.0;
  EXPECT_THROW(DescribedPackBuilder(frozen, 3, 1), std::invalid_argument);
}

TEST(Playback, SendsEveryPackOnAnExactGridThatGoesOnOverTheRuns) {
  const SampleRuns runs = Rows(600, {0, 305});
  DescribedPackBuilder builder(runs, 10, 1);  // 30 and 29 packs, 100 ms each
  KeepingSink bus, log;
  DescribedPackSender sender("X_", &bus, &log);
  const std::int64_t start_ns = MonotonicNow() + 1'000'000;
  const PlaybackResult result = Play(&builder, &sender, start_ns, 300.0, [](std::int64_t) { return false; });
  EXPECT_EQ(result.packs_sent, 59);
  ASSERT_EQ(bus.packs.size(), 59u);
  EXPECT_EQ(log.packs.size(), 59u);
  EXPECT_THAT(bus.channels, testing::Each("X_PLANT_PACK_V2"));
  // A third of a millisecond each, without the drift of one that is rounded to nanoseconds: 59 / 3 ms at the end.
  for (std::size_t k = 0; k < bus.packs.size(); ++k)
    EXPECT_EQ(bus.packs[k].t_last_ns - start_ns, std::llround(static_cast<double>(k + 1) * 1e6 / 3.0)) << k;
  EXPECT_EQ(bus.early, 0);
  EXPECT_EQ(bus.packs[29].seq, 30);
  EXPECT_EQ(bus.packs[30].seq, 1);
  EXPECT_EQ(sender.errors(), 0);
}

TEST(Playback, WaitsForItsTurnThoughItLooksOftenWhetherToStop) {
  const SampleRuns runs = Rows(25, {0});
  DescribedPackBuilder builder(runs, 25, 1);  // due after 0.25 s, longer than it ever sleeps
  KeepingSink bus;
  DescribedPackSender sender("", &bus, nullptr);
  int asked = 0;
  Play(&builder, &sender, MonotonicNow(), 1.0, [&asked](std::int64_t) { return ++asked < 0; });
  EXPECT_EQ(bus.packs.size(), 1u);
  EXPECT_EQ(bus.early, 0);
  EXPECT_GE(asked, 3);
}

TEST(Playback, EndsWhenItIsToldTo) {
  const SampleRuns runs = Rows(100, {0});
  DescribedPackBuilder builder(runs, 10, 1);
  KeepingSink bus;
  DescribedPackSender sender("", &bus, nullptr);
  const PlaybackResult result =
      Play(&builder, &sender, MonotonicNow(), 1e6, [](std::int64_t sent) { return sent == 4; });
  EXPECT_EQ(result.packs_sent, 4);
  EXPECT_EQ(bus.packs.size(), 4u);
}

TEST(DescribedPackSender, CountsWhatTheBusDoesNotTake) {
  KeepingSink bus;
  bus.broken = true;
  DescribedPackSender sender("", &bus, nullptr);
  sender.Send(data_pack_v2_t{});
  EXPECT_EQ(sender.errors(), 1);
}

}  // namespace
}  // namespace armcmc::plant_sim::described_pack_test
