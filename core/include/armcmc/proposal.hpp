#pragma once

#include <array>
#include <cstdint>

#include "armcmc/density_block.hpp"
#include "armcmc/nonblocking.hpp"
#include "armcmc/rng.hpp"
#include "armcmc/types.hpp"

namespace armcmc {

namespace simd {
struct Kernels;
}

/// The variable jump distribution (equation `bys4`): a mixture of drawable densities that does not depend on the
/// state of the chain,
///
///   q(u) = sum_c share_c p_c(u),    sum_c share_c = 1,
///
/// so that all candidates can be drawn and scored in one batch and the acceptance ratio is a ratio of weights.
class Proposal {
 public:
  static constexpr int kMaxComponents = 32;

  void Clear() noexcept { size_ = 0; }
  /// Adds a component; ignored when the share is not positive or the mixture is full.
  void Add(const DensityBlock* block, double share) noexcept {
    if (!(share > 0.0) || size_ >= kMaxComponents) return;
    components_[static_cast<std::size_t>(size_++)] = {block, share};
  }
  /// Scales the shares to sum 1.
  void Normalise() noexcept ARMCMC_NONBLOCKING;

  /// Draws candidates u[d][first .. first + count) by inverse CDF, and their component into component_of. Candidate k
  /// uses numbers k * kNumbersPerDraw + ... of the stream, in any batch.
  /// @pre count <= kMaxBatch; u has room for count rounded up to a multiple of 8, scratch dim rows of kMaxBatch + 8.
  void Draw(const simd::Kernels& kernels, const RandomStream& stream, int first, int count, double* const* u,
            std::int8_t* component_of, double* const* scratch) const noexcept ARMCMC_NONBLOCKING;
  static constexpr int kMaxBatch = 1024;
  static constexpr int kNumbersPerDraw = kMaxParams + 1;

  struct Component {
    const DensityBlock* block = nullptr;
    double share = 0.0;
  };
  [[nodiscard]] int size() const noexcept { return size_; }
  [[nodiscard]] const Component& component(int c) const noexcept { return components_[static_cast<std::size_t>(c)]; }

 private:
  int size_ = 0;
  std::array<Component, kMaxComponents> components_;
};

}  // namespace armcmc
