#include "armcmc/data_pack.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "plants/hunt_crossley/model.hpp"
#include "support/packs.hpp"

namespace armcmc::data_pack_test {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

DataPack Good() { return test::BlankPack(HuntCrossley::kInfo.plant, 1); }

TEST(DataPack, AcceptsTheSmallestAndTheLargest) {
  DataPack pack = Good();
  EXPECT_EQ(pack.Validate(), Status::kOk);
  pack.num_samples = pack.num_inputs = 1;
  EXPECT_EQ(pack.Validate(), Status::kOk);
  pack.num_samples = kMaxPackSamples;
  pack.num_inputs = kMaxPackInputs;
  EXPECT_EQ(pack.Validate(), Status::kOk);
}

TEST(DataPack, RejectsCountsOutOfRange) {
  DataPack first = Good();
  first.seq = 0;
  EXPECT_EQ(first.Validate(), Status::kBadPack);
  for (const int n : {-1, 0, kMaxPackSamples + 1, std::numeric_limits<int>::max(), std::numeric_limits<int>::min()}) {
    DataPack pack = Good();
    pack.num_samples = n;
    EXPECT_EQ(pack.Validate(), Status::kBadPack) << n;
  }
  for (const int n : {-1, 0, kMaxPackInputs + 1}) {
    DataPack pack = Good();
    pack.num_inputs = n;
    EXPECT_EQ(pack.Validate(), Status::kBadPack) << n;
  }
}

TEST(DataPack, RejectsABadInterval) {
  for (const double dt : {0.0, -1e-3, kNan, kInfinity}) {
    DataPack pack = Good();
    pack.dt = dt;
    EXPECT_EQ(pack.Validate(), Status::kBadPack) << dt;
  }
}

TEST(DataPack, RejectsAValueThatIsNotFinite) {
  for (const double value : {kNan, kInfinity, -kInfinity})
    for (const std::size_t row : {std::size_t{0}, std::size_t{57}, std::size_t{99}}) {
      DataPack pack = Good();
      pack.y[row] = value;
      EXPECT_EQ(pack.Validate(), Status::kBadPack);
      pack = Good();
      pack.u[row][1] = value;
      EXPECT_EQ(pack.Validate(), Status::kBadPack);
    }
  DataPack pack = Good();
  pack.t_last_s = kNan;
  EXPECT_EQ(pack.Validate(), Status::kBadPack);
}

TEST(DataPack, DoesNotReadPastItsSamplesAndInputs) {
  DataPack pack = Good();
  pack.y[100] = kNan;
  pack.u[100][0] = kNan;
  pack.u[5][2] = kNan;
  EXPECT_EQ(pack.Validate(), Status::kOk);
}

}  // namespace
}  // namespace armcmc::data_pack_test
