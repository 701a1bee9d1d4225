#include "armcmc/proposal.hpp"

#include <algorithm>

#include "simd/kernels.hpp"

namespace armcmc {

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
  const int padded = (count + 7) / 8 * 8;
  const auto origin = static_cast<std::uint64_t>(first) * kNumbersPerDraw;
  kernels.uniforms(stream.origin(), origin, kNumbersPerDraw, padded, pick.data());
  for (int d = 0; d < dim; ++d)
    kernels.uniforms(stream.origin(), origin + static_cast<std::uint64_t>(d) + 1, kNumbersPerDraw, padded,
                     u[d] + first);
  // Candidates of one component together: its axes and tables stay where they are needed.
  std::array<std::int32_t, kMaxBatch> component;
  std::fill_n(component.begin(), count, 0);
  for (int c = 0; c + 1 < size_; ++c) {
    const double bound = cumulative[static_cast<std::size_t>(c)];
    for (int i = 0; i < count; ++i) {
      const auto ii = static_cast<std::size_t>(i);
      component[ii] += pick[ii] >= bound ? 1 : 0;
    }
  }
  std::array<int, kMaxComponents + 1> start{};
  for (int i = 0; i < count; ++i) {
    const std::int32_t c = component[static_cast<std::size_t>(i)];
    component_of[i] = static_cast<std::int8_t>(c);
    ++start[static_cast<std::size_t>(c) + 1];
  }
  for (std::size_t c = 0; c < kMaxComponents; ++c) start[c + 1] += start[c];
  std::array<std::int16_t, kMaxBatch> order;
  std::array<int, kMaxComponents + 1> next = start;
  for (int i = 0; i < count; ++i)
    order[static_cast<std::size_t>(next[static_cast<std::size_t>(component_of[i])]++)] = static_cast<std::int16_t>(i);
  for (int c = 0; c < size_; ++c) {
    const auto cc = static_cast<std::size_t>(c);
    const std::int16_t* members = &order[static_cast<std::size_t>(start[cc])];
    const int size = start[cc + 1] - start[cc];
    if (size == 0) continue;
    const int whole = (size + 7) / 8 * 8;
    for (int d = 0; d < dim; ++d) {
      const double* from = u[d] + first;
      for (int i = 0; i < size; ++i) scratch[d][i] = from[members[i]];
      for (int i = size; i < whole; ++i) scratch[d][i] = 0.5;
    }
    kernels.draw_block(*components_[cc].block, whole, scratch);
    for (int d = 0; d < dim; ++d) {
      double* to = u[d] + first;
      for (int i = 0; i < size; ++i) to[members[i]] = scratch[d][i];
    }
  }
}

}  // namespace armcmc
