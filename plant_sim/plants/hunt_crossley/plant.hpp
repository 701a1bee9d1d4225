#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "armcmc/plant_sim/law_error.hpp"
#include "armcmc/plant_sim/motion.hpp"
#include "armcmc/plant_sim/plant.hpp"

namespace armcmc::plant_sim {

/// Needle in contact with soft material, after Hunt and Crossley (1975):
///
///   f = x^p (K + B v)   for x >= 0, else 0            N, with x in m, v in m/s
///   x'' = -d (x' - x_m') - s (x - x_m)                slave behind the master x_m, contact force cancelled
///   x_m = offset + sum_i amplitude_i sin(omega_i t + phase_i)
///
/// or, with tracking = "prescribed", x and x' of a motion program (see Motion) in place of slave and master.
///
/// Motion does not depend on the force, so K, B, p may change at any time. With an `error` of the law the force is this
/// times a LawError of depth and speed.
///
/// With tracking = "paper" the loop is sampled as in the simulation behind the paper's traces: one solver step
/// per T, the master's velocity a difference quotient from the last sample (none yet at t = 0), and no command
/// at the second sample, where `start_force` (the force measured there) pushes the slave uncancelled.
class HuntCrossleyPlant final : public Plant {
 public:
  explicit HuntCrossleyPlant(const PlantSetup& setup);

  void Advance(PlantSample* sample) noexcept override;
  [[nodiscard]] Theta Truth(int mode, double t_s) const noexcept override;
  [[nodiscard]] double Predict(const Theta& theta, const PlantSample& sample) const noexcept override;
  [[nodiscard]] double Respond(const Theta& theta, const PlantSample& sample) const noexcept override;
  [[nodiscard]] double Target(const PlantSample& sample) const noexcept override;

  static constexpr int kContact = 0, kFree = 1;

 private:
  using State = Eigen::Vector2d;  ///< x, x'.
  struct Wave {
    double amplitude, omega, phase;
  };

  [[nodiscard]] double MasterPosition(double t) const noexcept;
  [[nodiscard]] double MasterVelocity(double t) const noexcept;
  [[nodiscard]] State ExactDerivative(double t, const State& state) const noexcept;
  [[nodiscard]] State PaperStep(double t, const State& state) const noexcept;

  Schedule schedule_;
  std::vector<Wave> waves_;
  double offset_, damping_, stiffness_, start_force_, dt_;
  bool paper_tracking_;
  int substeps_;
  std::optional<Motion> motion_;  ///< None: a slave follows a master.
  LawError error_;
  double depth_range_ = 1.0, speed_range_ = 1.0;  ///< m, m/s, of the motion.
  State state_ = State::Zero();
  long long k_ = -1;  ///< Index of the last sample.
};

[[nodiscard]] const PlantFamily& HuntCrossleyFamily();

}  // namespace armcmc::plant_sim
