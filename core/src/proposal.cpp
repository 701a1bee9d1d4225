#include "armcmc/proposal.hpp"

#include <algorithm>

#include "simd/kernels.hpp"

namespace armcmc {
namespace {

/// Candidates by component.
class Groups {
 public:
  /// @pre 0 <= choice[i] < kMaxComponents, count <= kMaxBatch.
  void Sort(const std::int8_t* choice, int count) noexcept {
    // Each quarter has its own counters, to avoid dependencies between the sums of one batch.
    const int quarter = (count + kParts - 1) / kParts;
    Counts size{};
    ForAll(choice, count, quarter, [&](std::size_t part, std::size_t c, int) { ++size[part][c]; });
    Counts next{};
    int at = 0;
    for (std::size_t c = 0; c < Proposal::kMaxComponents; ++c) {
      start_[c] = at;
      for (std::size_t part = 0; part < kParts; ++part) {
        next[part][c] = at;
        at += size[part][c];
      }
    }
    start_[Proposal::kMaxComponents] = at;
    ForAll(choice, count, quarter, [&](std::size_t part, std::size_t c, int i) {
      member_[static_cast<std::size_t>(next[part][c]++)] = static_cast<std::int16_t>(i);
    });
    std::fill_n(&member_[static_cast<std::size_t>(count)], kPadding, std::int16_t{0});
  }
  /// Size(c) candidates, padded with other candidates to a multiple of 8.
  [[nodiscard]] const std::int16_t* Members(int c) const noexcept {
    return &member_[static_cast<std::size_t>(start_[static_cast<std::size_t>(c)])];
  }
  [[nodiscard]] int Size(int c) const noexcept {
    return start_[static_cast<std::size_t>(c) + 1] - start_[static_cast<std::size_t>(c)];
  }

 private:
  static constexpr int kParts = 4;
  static constexpr int kPadding = 8;
  using Counts = std::array<std::array<int, Proposal::kMaxComponents>, kParts>;

  template <class Fn>
  static void ForAll(const std::int8_t* choice, int count, int quarter, const Fn& fn) noexcept {
    for (int j = 0; j < quarter; ++j)
      for (int part = 0; part < kParts; ++part) {
        const int i = part * quarter + j;
        if (i < count) fn(static_cast<std::size_t>(part), static_cast<std::size_t>(choice[i]), i);
      }
  }

  std::array<int, Proposal::kMaxComponents + 1> start_;
  std::array<std::int16_t, Proposal::kMaxBatch + kPadding> member_;
};

}  // namespace

void Proposal::Normalise() noexcept {
  double sum = 0.0;
  for (int c = 0; c < size_; ++c) sum += components_[static_cast<std::size_t>(c)].share;
  for (int c = 0; c < size_; ++c) components_[static_cast<std::size_t>(c)].share /= sum;
}

void Proposal::Draw(const simd::Kernels& kernels, const RandomStream& stream, int first, int count, double* const* u,
                    std::int8_t* component_of, double* const* scratch) const noexcept {
  const int dim = components_[0].block->dim;
  std::array<double, kMaxComponents> cumulative{};
  double sum = 0.0;
  for (int c = 0; c < size_; ++c) {
    sum += components_[static_cast<std::size_t>(c)].share;
    cumulative[static_cast<std::size_t>(c)] = sum;
  }
  alignas(64) std::array<double, kMaxBatch> pick;
  alignas(64) std::array<std::int8_t, kMaxBatch> choice;
  const int padded = (count + 7) / 8 * 8;
  const auto origin = static_cast<std::uint64_t>(first) * kNumbersPerDraw;
  kernels.uniforms(stream.origin(), origin, kNumbersPerDraw, padded, pick.data());
  kernels.choose(pick.data(), cumulative.data(), size_ - 1, padded, choice.data());
  std::copy_n(choice.data(), count, component_of);
  // Candidates of one component together, so that its axes and tables stay in the cache.
  Groups groups;
  groups.Sort(choice.data(), count);
  for (int c = 0; c < size_; ++c) {
    const std::int16_t* const members = groups.Members(c);
    const int size = groups.Size(c);
    if (size == 0) continue;
    const int whole = (size + 7) / 8 * 8;
    for (int d = 0; d < dim; ++d)
      kernels.uniforms_of(stream.origin(), origin + static_cast<std::uint64_t>(d) + 1, kNumbersPerDraw, members, whole,
                          scratch[d]);
    kernels.draw_block(*components_[static_cast<std::size_t>(c)].block, whole, scratch);
    for (int d = 0; d < dim; ++d) {
      double* const to = u[d] + first;
      const double* const from = scratch[d];
      for (int i = 0; i < size; ++i) to[members[i]] = from[i];
    }
  }
}

}  // namespace armcmc
