#include "armcmc/plant/output_trajectory.hpp"

#include <algorithm>
#include <cmath>

#include "simd/kernels.hpp"

namespace armcmc {

OutputTrajectory::OutputTrajectory(const PlantProgram* prediction, const simd::Kernels& kernels)
    : prediction_(prediction), kernels_(kernels) {}

void OutputTrajectory::Reset() noexcept { last_ = LastPack{}; }

bool OutputTrajectory::Prepare(const DataPack& pack) noexcept {
  const bool continues = last_.ContinuesWith(pack);
  last_ = LastPack::Of(pack);
  if (!continues) features_.Clear();
  if (!prediction_->Prepare(pack, &features_, continues && states_.known ? &states_ : nullptr, &pack_)) {
    Reset();
    return false;
  }
  prediction_->Leave(pack_, pack.num_samples, &states_);
  prediction_->Fill(pack_, pack.num_samples, 0, &data_);
  data_.pack_share = 1.0;
  data_.weighted = false;
  std::fill_n(data_.weight.begin(), static_cast<std::size_t>(pack.num_samples), 1.0);
  return true;
}

void OutputTrajectory::Run(const ThetaTile& theta, PredictionTile* output) noexcept {
  if (prediction_->states().size() == 0) {
    kernels_.predict(0, data_, theta, output);
    return;
  }
  kernels_.run_states(data_, theta, no_offset_, &end_, output);
  states_.known = true;
  for (std::size_t s = 0; s < static_cast<std::size_t>(prediction_->states().size()); ++s) {
    states_.state[s] = end_.value[s][0];
    states_.known = states_.known && std::isfinite(states_.state[s]);
  }
}

}  // namespace armcmc
