// Integrates the states of described plants; included by described.inl, once per instruction set.

#include "armcmc/plant/start_fit.hpp"
#include "armcmc/plant/state_run.hpp"
#include "simd/tape.inl"

namespace armcmc::simd::ARMCMC_SIMD_NAMESPACE {
namespace {

/// The states of kSize candidates, from sample to sample, where the tapes of the laws read them.
template <std::size_t kSize>
class StateIntegrator {
  static constexpr std::size_t kLanes = kSize;

 public:
  /// @param scalars    Of the pack's first sample.
  /// @param past       PastLines::value, where a tape looks something up.
  /// @param registers  With the parameters in them.
  /// @param fit        Of the start; null: all candidates start alike.
  /// @param offset     Added to the starts of one tile; null: nothing.
  StateIntegrator(const StateRun& run, const double* scalars, const double* past, TapeRegisters<kSize>* registers,
                  const StartFit* fit, const StateTile* offset = nullptr) noexcept
      : run_(run), past_(past), registers_(*registers) {
    const Tape& start = *run.start;
    std::array<std::array<double, kLanes>, kMaxStates> state;  // NOLINT(cppcoreguidelines-pro-type-member-init):
                                                               // written before read
    if (!run.carried) {
      StartTape(start, scalars, &registers_);
      RunTape(start, scalars, past_, &registers_);
      for (std::size_t s = 0; s < NumStates(); ++s) state[s] = registers_.value[start.result[s]];
    }
    for (std::size_t s = 0; s < NumStates(); ++s) {
      if (run.given[s]) state[s].fill(run.value[s]);
      if (fit != nullptr) {
        if (run.carried) FollowParameters(*fit, s, state[s].data());
        for (std::size_t lane = 0; lane < kLanes; ++lane) state[s][lane] += fit->shift[s];
      }
      if (offset != nullptr)
        for (std::size_t lane = 0; lane < kLanes; ++lane) state[s][lane] += offset->value[s][lane % kTileLanes];
      State(s) = state[s];
    }
    StartTape(*run.step, run.Row(0), &registers_);
    if (run.carried) Step();
  }

  /// Goes on to sample n, which is not before the one it stands at.
  void AdvanceTo(int n) noexcept {
    for (; sample_ < n; ++sample_) Step();
  }
  void CopyTo(StateTile* state) noexcept {
    for (std::size_t s = 0; s < NumStates(); ++s) std::copy_n(State(s).data(), kLanes, state->value[s].data());
  }

 private:
  void FollowParameters(const StartFit& fit, std::size_t s, double* state) const noexcept {
    for (std::size_t d = 0; d < static_cast<std::size_t>(fit.num_parameters); ++d)
      for (std::size_t lane = 0; lane < kLanes; lane += Simd::kLanes) {
        const Simd::V away = Simd::Load(registers_.value[d].data() + lane) - Simd::Set(fit.about[d]);
        const Simd::V size = Simd::Abs(away);
        const Simd::V back = Simd::Max(Simd::Set(2.0 * fit.reach[d]) - size, Simd::V{});
        Simd::Store(state + lane, Simd::Fma(Simd::CopySign(Simd::Min(size, back), away), Simd::Set(fit.slope[s][d]),
                                            Simd::Load(state + lane)));
      }
  }
  [[nodiscard]] std::size_t NumStates() const noexcept { return static_cast<std::size_t>(run_.num_states); }
  [[nodiscard]] std::array<double, kLanes>& State(std::size_t s) noexcept {
    return registers_.value[static_cast<std::size_t>(run_.step->num_parameters) + s];
  }

  /// One sample interval.
  void Step() noexcept {
    for (int i = 0; i < run_.substeps; ++i) RunTape(*run_.step, run_.Row(row_++), past_, &registers_);
  }

  const StateRun& run_;
  const double* past_;
  TapeRegisters<kSize>& registers_;
  int sample_ = 0;
  int row_ = 0;  ///< Substeps done.
};

}  // namespace
}  // namespace armcmc::simd::ARMCMC_SIMD_NAMESPACE
