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
/// it, and so do means of packs.
inline constexpr int kNumSerialChecks = 4;
inline constexpr int kMaxGapChecks = kMaxRegions + kNumSerialChecks;

/// Value of every region's template at every sample of one pack.
using RegionTemplates = std::array<std::array<double, kMaxPackSamples>, kMaxRegions>;

/// What regions remember of the packs before.
struct RegionMemory {
  double largest = 0.0;    ///< Magnitude of the input.
  double in_mode_s = 1e3;  ///< Since the last change of mode.
  int mode = -1;
  double last_prediction = 0.0;
  double highest_prediction = 0.0;  ///< Of its absolute value.
  /// Of every input of a described plant.
  struct Input {
    bool seen = false;
    double lowest = 0.0, highest = 0.0;
    bool positive = false;
    int since_reversal = 1 << 20;  ///< Samples since the sign changed.
  };
  std::array<Input, kMaxPackInputs> input{};
};

/// What the errors of one equation are checked for: regions, and how errors follow each other. A region is a template:
/// a function of the inputs and of time, zero outside the region.
///
/// Region 0 is the constant everywhere, from which the wander of pack means is computed, too.
struct GapChecks {
  int first;  ///< Of the checks of the plant, which may have several equations.
  int num_regions;
  std::array<std::string_view, kMaxRegions> regions;
  std::array<std::string_view, kNumSerialChecks> serial;

  [[nodiscard]] constexpr int size() const noexcept { return num_regions + kNumSerialChecks; }
  /// @param index  In [0, size()).
  [[nodiscard]] constexpr std::string_view name(int index) const noexcept {
    return index < num_regions ? regions[static_cast<std::size_t>(index)]
                               : serial[static_cast<std::size_t>(index - num_regions)];
  }
};

/// The checks of the laws that the estimator of a plant fits, and what their regions are.
class GapFamily {
 public:
  virtual ~GapFamily() = default;
  GapFamily(const GapFamily&) = delete;  // names may point into a family
  GapFamily& operator=(const GapFamily&) = delete;

  [[nodiscard]] const GapChecks& checks() const noexcept { return checks_; }
  /// A passive mode says what is measured in it: its samples are judged, too.
  [[nodiscard]] bool judges_passive() const noexcept { return judges_passive_; }
  /// @param modes       Mode of every sample.
  /// @param prediction  Output of the model at every sample, in units of the noise.
  /// @rt No heap, no lock, no throw. O(samples x regions).
  virtual void Fill(const DataPack& pack, const std::array<int, kMaxPackSamples>& modes, const double* prediction,
                    RegionMemory* memory, RegionTemplates* out) const noexcept ARMCMC_NONBLOCKING = 0;

 protected:
  constexpr GapFamily() = default;
  constexpr GapFamily(const GapChecks& checks, bool judges_passive)
      : checks_(checks), judges_passive_(judges_passive) {}

  GapChecks checks_{};
  bool judges_passive_ = false;
};

/// Names of the serial checks of the laws that are fitted.
inline constexpr std::array<std::string_view, kNumSerialChecks> kSerialChecks{
    "repeats_after_a_pack", "repeats_after_two_packs", "slow_wander", "wander_after_two_packs"};

}  // namespace armcmc
