#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "armcmc/gap_watch/gap_checks.hpp"
#include "armcmc/nonblocking.hpp"
#include "armcmc/plant/program.hpp"

namespace armcmc {

/// The checks of a described plant, made from the roles of its inputs: of a velocity its direction, size, slow motion
/// and the time after a reversal, of a position both ends of its range, of any input its upper end and its square.
/// What the parameters can explain is projected out of every region (GapBlock), so that a region may repeat the law.
///
/// An input that is part of what a mode explains is measured with noise that is in the errors, too: no region depends
/// on it, nor on predictions made from it.
class DescribedFamily final : public GapFamily {
 public:
  /// Allocates. @param plant  Outlives the family.
  /// @param probes  Names of the regions that StateProbes fills.
  explicit DescribedFamily(const PlantProgram& plant, const std::vector<std::string>& probes = {});
  static constexpr int kMostProbes = 8;
  /// The region of the first of them; negative: there is none.
  [[nodiscard]] int first_probe() const noexcept ARMCMC_NONBLOCKING { return first_probe_; }

  void Fill(const DataPack& pack, const std::array<int, kMaxPackSamples>& modes, const double* prediction,
            RegionMemory* memory, RegionTemplates* out) const noexcept ARMCMC_NONBLOCKING override;

 private:
  enum class Kind : std::uint8_t {
    kEverywhere,
    kInMode,
    kOutputRate,
    kHighOutput,
    kProbe,
    kDirection,
    kValue,
    kSlow,
    kReversal,
    kSlope,
    kSquare,
    kHigh,
    kLow
  };
  struct Region {
    Kind kind = Kind::kEverywhere;
    int index = 0;  ///< Of an input, or of a mode.
    std::string name;
  };

  /// Does nothing when there is no room.
  void Add(Kind kind, int index, std::string name);
  void AddInput(const SignalDescription& signal, int input, bool has_acceleration);
  [[nodiscard]] static double Value(Kind kind, double u, const RegionMemory::Input& input) noexcept ARMCMC_NONBLOCKING;

  std::array<Region, kMaxRegions> regions_;
  int first_probe_ = -1;
  bool trajectories_begin_anew_ = false;  ///< With every pack.
};

}  // namespace armcmc
