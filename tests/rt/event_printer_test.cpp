#include "event_printer.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

#include "armcmc/rt/pack_codec.hpp"

namespace armcmc::app {
namespace {

TEST(EventPrinter, PrintsOneLineWithTheTimeSinceTheStart) {
  std::ostringstream out;
  EventPrinter printer(out, 1'000'000'000, false);
  printer.Print({2'500'000'000, rt::EventKind::kPlantSilent, 0, 17, 0});
  EXPECT_EQ(out.str(), "[    1.500 s] plant is silent since pack 17\n");
}

TEST(EventPrinter, HoldsAStormBackAndSaysHowMuch) {
  std::ostringstream out;
  EventPrinter printer(out, 0, false);
  const auto cause = static_cast<std::int64_t>(rt::RejectCause::kNotFinite);
  for (int i = 0; i < 100; ++i) printer.Print({0, rt::EventKind::kPackRejected, 0, cause, 0});
  printer.PrintHeldBack(0);
  const std::string text = out.str();
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), EventPrinter::kMaxPerSecond + 1);
  EXPECT_NE(text.find("95 more rejected packs"), std::string::npos);
  EXPECT_NE(text.find("NaN or infinite value"), std::string::npos);
}

TEST(EventText, KnowsEveryKind) {
  for (int kind = 0; kind < rt::kNumEventKinds; ++kind) {
    EXPECT_NE(EventText({0, static_cast<rt::EventKind>(kind), 1, 1, 1}), "unknown event") << kind;
  }
}

}  // namespace
}  // namespace armcmc::app
