#include "armcmc/estimate.hpp"

#include <bit>

#include "armcmc/snapshot.hpp"

namespace armcmc {

// A MarginalSummary consists of numbers only.
using MarginalNumbers = std::array<double, sizeof(MarginalSummary) / sizeof(double)>;

void ModeEstimate::Save(int num_reported, SnapshotWriter* out) const noexcept {
  out->PutFlag(known);
  out->Put(noise_std);
  for (std::size_t i = 0; i < static_cast<std::size_t>(num_reported); ++i) {
    const auto numbers = std::bit_cast<MarginalNumbers>(marginal[i]);
    out->PutRow(numbers.data(), numbers.size());
  }
}

void ModeEstimate::Restore(int num_reported, SnapshotReader* in) noexcept {
  *this = ModeEstimate{};
  known = in->Flag();
  noise_std = in->Number();
  for (std::size_t i = 0; i < static_cast<std::size_t>(num_reported); ++i) {
    MarginalNumbers numbers{};
    in->Row(numbers.data(), numbers.size());
    marginal[i] = std::bit_cast<MarginalSummary>(numbers);
  }
}

void ModeEstimate::SaveDrift(int num_reported, SnapshotWriter* out) const noexcept {
  out->Put(p_drifted);
  out->PutRow(drift_rate.data(), static_cast<std::size_t>(num_reported));
}

void ModeEstimate::RestoreDrift(int num_reported, SnapshotReader* in) noexcept {
  p_drifted = in->Number();
  in->Row(drift_rate.data(), static_cast<std::size_t>(num_reported));
  in->Require(p_drifted >= 0.0 && p_drifted <= 1.0);
}

}  // namespace armcmc
