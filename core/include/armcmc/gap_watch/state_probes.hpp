#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "armcmc/data_pack.hpp"
#include "armcmc/gap_watch/gap_checks.hpp"
#include "armcmc/last_pack.hpp"
#include "armcmc/mode_data.hpp"
#include "armcmc/nonblocking.hpp"
#include "armcmc/plant/program.hpp"
#include "armcmc/plant/state_run.hpp"

namespace armcmc {

namespace simd {
struct Kernels;
}

/// Regions of a plant with states: what a small term that its rates lack would do to the output.
///
/// An effect inside such a plant is not seen where and when it acts, but as the motion that it causes. The template of
/// a term g(x, u) in the rate of a state is therefore the response of the law to it,
///
///   phi = d law / d a,   dx/dt = f(x, u, theta) + a g(x, u),   at a = 0, from the same start,
///
/// by central differences. A term of a state whose rate is another state (a position) acts on that one. Of a velocity:
/// its direction, v |v| and itself; of other states a constant, x, x^2, x^3; of inputs u |u|. What the parameters
/// explain is projected out as of every region.
class StateProbes {
 public:
  /// Allocates. @param plant  Of the laws, with states. @param room  Most terms.
  StateProbes(const PlantProgram& plant, const simd::Kernels& kernels, int room);

  [[nodiscard]] int size() const noexcept { return static_cast<int>(names_.size()); }
  [[nodiscard]] const std::vector<std::string>& names() const noexcept { return names_; }
  /// Of a pack whose integration fits.
  [[nodiscard]] int most_samples() const noexcept { return most_samples_; }

  /// @param theta, start, noise_std  Of the law and states at the first sample, where it is linearised.
  /// @param out  From (*out)[first] on: 0 where nothing is finite.
  /// @rt No heap, no lock, no throw. O(samples x operations of the rates x terms).
  void Fill(const DataPack& pack, const std::array<double, kMaxParams>& theta,
            const std::array<double, kMaxStates>& start, double noise_std, int first,
            RegionTemplates* out) noexcept ARMCMC_NONBLOCKING;
  void Reset() noexcept ARMCMC_NONBLOCKING { last_ = LastPack{}; }

 private:
  /// Terms that are parameters of one program, behind those of the plant.
  struct Group {
    std::unique_ptr<const PlantProgram> program;
    int first = 0, count = 0;
    expression::FeatureMemory memory;
  };

  void Respond(const Group& group, const std::array<double, kMaxParams>& theta, double noise_std, int num_samples,
               int first, RegionTemplates* out) noexcept ARMCMC_NONBLOCKING;

  const simd::Kernels& kernels_;
  int num_parameters_;
  int most_samples_;
  std::vector<std::string> names_;
  std::vector<Group> groups_;
  std::array<double, kMaxRegions> size_{};  ///< Of a term, for the difference quotient.
  LastPack last_;
  PlantPack pack_;
  ModeData data_;
  ThetaTile theta_;
  StateTile offset_{}, end_;
  PredictionTile law_;
};

}  // namespace armcmc
