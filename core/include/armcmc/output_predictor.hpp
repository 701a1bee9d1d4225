#pragma once

#include <array>

#include "armcmc/data_pack.hpp"
#include "armcmc/nonblocking.hpp"
#include "armcmc/types.hpp"

namespace armcmc {

/// Point estimates of all modes that were on display while a pack was measured.
struct ShownEstimates {
  std::array<bool, kMaxModes> known{};
  std::array<std::array<double, kMaxParams>, kMaxModes> theta{};
};

/// The output of a compiled plant from point estimates. NaN where it is not known.
class OutputPredictor {
 public:
  OutputPredictor() = default;
  OutputPredictor(const OutputPredictor&) = delete;
  OutputPredictor& operator=(const OutputPredictor&) = delete;
  virtual ~OutputPredictor() = default;

  /// Forgets the packs before.
  virtual void Reset() noexcept ARMCMC_NONBLOCKING {}

  /// Predicts every sample of the pack: `output` with what was measured before it, `free_run` from the inputs alone.
  /// @rt No heap, no lock, no throw. O(samples).
  virtual void Predict(const DataPack& pack, const ShownEstimates& shown, std::array<double, kMaxPackSamples>* output,
                       std::array<double, kMaxPackSamples>* free_run) noexcept ARMCMC_NONBLOCKING = 0;

  /// Output at the last sample of the pack for other parameters of `mode`, from the state before the pack; for bands.
  /// @param shown  What the other modes have. @pre The law is not the output: else the law itself says it.
  /// @rt As Predict().
  [[nodiscard]] virtual double LastOutput(const DataPack& pack, const ShownEstimates& shown, int mode,
                                          const double* theta) const noexcept ARMCMC_NONBLOCKING = 0;
};

}  // namespace armcmc
