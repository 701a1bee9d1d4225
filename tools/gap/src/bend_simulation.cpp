#include "armcmc/gap/bend_simulation.hpp"

#include <Eigen/Dense>
#include <cmath>
#include <cstddef>
#include <unsupported/Eigen/MatrixFunctions>

namespace armcmc::gap {
namespace {

constexpr double kTiny = 1e-300;

}  // namespace

BendSimulation::BendSimulation(const PlantConstants& constants, double dt) : constants_(constants), dt_(dt) {
  // (alpha, alpha', a, a' dt) with an acceleration a that is linear over the step.
  Eigen::Matrix4d generator = Eigen::Matrix4d::Zero();
  generator(0, 1) = dt;
  generator(1, 0) = -constants.q3 * dt;
  generator(1, 1) = -constants.q2 * dt;
  generator(1, 2) = dt;
  generator(2, 3) = 1.0;
  const Eigen::Matrix4d step = generator.exp();
  step_ = {step(0, 0), step(0, 1), step(1, 0), step(1, 1)};
  second_ = {step(0, 3), step(1, 3)};
  first_ = {step(0, 2) - second_[0], step(1, 2) - second_[1]};
}

void BendSimulation::Run(const Vector& t, const Vector& gauge, State x, const std::vector<Force>& forces,
                         Eigen::Index rows, Vector* angle, Vector* rate) const {
  std::vector<std::array<double, kForceMemory>> memory(forces.size());
  const auto at = [&](const State& state, Eigen::Index i) {
    const double drive = constants_.q1 * gauge[i];
    return Motion{t[i],       dt_,   state.angle,
                  state.rate, drive, drive - constants_.q2 * state.rate - constants_.q3 * state.angle};
  };
  const auto added = [&](const State& state, Eigen::Index i) {
    double sum = 0.0;
    const Motion motion = at(state, i);
    for (std::size_t f = 0; f < forces.size(); ++f)
      if ((*forces[f].gate)[i] != 0.0)
        sum += (*forces[f].gate)[i] * forces[f].form->force(motion, forces[f].values.data(), memory[f].data());
    return sum;
  };
  for (Eigen::Index i = 0; i < rows; ++i) {
    (*angle)[i] = x.angle;
    if (rate != nullptr) (*rate)[i] = x.rate;
    if (i + 1 == rows) break;
    for (std::size_t f = 0; f < forces.size(); ++f)
      if (forces[f].form->remember) forces[f].form->remember(at(x, i), forces[f].values.data(), memory[f].data());
    const double extra = forces.empty() ? 0.0 : added(x, i);
    const double start = constants_.q1 * gauge[i] + extra;
    const auto moved = [&](double end) {
      return State{step_[0] * x.angle + step_[1] * x.rate + first_[0] * start + second_[0] * end,
                   step_[2] * x.angle + step_[3] * x.rate + first_[1] * start + second_[1] * end};
    };
    if (forces.empty()) {
      x = moved(constants_.q1 * gauge[i + 1]);
      continue;
    }
    // The force e at the end of the step solves e = added(moved(e)): one secant step, exact where it is linear. A stiff
    // one (dry friction that turns within a sample) would swing about without.
    const auto missed = [&](double e) { return added(moved(constants_.q1 * gauge[i + 1] + e), i + 1) - e; };
    const double miss = missed(extra), half = extra + 0.5 * miss, half_miss = missed(half);
    const double bend = half_miss - miss;
    const double end = std::abs(bend) > kTiny ? half - half_miss * (half - extra) / bend : half + half_miss;
    x = moved(constants_.q1 * gauge[i + 1] + end);
  }
}

Vector BendSimulation::Response(const Vector& acceleration) const {
  Vector angle(acceleration.size());
  double alpha = 0.0, rate = 0.0;
  for (Eigen::Index i = 0; i < acceleration.size(); ++i) {
    angle[i] = alpha;
    if (i + 1 == acceleration.size()) break;
    const double a = acceleration[i], b = acceleration[i + 1];
    const double next = step_[0] * alpha + step_[1] * rate + first_[0] * a + second_[0] * b;
    rate = step_[2] * alpha + step_[3] * rate + first_[1] * a + second_[1] * b;
    alpha = next;
  }
  return angle;
}

}  // namespace armcmc::gap
