#include "plants/hunt_crossley/gap_family.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "gap_watch/gap_tools.hpp"

namespace armcmc {
namespace {

enum ContactRegion : std::uint8_t {
  kEverywhere,
  kFree,
  kContactDirection,
  kFreeDirection,
  kContactSpeed,
  kFreeSpeed,
  kShallowContact,
  kDeepContact,
  kShallowRetracting,
  kEarlyContact,
  kContactAcceleration,
  kFreeAcceleration,
  kOutputRate,
  kHighOutput,
  kNumContactRegions
};

class ContactFamily final : public GapFamily {
 public:
  constexpr ContactFamily()
      : GapFamily({.first = 0,
                   .num_regions = kNumContactRegions,
                   .regions = {"everywhere", "free", "contact_direction", "free_direction", "contact_speed",
                               "free_speed", "shallow_contact", "deep_contact", "shallow_retracting", "early_contact",
                               "contact_acceleration", "free_acceleration", "output_rate", "high_output"},
                   .serial = kSerialChecks},
                  true) {}

  void Fill(const DataPack& pack, const std::array<int, kMaxPackSamples>& modes, const double* prediction,
            RegionMemory* memory, RegionTemplates* out) const noexcept ARMCMC_NONBLOCKING override;
};

void ContactFamily::Fill(const DataPack& pack, const std::array<int, kMaxPackSamples>&, const double* prediction,
                         RegionMemory* memory, RegionTemplates* out) const noexcept {
  RegionTemplates& t = *out;
  const double acceleration = MeanSlope(pack, 1);
  for (std::size_t n = 0; n < static_cast<std::size_t>(pack.num_samples); ++n) {
    const double x = pack.u[n][0];
    const double v = pack.u[n][1];
    const bool contact = x >= 0.0;
    const double c = contact ? 1.0 : 0.0;
    const double f = 1.0 - c;
    memory->largest = std::max(memory->largest, x);
    const double elapsed = TimeInMode(contact ? 0 : 1, pack.dt, memory);
    const bool shallow = contact && x < kShallow * memory->largest;
    t[kEverywhere][n] = 1.0;
    t[kFree][n] = f;
    t[kContactDirection][n] = c * Sign(v);
    t[kFreeDirection][n] = f * Sign(v);
    t[kContactSpeed][n] = c * v;
    t[kFreeSpeed][n] = f * v;
    t[kShallowContact][n] = shallow ? 1.0 : 0.0;
    t[kDeepContact][n] = contact && x > kDeep * memory->largest ? 1.0 : 0.0;
    t[kShallowRetracting][n] = shallow && v < 0.0 ? 1.0 : 0.0;
    t[kEarlyContact][n] = contact && elapsed < kEarly ? 1.0 : 0.0;
    t[kContactAcceleration][n] = c * acceleration;
    t[kFreeAcceleration][n] = f * acceleration;
    memory->highest_prediction = std::max(memory->highest_prediction, std::fabs(prediction[n]));
    t[kOutputRate][n] = prediction[n] - memory->last_prediction;
    t[kHighOutput][n] = std::fabs(prediction[n]) > kHigh * memory->highest_prediction ? 1.0 : 0.0;
    memory->last_prediction = prediction[n];
  }
}

constinit const ContactFamily kContactFamily;

}  // namespace

const GapFamily& ContactGapFamily() noexcept { return kContactFamily; }

}  // namespace armcmc
