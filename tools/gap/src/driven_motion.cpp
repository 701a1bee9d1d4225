#include "armcmc/gap/driven_motion.hpp"

#include <Eigen/Dense>
#include <cmath>
#include <cstddef>
#include <unsupported/Eigen/MatrixFunctions>

namespace armcmc::gap {
namespace {

constexpr double kTiny = 1e-300;

}  // namespace

DrivenMotion::DrivenMotion(const MotionConstants& constants, double dt) : constants_(constants), dt_(dt) {
  // (x, x', a, a' dt) with an acceleration a that is linear over the step.
  Eigen::Matrix4d generator = Eigen::Matrix4d::Zero();
  generator(0, 1) = dt;
  generator(1, 0) = -constants.stiffness * dt;
  generator(1, 1) = -constants.damping * dt;
  generator(1, 2) = dt;
  generator(2, 3) = 1.0;
  const Eigen::Matrix4d step = generator.exp();
  step_ = {step(0, 0), step(0, 1), step(1, 0), step(1, 1)};
  second_ = {step(0, 3), step(1, 3)};
  first_ = {step(0, 2) - second_[0], step(1, 2) - second_[1]};
}

/// One run on its way.
struct DrivenMotion::Lane {
  const std::vector<Force>* forces;
  State x;
  double* angle;
  double* rate;  ///< May be null.
  std::vector<std::array<double, kForceMemory>> memory;
  double extra = 0.0, miss = 0.0, half_miss = 0.0;  ///< Of the step that is under way.
};

Motion DrivenMotion::MotionOf(const Vector& t, const Vector& input, const State& state, Eigen::Index i) const {
  const double drive = constants_.gain * input[i];
  return {t[i],       dt_,   state.angle,
          state.rate, drive, drive - constants_.damping * state.rate - constants_.stiffness * state.angle};
}

double DrivenMotion::Added(const Lane& lane, const Vector& t, const Vector& input, const State& state,
                           Eigen::Index i) const {
  double sum = 0.0;
  const Motion motion = MotionOf(t, input, state, i);
  for (std::size_t f = 0; f < lane.forces->size(); ++f) {
    const Force& force = (*lane.forces)[f];
    const double gate = (*force.gate)[i];
    if (gate != 0.0) sum += gate * force.form->force(motion, force.values.data(), lane.memory[f].data());
  }
  return sum;
}

DrivenMotion::State DrivenMotion::Moved(const State& x, double start, double end) const {
  return {step_[0] * x.angle + step_[1] * x.rate + first_[0] * start + second_[0] * end,
          step_[2] * x.angle + step_[3] * x.rate + first_[1] * start + second_[1] * end};
}

void DrivenMotion::Advance(const Vector& t, const Vector& input, Eigen::Index rows, std::vector<Lane>* lanes) const {
  for (Eigen::Index i = 0; i < rows; ++i) {
    for (Lane& lane : *lanes) {
      lane.angle[i] = lane.x.angle;
      if (lane.rate != nullptr) lane.rate[i] = lane.x.rate;
    }
    if (i + 1 == rows) break;
    for (Lane& lane : *lanes)
      for (std::size_t f = 0; f < lane.forces->size(); ++f) {
        const Force& force = (*lane.forces)[f];
        if (force.form->remember)
          force.form->remember(MotionOf(t, input, lane.x, i), force.values.data(), lane.memory[f].data());
      }
    for (Lane& lane : *lanes) lane.extra = lane.forces->empty() ? 0.0 : Added(lane, t, input, lane.x, i);
    const double now = constants_.gain * input[i], next = constants_.gain * input[i + 1];
    // The force e at the end of the step solves e = added(moved(e)): one secant step, exact where it is linear. A stiff
    // one (dry friction that turns within a sample) would swing about without.
    const auto missed = [&](const Lane& lane, double e) {
      return Added(lane, t, input, Moved(lane.x, now + lane.extra, next + e), i + 1) - e;
    };
    for (Lane& lane : *lanes)
      if (!lane.forces->empty()) lane.miss = missed(lane, lane.extra);
    for (Lane& lane : *lanes)
      if (!lane.forces->empty()) lane.half_miss = missed(lane, lane.extra + 0.5 * lane.miss);
    for (Lane& lane : *lanes) {
      double end = 0.0;
      if (!lane.forces->empty()) {
        const double half = lane.extra + 0.5 * lane.miss, bend = lane.half_miss - lane.miss;
        end = std::abs(bend) > kTiny ? half - lane.half_miss * (half - lane.extra) / bend : half + lane.half_miss;
      }
      lane.x = Moved(lane.x, now + lane.extra, next + end);
    }
  }
}

void DrivenMotion::Run(const Vector& t, const Vector& input, State x, const std::vector<Force>& forces,
                       Eigen::Index rows, Vector* angle, Vector* rate) const {
  std::vector<Lane> lanes{
      {&forces, x, angle->data(), rate == nullptr ? nullptr : rate->data(), decltype(Lane::memory)(forces.size())}};
  Advance(t, input, rows, &lanes);
}

void DrivenMotion::RunInterleaved(const Vector& t, const Vector& input, State start,
                                  const std::vector<std::vector<Force>>& forces, Matrix* angles) const {
  angles->resize(t.size(), static_cast<Eigen::Index>(forces.size()));
  std::vector<Lane> lanes;
  for (std::size_t run = 0; run < forces.size(); ++run)
    lanes.push_back({&forces[run], start, angles->col(static_cast<Eigen::Index>(run)).data(), nullptr,
                     decltype(Lane::memory)(forces[run].size())});
  Advance(t, input, t.size(), &lanes);
}

Vector DrivenMotion::Response(const Vector& acceleration) const {
  Vector angle(acceleration.size());
  double at = 0.0, rate = 0.0;
  for (Eigen::Index i = 0; i < acceleration.size(); ++i) {
    angle[i] = at;
    if (i + 1 == acceleration.size()) break;
    const double a = acceleration[i], b = acceleration[i + 1];
    const double next = step_[0] * at + step_[1] * rate + first_[0] * a + second_[0] * b;
    rate = step_[2] * at + step_[3] * rate + first_[1] * a + second_[1] * b;
    at = next;
  }
  return angle;
}

}  // namespace armcmc::gap
