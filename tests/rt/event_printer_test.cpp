#include "event_printer.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

#include "armcmc/rt/miss_cause.hpp"
#include "armcmc/rt/pack_codec.hpp"
#include "armcmc/rt/watchdog.hpp"

namespace armcmc::app::event_printer_test {
namespace {

TEST(EventPrinter, PrintsOneLineWithTheTimeSinceTheStart) {
  std::ostringstream out;
  EventPrinter printer(out, 1'000'000'000, false);
  printer.Print({2'500'000'000, rt::EventKind::kPlantSilent, 0, 17, 0});
  EXPECT_EQ(out.str(), "[    1.500 s] plant has been silent since pack 17\n");
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

TEST(EventPrinter, KeepsLostAndDroppedPacksForVerbose) {
  for (const bool verbose : {false, true}) {
    std::ostringstream out;
    EventPrinter printer(out, 0, verbose);
    printer.Print({0, rt::EventKind::kPacksLost, 0, 1, 9});
    printer.Print({0, rt::EventKind::kPackDropped, 0, 9, 0});
    EXPECT_EQ(out.str().empty(), !verbose);
  }
}

TEST(EventText, SaysWhichPackByHowMuchAndWhy) {
  const auto machine = static_cast<std::uint8_t>(rt::MissCause::kMachine);
  EXPECT_EQ(EventText({0, rt::EventKind::kDeadlineMissed, machine, 7, 1'500'000}),
            "deadline of pack 7 missed by 1.500 ms, cause: machine");
  EXPECT_EQ(EventText({0, rt::EventKind::kPacksLost, 0, 3, 9}), "3 packs lost before pack 9");
  EXPECT_EQ(EventText({0, rt::EventKind::kOverlapDiffers, 0, 10, 100}),
            "packs come every 10 samples, but [timing] overlap implies every 100: samples are counted more than once");
  EXPECT_EQ(
      EventText({0, rt::EventKind::kOverlapDiffers, 0, 100, 1}),
      "packs come every 100 samples, but [timing] overlap implies every 1: packs of a recursion leave samples out");
  EXPECT_EQ(EventText({0, rt::EventKind::kPlantBack, 0, 9, 1}), "plant is back with pack 9 after 1 silent period");
  EXPECT_EQ(EventText({0, rt::EventKind::kStageHung, static_cast<std::uint8_t>(rt::Watched::kExecute), 250'000'000, 0}),
            "stage execute hangs: overdue by 250.000 ms");
}

TEST(EventText, SaysWhereAGapIsSeen) {
  const rt::Event gap{0, rt::EventKind::kGapSuspected, 3, 21, 0};
  EXPECT_EQ(EventText(gap), "GAP SUSPECTED: the model is missing something since pack 21");
  EXPECT_EQ(EventText(gap, [](int check) { return check == 3 ? std::string("direction_of_v") : std::string(); }),
            "GAP SUSPECTED: the model is missing something since pack 21, seen in direction_of_v");
}

}  // namespace
}  // namespace armcmc::app::event_printer_test
