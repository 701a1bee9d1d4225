#include "gap/plants/soft_actuator/actuator_signals.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "armcmc/gap/smoothing.hpp"
#include "armcmc/gap/statistics.hpp"
#include "armcmc/scalar_ops.hpp"
#include "plants/soft_actuator/flow_law.hpp"

namespace armcmc::gap {
namespace {

constexpr Eigen::Index kMinRows = 400;  // ten samples a block
constexpr int kWiden = 8;               // what is smoothed has no corners

}  // namespace

double ValveHead(double opening, double gauge_pressure, const ActuatorConstants& constants) {
  return FlowLaw<ScalarOps>::Head({opening, gauge_pressure, constants.p_supply - constants.p_atm, 0.0},
                                  opening < 0.0 ? 1 : 0);
}

Signals ActuatorSignals(const Recording& recording, int window, const ActuatorConstants& constants) {
  if (recording.rows() < kMinRows)
    throw std::invalid_argument(recording.source + ": holds " + std::to_string(recording.rows()) +
                                " samples; at least " + std::to_string(kMinRows) + " are needed to judge a model");
  Signals s;
  s.dt = recording.dt;
  s.t = recording.t;
  s.origin = s.t[0];
  s.duration = std::max(s.t[s.rows() - 1] - s.t[0], s.dt);
  s.at(Role::kOpening) = recording.Column("u_c") - recording.Column("u_d");
  const Vector gauge = recording.Column("p").array() - constants.p_atm;
  const Vector& rate = recording.Column("pdot");
  // A valve holds its opening from one sample to the next: so does p'.
  Vector travelled = Vector::Zero(s.rows());
  for (Eigen::Index i = 1; i < s.rows(); ++i) travelled[i] = travelled[i - 1] + s.dt * rate[i - 1];
  s.at(Role::kPressure) = travelled + SavitzkyGolay(gauge - travelled, kWiden * window + 1, 0);
  for (const Role role : {Role::kPressure, Role::kOpening})
    s.scale[static_cast<std::size_t>(role)] = std::max(RootMeanSquare(s.at(role)), 1e-300);
  return s;
}

}  // namespace armcmc::gap
