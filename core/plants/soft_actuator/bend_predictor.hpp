#pragma once

#include <array>

#include "armcmc/data_pack.hpp"
#include "armcmc/model.hpp"
#include "armcmc/nonblocking.hpp"
#include "armcmc/output_predictor.hpp"
#include "armcmc/settings.hpp"
#include "armcmc/types.hpp"
#include "plants/soft_actuator/bend_motion.hpp"
#include "plants/soft_actuator/flow_plan.hpp"

namespace armcmc {

/// The bending angle from point estimates of the valves.
///
/// It follows  alpha'' = q1 (p - p_atm) - q2 alpha' - q3 alpha  with p from the valve law; it is integrated with
/// the exact transition of the linear part for p linear between samples. Two runs are kept: one restarted from the
/// measured pressure at each pack, one that sees only the valve inputs since the first pack. Inputs that arrive before
/// their mode has an estimate are kept (up to kBacklogPacks packs) and integrated once it has one.
///
/// Effects of the valve flow act on that pressure as they do in the regression. While both valves are shut they have
/// the amplitudes of the valve that was open last.
class BendPredictor final : public OutputPredictor {
 public:
  static constexpr int kBacklogPacks = 8;

  /// @param info  Must outlive this.
  BendPredictor(const ModelInfo& info, const ActuatorConstants& constants, const FlowPlan& flow = {});

  /// Forgets the state: the next pack starts both runs from its measurements.
  void Reset() noexcept ARMCMC_NONBLOCKING override { last_seq_ = -1; }

  /// Predicts every sample of the pack and advances the state. A gap in the pack numbers restarts both runs from the
  /// measurements. @rt No heap, no lock, no throw. O(kBacklogPacks samples).
  void Predict(const DataPack& pack, const ShownEstimates& shown, std::array<double, kMaxPackSamples>* output,
               std::array<double, kMaxPackSamples>* free_run) noexcept ARMCMC_NONBLOCKING override;

  [[nodiscard]] double LastOutput(const DataPack& pack, const ShownEstimates& shown, int mode,
                                  const double* theta) const noexcept ARMCMC_NONBLOCKING override;

  /// Pressure (Pa) that the chamber holds when the sensor says `measured`: without the sensor's zero,
  /// where the model knows one. @param mode  Whose parameters say so; where it has none, those of the other valve.
  [[nodiscard]] double TruePressure(double measured, double t_s, int mode,
                                    const ShownEstimates& shown) const noexcept ARMCMC_NONBLOCKING;

 private:
  struct State {
    double p = 0.0;
    BendMotion::State bend;
    double spool = 0.0;  ///< Of slow valves.
    int valve = 2;       ///< Open last; 2: none yet.
  };
  struct Input {
    double u_c = 0.0, u_d = 0.0, t_s = 0.0;
  };
  /// Pressure one sample on by the law alone. @return false when a mode that acts is not known.
  [[nodiscard]] bool NextPressure(const Input& input, const ShownEstimates& shown, const State& state,
                                  double* p) const noexcept ARMCMC_NONBLOCKING;
  /// The same with effects; moves the spool.
  [[nodiscard]] bool NextPressureWithEffects(const Input& input, const ShownEstimates& shown, State* state,
                                             double* p) const noexcept ARMCMC_NONBLOCKING;
  /// Amplitude of an effect at a time, of the parameters theta.
  [[nodiscard]] double Amplitude(std::size_t effect, double t_s, const double* theta) const noexcept ARMCMC_NONBLOCKING;
  /// @return false, and nothing changed, when a mode that acts is not known.
  [[nodiscard]] bool Advance(const Input& input, const ShownEstimates& shown,
                             State* state) const noexcept ARMCMC_NONBLOCKING;
  /// The same, or with the pressure held where its mode is not known.
  void AdvanceOrHold(const Input& input, const ShownEstimates& shown, State* state) const noexcept ARMCMC_NONBLOCKING;
  /// The angle one sample on, the pressure moving to next_p.
  void Bend(double next_p, State* state) const noexcept ARMCMC_NONBLOCKING;

  const ModelInfo& info_;
  ActuatorConstants constants_;
  FlowPlan flow_;
  BendMotion motion_;
  std::int64_t last_seq_ = -1, last_run_ = 0;
  State restarted_, free_run_, before_pack_;
  std::array<Input, kBacklogPacks * kMaxPackSamples> backlog_{};
  int backlog_size_ = 0;
};

}  // namespace armcmc
