#include "plants/soft_actuator/gap_family.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "gap_watch/gap_tools.hpp"

namespace armcmc {
namespace {

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

constinit const ActuatorFamily kActuatorFamily;

constexpr GapChecks kBendChecks{
    .first = kNumActuatorRegions + kNumSerialChecks,
    .num_regions = kNumBendRegions,
    .regions = {"bending", "bend_direction", "bend_speed", "bend_angle", "bend_large_angle", "bend_acceleration"},
    .serial = {"bend_repeats_after_a_pack", "bend_repeats_after_two_packs", "bend_slow_wander",
               "bend_wander_after_two_packs"},
};

}  // namespace

const GapFamily& ActuatorGapFamily() noexcept { return kActuatorFamily; }

const GapChecks& BendChecks() noexcept { return kBendChecks; }

}  // namespace armcmc
