// Integrates the states of described plants; included by described.inl, once per instruction set.

#include "armcmc/plant/state_run.hpp"
#include "simd/tape.inl"

namespace armcmc::simd::ARMCMC_SIMD_NAMESPACE {
namespace {

/// The states of all candidates of a tile, from sample to sample, where the tapes of the laws read them.
class StateIntegrator {
 public:
  /// @param scalars    Of the pack's first sample.
  /// @param past       PastLines::value, where a tape looks something up.
  /// @param registers  With the parameters in them.
  /// @param offset     Added to the starts; null: nothing.
  StateIntegrator(const StateRun& run, const double* scalars, const double* past, TapeRegisters* registers,
                  const StateTile* offset = nullptr) noexcept
      : run_(run), past_(past), registers_(*registers) {
    const Tape& start = *run.start;
    StateTile state;  // NOLINT(cppcoreguidelines-pro-type-member-init): written before read
    if (!run.carried) {
      StartTape(start, scalars, &registers_);
      RunTape(start, scalars, past_, &registers_);
      for (std::size_t s = 0; s < NumStates(); ++s) state.value[s] = registers_.value[start.result[s]];
    }
    for (std::size_t s = 0; s < NumStates(); ++s) {
      if (run.given[s]) state.value[s].fill(run.value[s]);
      if (offset != nullptr)
        for (std::size_t lane = 0; lane < kTileLanes; ++lane) state.value[s][lane] += offset->value[s][lane];
      State(s) = state.value[s];
    }
    StartTape(*run.step, run.Row(0), &registers_);
    if (run.carried) Step();
  }

  /// Goes on to sample n, which is not before the one it stands at.
  void AdvanceTo(int n) noexcept {
    for (; sample_ < n; ++sample_) Step();
  }
  void CopyTo(StateTile* state) noexcept {
    for (std::size_t s = 0; s < NumStates(); ++s) state->value[s] = State(s);
  }

 private:
  [[nodiscard]] std::size_t NumStates() const noexcept { return static_cast<std::size_t>(run_.num_states); }
  [[nodiscard]] std::array<double, kTileLanes>& State(std::size_t s) noexcept {
    return registers_.value[static_cast<std::size_t>(run_.step->num_parameters) + s];
  }

  /// One sample interval.
  void Step() noexcept {
    for (int i = 0; i < run_.substeps; ++i) RunTape(*run_.step, run_.Row(row_++), past_, &registers_);
  }

  const StateRun& run_;
  const double* past_;
  TapeRegisters& registers_;
  int sample_ = 0;
  int row_ = 0;  ///< Substeps done.
};

}  // namespace
}  // namespace armcmc::simd::ARMCMC_SIMD_NAMESPACE
