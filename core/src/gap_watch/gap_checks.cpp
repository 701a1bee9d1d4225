#include "armcmc/gap_watch/gap_checks.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "gap_tools.hpp"

namespace armcmc {
namespace {

constexpr double kEarly = 0.25;    // s after a change of mode
constexpr double kShallow = 0.25;  // of the largest magnitude

/// Time since the last change of mode, carried from pack to pack.
double TimeInMode(int mode, double dt, RegionMemory* memory) noexcept {
  memory->in_mode_s = mode == memory->mode || memory->mode < 0 ? memory->in_mode_s + dt : 0.0;
  memory->mode = mode;
  return memory->in_mode_s;
}

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

enum ActuatorRegion : std::uint8_t {
  kAnyValve,
  kVenting,
  kHighPressureFilling,
  kHighPressureVenting,
  kSmallOpening,
  kEarlyOpening,
  kPressure,
  kNumActuatorRegions
};

class ActuatorFamily final : public GapFamily {
 public:
  constexpr ActuatorFamily()
      : GapFamily({.first = 0,
                   .num_regions = kNumActuatorRegions,
                   .regions = {"any_valve", "venting", "high_pressure_filling", "high_pressure_venting",
                               "small_opening", "early_opening", "pressure"},
                   .serial = kSerialChecks},
                  false) {}

  void Fill(const DataPack& pack, const std::array<int, kMaxPackSamples>& modes, const double* prediction,
            RegionMemory* memory, RegionTemplates* out) const noexcept ARMCMC_NONBLOCKING override;
};

// pdot is measured with noise, which is also in the errors: no region may depend on it, nor on predictions made from
// it.
void ActuatorFamily::Fill(const DataPack& pack, const std::array<int, kMaxPackSamples>& modes, const double*,
                          RegionMemory* memory, RegionTemplates* out) const noexcept {
  RegionTemplates& t = *out;
  constexpr double kAtmosphere = 101'325.0;  // only a size to compare with
  for (std::size_t n = 0; n < static_cast<std::size_t>(pack.num_samples); ++n) {
    const int mode = modes[n];
    const double pressure = pack.u[n][2] - kAtmosphere;
    const double opening = std::fabs(pack.u[n][0]) + std::fabs(pack.u[n][1]);
    memory->largest = std::max(memory->largest, opening);
    const double elapsed = TimeInMode(mode, pack.dt, memory);
    const bool open = mode < 2;
    t[kAnyValve][n] = open ? 1.0 : 0.0;
    t[kVenting][n] = mode == 1 ? 1.0 : 0.0;
    t[kHighPressureFilling][n] = mode == 0 ? pressure / kAtmosphere : 0.0;
    t[kHighPressureVenting][n] = mode == 1 ? pressure / kAtmosphere : 0.0;
    t[kSmallOpening][n] = open && opening < kShallow * memory->largest ? Sign(pack.u[n][0] - pack.u[n][1]) : 0.0;
    t[kEarlyOpening][n] = open && elapsed < 0.1 * kEarly ? 1.0 : 0.0;
    t[kPressure][n] = open ? pressure * pressure / (kAtmosphere * kAtmosphere) : 0.0;
  }
}

constinit const ContactFamily kContactFamily;
constinit const ActuatorFamily kActuatorFamily;

constexpr GapChecks kBendChecks{
    .first = kNumActuatorRegions + kNumSerialChecks,
    .num_regions = kNumBendRegions,
    .regions = {"bending", "bend_direction", "bend_speed", "bend_angle", "bend_large_angle", "bend_acceleration"},
    .serial = {"bend_repeats_after_a_pack", "bend_repeats_after_two_packs", "bend_slow_wander",
               "bend_wander_after_two_packs"},
};

}  // namespace

const GapFamily& FamilyOf(PlantKind plant) noexcept {
  if (plant == PlantKind::kSoftActuator) return kActuatorFamily;
  return kContactFamily;
}

const GapChecks& BendChecks() noexcept { return kBendChecks; }

std::string_view GapCheckName(PlantKind plant, int check) noexcept {
  const GapChecks& fitted = FamilyOf(plant).checks();
  if (check < 0) return "";
  if (check < fitted.size()) return fitted.name(check);
  const int bend = check - kBendChecks.first;
  return plant == PlantKind::kSoftActuator && bend < kBendChecks.size() ? kBendChecks.name(bend) : "";
}

}  // namespace armcmc
