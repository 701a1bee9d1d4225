#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "armcmc/data_pack.hpp"
#include "armcmc/nonblocking.hpp"
#include "armcmc/types.hpp"

namespace armcmc {

inline constexpr int kMaxRegions = 14;  ///< Templates of one plant family.
/// Checks that need no region and that every family has: errors of one pack come back in the next or in the one after
/// it, and means of packs that wander.
inline constexpr int kNumSerialChecks = 3;
inline constexpr int kMaxGapChecks = kMaxRegions + kNumSerialChecks;
inline constexpr std::array<std::string_view, kNumSerialChecks> kSerialChecks{"repeats_after_a_pack",
                                                                              "repeats_after_two_packs", "slow_wander"};

/// Value of every region's template at every sample of one pack.
using RegionTemplates = std::array<std::array<double, kMaxPackSamples>, kMaxRegions>;

/// What regions remember of the packs before.
struct RegionMemory {
  double largest = 0.0;    ///< Magnitude of the input.
  double in_mode_s = 1e3;  ///< Since the last change of mode.
  int mode = -1;
  double last_prediction = 0.0;
  double highest_prediction = 0.0;  ///< Of its absolute value.
};

/// The regions in which the errors of a plant family are looked at. A region is a template: a function of the inputs
/// and of time, zero outside the region. A new family is one entry in FamilyOf() (gap_checks.cpp).
///
/// Region 0 is the constant everywhere, from which the wander of pack means is computed, too.
struct GapFamily {
  bool passive_is_zero;  ///< The passive mode predicts 0: its samples are judged, too.
  int num_regions;
  std::array<std::string_view, kMaxRegions> regions;
  /// @param modes       Mode of every sample.
  /// @param prediction  Output of the model at every sample, in units of the noise.
  void (*fill)(const DataPack& pack, const std::array<int, kMaxPackSamples>& modes, const double* prediction,
               RegionMemory* memory, RegionTemplates* out) noexcept ARMCMC_NONBLOCKING;

  [[nodiscard]] int num_checks() const noexcept { return num_regions + kNumSerialChecks; }
  [[nodiscard]] std::string_view check(int index) const noexcept {
    return index < num_regions ? regions[static_cast<std::size_t>(index)]
                               : kSerialChecks[static_cast<std::size_t>(index - num_regions)];
  }
};

[[nodiscard]] const GapFamily& FamilyOf(PlantKind plant) noexcept ARMCMC_NONBLOCKING;

}  // namespace armcmc
