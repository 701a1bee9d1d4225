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

TEST(PredictionCsv, WritesASampleThatPacksShareOnce) {
  std::ostringstream out;
  PredictionCsv csv(&out, 2);
  RecordedPack recorded;
  recorded.pack.num_samples = 4;
  Estimate estimate;
  const auto write = [&](std::int64_t run, std::int64_t seq) {
    recorded.pack.run_id = run;
    recorded.pack.seq = estimate.seq = seq;
    for (std::size_t n = 0; n < 4; ++n) recorded.t[n] = 2.0 * static_cast<double>(seq - 1) + static_cast<double>(n);
    csv.Write(recorded, estimate);
  };
  for (const std::int64_t seq : {1, 2, 3, 6}) write(1, seq);
  write(2, 1);
  std::string times, line;
  std::istringstream lines(out.str());
  std::getline(lines, line);
  while (std::getline(lines, line)) times += line.substr(0, line.find(',', line.find(',') + 1)) + ' ';
  EXPECT_EQ(times, "0,1 1,1 2,1 3,1 4,2 5,2 6,3 7,3 10,6 11,6 12,6 13,6 0,1 1,1 2,1 3,1 ");
}

}  // namespace
}  // namespace armcmc::replay::prediction_csv_test
