#include "armcmc/replay/prediction_csv.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <sstream>

namespace armcmc::replay::prediction_csv_test {
namespace {

TEST(PredictionCsv, WritesOneRowASampleAndNothingForWhatWasNotKnown) {
  std::ostringstream out;
  PredictionCsv csv(&out);
  RecordedPack recorded;
  recorded.pack.num_samples = 2;
  recorded.t = {0.25, 0.5};
  recorded.pack.y = {1.5, 2.5};
  Estimate estimate;
  estimate.seq = 7;
  estimate.y_shown = {std::numeric_limits<double>::quiet_NaN(), 2.0};
  estimate.y_shown_free_run = {0.125, 0.375};
  csv.Write(recorded, estimate);
  EXPECT_EQ(out.str(), "t,pack,y,y_shown,y_shown_free_run\n0.25,7,1.5,,0.125\n0.5,7,2.5,2,0.375\n");
}

}  // namespace
}  // namespace armcmc::replay::prediction_csv_test
