// Integrates the states of described plants; included by described.inl, once per instruction set.

#include "armcmc/plant/state_run.hpp"
#include "simd/tape.inl"

namespace armcmc::simd::ARMCMC_SIMD_NAMESPACE {
namespace {

/// The states of all candidates of a tile, from sample to sample.
class StateIntegrator {
 public:
  /// @param scalars  Of the pack's first sample.
  /// @param offset   Added to the starts; null: nothing.
  StateIntegrator(const StateRun& run, const ThetaTile& theta, const double* scalars,
                  const StateTile* offset = nullptr) noexcept
      : run_(run), num_states_(static_cast<std::size_t>(run.num_states)) {
    StartTape(*run.rate, theta, run.Row(0), &registers_);
    if (run.start != nullptr) {
      // Before the first row of the rates: their registers are free.
      TapeRegisters begin;  // NOLINT(cppcoreguidelines-pro-type-member-init): written before read
      StartTape(*run.start, theta, scalars, &begin);
      TapeRunner(&begin, scalars)
          .Run(run.start->code.data() + run.start->once, run.start->code.data() + run.start->size);
      for (std::size_t s = 0; s < num_states_; ++s) state_.value[s] = begin.value[run.start->result[s]];
    }
    for (std::size_t s = 0; s < num_states_; ++s)
      if (run.given[s]) state_.value[s].fill(run.value[s]);
    if (offset != nullptr) Add(*offset);
    if (run.carried) Step();
  }

  /// Goes on to sample n, which is not before the one it stands at.
  void AdvanceTo(int n) noexcept {
    for (; sample_ < n; ++sample_) Step();
  }
  [[nodiscard]] const StateTile& state() const noexcept { return state_; }

  /// Puts the states where a tape reads them.
  void CopyTo(const Tape& tape, TapeRegisters* registers) const noexcept {
    for (std::size_t s = 0; s < num_states_; ++s)
      registers->value[static_cast<std::size_t>(tape.num_parameters) + s] = state_.value[s];
  }

 private:
  using Vec = Simd::V;

  void Add(const StateTile& offset) noexcept {
    for (std::size_t s = 0; s < num_states_; ++s)
      for (std::size_t lane = 0; lane < kTileLanes; ++lane) state_.value[s][lane] += offset.value[s][lane];
  }

  /// One sample interval.
  void Step() noexcept {
    switch (run_.num_states) {  // few states stay in registers
      case 1: Substeps<1>(); break;
      case 2: Substeps<2>(); break;
      case 3: Substeps<3>(); break;
      case 4: Substeps<4>(); break;
      default: Substeps<kMaxStates>();
    }
  }

  template <std::size_t kMost>
  void Substeps() noexcept {
    const double h = run_.h;
    CopyTo(*run_.rate, &registers_);
    for (int i = 0; i < run_.substeps; ++i, row_ += 2) {
      Rates(row_);
      Advance<kMost, true>(1.0, 0.5 * h);
      Rates(row_ + 1);
      Advance<kMost, false>(2.0, 0.5 * h);
      Rates(row_ + 1);
      Advance<kMost, false>(2.0, h);
      Rates(row_ + 2);
      Finish<kMost>(h / 6.0);
    }
  }

  void Rates(int row) noexcept {
    const Tape& tape = *run_.rate;
    TapeRunner(&registers_, run_.Row(row)).Run(tape.code.data() + tape.once, tape.code.data() + tape.size);
  }

  [[nodiscard]] double* Moving(std::size_t s) noexcept {
    return registers_.value[static_cast<std::size_t>(run_.rate->num_parameters) + s].data();
  }
  [[nodiscard]] const double* Rate(std::size_t s) const noexcept {
    return registers_.value[run_.rate->result[s]].data();
  }
  template <std::size_t kMost>
  [[nodiscard]] std::size_t Count() const noexcept {
    return kMost < kMaxStates ? kMost : num_states_;
  }

  /// sum (+)= weight x rate, and the states of the rates become x + step x rate. A rate may be the register of another
  /// state, so that all are read before one is written.
  template <std::size_t kMost, bool kFirst>
  void Advance(double weight, double step) noexcept {
    const Vec w = Simd::Set(weight);
    const Vec h = Simd::Set(step);
    for (int lane = 0; lane < kTileLanes; lane += Simd::kLanes) {
      Vec moved[kMost];
      for (std::size_t s = 0; s < Count<kMost>(); ++s) {
        const Vec rate = Simd::Load(Rate(s) + lane);
        double* sum = sum_.value[s].data() + lane;
        Simd::Store(sum, kFirst ? rate : Simd::Fma(rate, w, Simd::Load(sum)));
        moved[s] = Simd::Fma(rate, h, Simd::Load(state_.value[s].data() + lane));
      }
      for (std::size_t s = 0; s < Count<kMost>(); ++s) Simd::Store(Moving(s) + lane, moved[s]);
    }
  }

  /// x += sixth x (sum + rate), for the next substep, too.
  template <std::size_t kMost>
  void Finish(double sixth) noexcept {
    const Vec h = Simd::Set(sixth);
    for (int lane = 0; lane < kTileLanes; lane += Simd::kLanes) {
      Vec moved[kMost];
      for (std::size_t s = 0; s < Count<kMost>(); ++s) {
        const Vec all = Simd::Load(sum_.value[s].data() + lane) + Simd::Load(Rate(s) + lane);
        moved[s] = Simd::Fma(all, h, Simd::Load(state_.value[s].data() + lane));
      }
      for (std::size_t s = 0; s < Count<kMost>(); ++s) {
        Simd::Store(state_.value[s].data() + lane, moved[s]);
        Simd::Store(Moving(s) + lane, moved[s]);
      }
    }
  }

  const StateRun& run_;
  std::size_t num_states_;
  int sample_ = 0;
  int row_ = 0;
  TapeRegisters registers_;
  StateTile state_, sum_;
};

}  // namespace
}  // namespace armcmc::simd::ARMCMC_SIMD_NAMESPACE
