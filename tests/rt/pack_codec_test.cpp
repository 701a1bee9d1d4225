#include "armcmc/rt/pack_codec.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "armcmc/plant_truth_t.hpp"
#include "plants/hunt_crossley/model.hpp"
#include "test_packs.hpp"

namespace armcmc::rt::pack_codec_test {
namespace {

using test::Encode;
using test::ValidPack;

RejectCause DecodeWith(const std::function<void(data_pack_t*)>& change) {
  data_pack_t pack = ValidPack(7);
  change(&pack);
  PackCodec codec({HuntCrossley::kInfo.plant, 2});
  return codec.Decode(Encode(pack));
}

TEST(PackCodec, CopiesEveryFieldOfAValidPack) {
  PackCodec codec({HuntCrossley::kInfo.plant, 2});
  ASSERT_EQ(codec.Decode(Encode(ValidPack(7, 42))), RejectCause::kNone);
  EXPECT_EQ(codec.seq(), 7);
  EXPECT_EQ(codec.run_id(), 42);
  DataPack pack;
  codec.CopyTo(&pack);
  EXPECT_EQ(pack.seq, 7);
  EXPECT_EQ(pack.run_id, 42);
  EXPECT_EQ(pack.t_last_ns, 700'000'000);
  EXPECT_DOUBLE_EQ(pack.t_last_s, 0.699);
  EXPECT_DOUBLE_EQ(pack.dt, 1e-3);
  EXPECT_EQ(pack.num_samples, 100);
  EXPECT_EQ(pack.num_inputs, 2);
  EXPECT_DOUBLE_EQ(pack.y[99], 9.9);
  EXPECT_DOUBLE_EQ(pack.u[99][0], 0.99);
  EXPECT_DOUBLE_EQ(pack.u[0][1], 0.5);
  EXPECT_EQ(pack.Validate(), Status::kOk);
}

TEST(PackCodec, RejectsAnotherTypeByItsFingerprint) {
  PackCodec codec({HuntCrossley::kInfo.plant, 2});
  EXPECT_EQ(codec.Decode(Encode(plant_truth_t{})), RejectCause::kFingerprint);
}

TEST(PackCodec, RejectsAWrongLength) {
  PackCodec codec({HuntCrossley::kInfo.plant, 2});
  auto bytes = Encode(ValidPack(1));
  bytes.push_back(0);
  EXPECT_EQ(codec.Decode(bytes), RejectCause::kLength) << "trailing byte";
  bytes.resize(bytes.size() - 2);
  EXPECT_EQ(codec.Decode(bytes), RejectCause::kLength) << "one byte short";
  bytes.resize(5);
  EXPECT_EQ(codec.Decode(bytes), RejectCause::kLength) << "no room for a fingerprint";
  EXPECT_EQ(codec.Decode({}), RejectCause::kLength);
}

TEST(PackCodec, RejectsWhatTheModelDoesNotExpect) {
  EXPECT_EQ(DecodeWith([](data_pack_t* p) { p->plant_kind = data_pack_t::PLANT_SOFT_ACTUATOR; }),
            RejectCause::kOtherPlant);
  EXPECT_EQ(DecodeWith([](data_pack_t* p) { p->n_inputs = 4; }), RejectCause::kInputCount);
  EXPECT_EQ(DecodeWith([](data_pack_t* p) { p->n_inputs = -1; }), RejectCause::kInputCount);
}

TEST(PackCodec, RejectsCountsOutOfRange) {
  EXPECT_EQ(DecodeWith([](data_pack_t* p) { p->n_samples = data_pack_t::MAX_SAMPLES; }), RejectCause::kNone);
  for (const int n : {0, -1, data_pack_t::MAX_SAMPLES + 1, std::numeric_limits<int>::max()}) {
    EXPECT_EQ(DecodeWith([n](data_pack_t* p) { p->n_samples = n; }), RejectCause::kSampleCount) << n;
  }
  for (const double dt : {0.0, -1e-3, 11.0, std::nan(""), HUGE_VAL}) {
    EXPECT_EQ(DecodeWith([dt](data_pack_t* p) { p->dt = dt; }), RejectCause::kSampleInterval) << dt;
  }
}

TEST(PackCodec, RejectsCountsThatTheOverlapDoesNotDivide) {
  PackCodec codec({.plant = HuntCrossley::kInfo.plant, .num_inputs = 2, .overlap = 25});
  data_pack_t pack = ValidPack(7);
  for (const auto& [samples, cause] :
       {std::pair(100, RejectCause::kNone), std::pair(75, RejectCause::kNone), std::pair(99, RejectCause::kOverlap),
        std::pair(24, RejectCause::kOverlap), std::pair(0, RejectCause::kSampleCount)}) {
    pack.n_samples = samples;
    EXPECT_EQ(codec.Decode(Encode(pack)), cause) << samples;
  }
}

TEST(PackCodec, RejectsNonFiniteAndImpossibleValues) {
  for (const double bad : {std::nan(""), HUGE_VAL, -HUGE_VAL}) {
    EXPECT_EQ(DecodeWith([bad](data_pack_t* p) { p->y[99] = bad; }), RejectCause::kNotFinite);
    EXPECT_EQ(DecodeWith([bad](data_pack_t* p) { p->u[0][1] = bad; }), RejectCause::kNotFinite);
    EXPECT_EQ(DecodeWith([bad](data_pack_t* p) { p->t_last_s = bad; }), RejectCause::kNotFinite);
  }
  EXPECT_EQ(DecodeWith([](data_pack_t* p) { p->y[0] = 1e10; }), RejectCause::kOutOfRange);
  EXPECT_EQ(DecodeWith([](data_pack_t* p) { p->seq = 0; }), RejectCause::kOutOfRange);
  EXPECT_EQ(DecodeWith([](data_pack_t* p) { p->seq = std::numeric_limits<std::int64_t>::max(); }),
            RejectCause::kOutOfRange);
  EXPECT_EQ(DecodeWith([](data_pack_t* p) { p->t_last_s = -1.0; }), RejectCause::kOutOfRange);
}

TEST(PackCodec, IgnoresValuesThatAreNotUsed) {
  EXPECT_EQ(DecodeWith([](data_pack_t* p) {
              p->y[100] = std::nan("");
              p->u[0][2] = std::nan("");
            }),
            RejectCause::kNone);
}

// Packs of plants that files describe.

constexpr PackFormat kAxis{PlantNumber::kDescribed, 3, "axis", static_cast<std::uint64_t>(-7)};

RejectCause DecodeDescribed(const std::function<void(data_pack_v2_t*)>& change) {
  data_pack_v2_t pack = test::ValidDescribedPack(7);
  change(&pack);
  PackCodec codec(kAxis);
  return codec.Decode(Encode(pack));
}

TEST(PackCodec, CopiesEveryFieldOfADescribedPack) {
  PackCodec codec(kAxis);
  ASSERT_EQ(codec.Decode(Encode(test::ValidDescribedPack(7, 42))), RejectCause::kNone);
  EXPECT_EQ(codec.seq(), 7);
  EXPECT_EQ(codec.run_id(), 42);
  EXPECT_EQ(codec.t_last_ns(), 700'000'000);
  EXPECT_DOUBLE_EQ(codec.t_last_s(), 0.699);
  DataPack pack;
  codec.CopyTo(&pack);
  EXPECT_EQ(pack.plant, PlantNumber::kDescribed);
  EXPECT_EQ(pack.fingerprint, kAxis.fingerprint);
  EXPECT_EQ(pack.seq, 7);
  EXPECT_EQ(pack.run_id, 42);
  EXPECT_EQ(pack.num_samples, 100);
  EXPECT_EQ(pack.num_inputs, 3);
  EXPECT_DOUBLE_EQ(pack.y[99], 9.9);
  EXPECT_DOUBLE_EQ(pack.u[99][2], 2.99);
  EXPECT_EQ(pack.Validate(), Status::kOk);
}

TEST(PackCodec, APackOfAnotherDescribedPlantIsRejectedByItsNameOrItsSignals) {
  EXPECT_EQ(DecodeDescribed([](data_pack_v2_t* p) { p->plant[4] = 's'; }), RejectCause::kOtherPlant) << "axiss";
  EXPECT_EQ(DecodeDescribed([](data_pack_v2_t* p) { p->plant[3] = 0; }), RejectCause::kOtherPlant) << "axi";
  EXPECT_EQ(DecodeDescribed([](data_pack_v2_t* p) { p->fingerprint = 7; }), RejectCause::kOtherPlant);
  EXPECT_EQ(DecodeDescribed([](data_pack_v2_t* p) { p->n_inputs = 2; }), RejectCause::kInputCount);
  EXPECT_EQ(DecodeDescribed([](data_pack_v2_t* p) { p->u[5][2] = std::nan(""); }), RejectCause::kNotFinite);
}

TEST(PackCodec, PacksOfBuiltInAndDescribedPlantsAreNotTakenForEachOther) {
  PackCodec described(kAxis), contact({HuntCrossley::kInfo.plant, 2});
  EXPECT_EQ(described.Decode(Encode(ValidPack(1))), RejectCause::kFingerprint);
  EXPECT_EQ(contact.Decode(Encode(test::ValidDescribedPack(1))), RejectCause::kFingerprint);
  EXPECT_FALSE(described.decoded());
}

}  // namespace
}  // namespace armcmc::rt::pack_codec_test
