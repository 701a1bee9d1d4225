#include "armcmc/gap/driven_motion.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <memory>
#include <unsupported/Eigen/MatrixFunctions>

#include "armcmc/support/wider_lanes.hpp"

namespace armcmc::gap {
namespace {

using identify::kLanes;
using identify::Lanes;

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

/// Runs side by side on their way.
class DrivenMotion::Step {
 public:
  /// @param runs  Some from the first; the lanes after them are those of the last.
  Step(const DrivenMotion& motion, const std::vector<Force>& forces, const Run* runs, std::size_t count)
      : motion_(motion) {
    const auto run = [&](std::size_t lane) -> const Run& { return runs[std::min(lane, count - 1)]; };
    for (std::size_t l = 0; l < kLanes; ++l) {
      now_.at(FormSignal::kPosition)[l] = run(l).angle;
      now_.at(FormSignal::kVelocity)[l] = run(l).rate;
    }
    for (std::size_t f = 0; f < forces.size(); ++f) {
      std::vector<Lanes> values(forces[f].form->coordinates.size());
      for (std::size_t c = 0; c < values.size(); ++c)
        for (std::size_t l = 0; l < kLanes; ++l) values[c][l] = run(l).values[f][c];
      acting_.push_back({forces[f].form->force(values, motion.dt_), forces[f].gate});
    }
  }

  [[nodiscard]] const Motions& now() const { return now_; }

  /// From row i to the next, of inputs u and times t.
  void Take(const Vector& t, const Vector& u, Eigen::Index i) {
    const double start = motion_.constants_.gain * u[i], end = motion_.constants_.gain * u[i + 1];
    const Ends ends{start, end};
    Lanes added{}, first, half, second, last{};
    if (!acting_.empty()) {
      SetTime(motion_.constants_, t[i], start, &now_);
      for (const Acting& acting : acting_) acting.force->Move(&now_);
      Added(i, &now_, &added);
      // The force e at the end of the step solves e = added(moved(e)): one secant step, exact where it is linear. A
      // stiff one (dry friction that turns within a sample) would swing about without.
      MoveTo(motion_, now_, ends, added, added, &next_);
      SetTime(motion_.constants_, t[i + 1], end, &next_);
      Added(i + 1, &next_, &first);
      TryHalfway(motion_, now_, ends, added, first, &half, &next_);
      Added(i + 1, &next_, &second);
      Solve(added, first, half, second, &last);
    }
    MoveTo(motion_, now_, ends, added, last, &now_);
  }

 private:
  struct Acting {
    std::unique_ptr<MotionForce> force;
    const Vector* gate;
  };
  struct Ends {
    double start, end;  ///< Acceleration by the input.
  };

  ARMCMC_INSIDE static void SetBase(const MotionConstants& c, Motions* m) {
    const Lanes &angle = m->at(FormSignal::kPosition), &rate = m->at(FormSignal::kVelocity);
    const Lanes& drive = m->at(FormSignal::kDrive);
    Lanes& base = m->at(FormSignal::kBase);
    ARMCMC_OVER_LANES
    for (std::size_t l = 0; l < kLanes; ++l) base[l] = drive[l] - c.damping * rate[l] - c.stiffness * angle[l];
  }

  ARMCMC_FOR_WIDER_LANES
  static void SetTime(const MotionConstants& c, double t, double drive, Motions* motions) {
    motions->at(FormSignal::kTime).fill(t);
    motions->at(FormSignal::kDrive).fill(drive);
    SetBase(c, motions);
  }

  void Added(Eigen::Index i, Motions* motions, Lanes* sum) {
    sum->fill(0.0);
    for (const Acting& acting : acting_) {
      const double gate = (*acting.gate)[i];
      if (gate == 0.0) continue;
      Lanes acceleration;
      acting.force->At(motions, &acceleration);
      for (std::size_t l = 0; l < kLanes; ++l) (*sum)[l] += gate * acceleration[l];
    }
  }

  /// Where `from` comes to by inputs and forces that are linear over the step.
  ARMCMC_INSIDE static void Moved(const DrivenMotion& motion, const Motions& from, const Ends& ends,
                                  const Lanes& start_force, const Lanes& end_force, Motions* to) {
    const std::array<double, 4> s = motion.step_;
    const std::array<double, 2> first = motion.first_, second = motion.second_;
    const Lanes &angle = from.at(FormSignal::kPosition), &rate = from.at(FormSignal::kVelocity);
    Lanes &to_angle = to->at(FormSignal::kPosition), &to_rate = to->at(FormSignal::kVelocity);
    ARMCMC_OVER_LANES
    for (std::size_t l = 0; l < kLanes; ++l) {
      const double a = ends.start + start_force[l], b = ends.end + end_force[l], x = angle[l], v = rate[l];
      to_angle[l] = s[0] * x + s[1] * v + first[0] * a + second[0] * b;
      to_rate[l] = s[2] * x + s[3] * v + first[1] * a + second[1] * b;
    }
  }

  ARMCMC_FOR_WIDER_LANES
  static void MoveTo(const DrivenMotion& motion, const Motions& from, const Ends& ends, const Lanes& start_force,
                     const Lanes& end_force, Motions* to) {
    Moved(motion, from, ends, start_force, end_force, to);
  }

  /// To half of the force that `first` adds to the one tried.
  ARMCMC_FOR_WIDER_LANES
  static void TryHalfway(const DrivenMotion& motion, const Motions& from, const Ends& ends, const Lanes& tried,
                         const Lanes& first, Lanes* half, Motions* to) {
    for (std::size_t l = 0; l < kLanes; ++l) (*half)[l] = tried[l] + 0.5 * (first[l] - tried[l]);
    Moved(motion, from, ends, tried, *half, to);
    SetBase(motion.constants_, to);
  }

  /// @param first, second  What is added at the ends that `tried` and `half` lead to.
  ARMCMC_FOR_WIDER_LANES
  static void Solve(const Lanes& tried, const Lanes& first, const Lanes& half, const Lanes& second, Lanes* end) {
    for (std::size_t l = 0; l < kLanes; ++l) {
      const double half_miss = second[l] - half[l], bend = half_miss - (first[l] - tried[l]);
      const double solved = half[l] - half_miss * (half[l] - tried[l]) / bend;
      (*end)[l] = std::fabs(bend) > kTiny ? solved : half[l] + half_miss;
    }
  }

  const DrivenMotion& motion_;
  Motions now_, next_;
  std::vector<Acting> acting_;
};

Matrix DrivenMotion::Runs(const Vector& t, const Vector& input, const std::vector<Force>& forces,
                          const std::vector<Run>& runs, Eigen::Index rows, Vector* rate) const {
  Matrix angles(rows, static_cast<Eigen::Index>(runs.size()));
  if (rate != nullptr) rate->resize(rows);
  for (std::size_t first = 0; first < runs.size(); first += kLanes) {
    const std::size_t count = std::min(kLanes, runs.size() - first);
    Step step(*this, forces, &runs[first], count);
    for (Eigen::Index i = 0; i < rows; ++i) {
      if (i > 0) step.Take(t, input, i - 1);
      for (std::size_t l = 0; l < count; ++l) angles(i, static_cast<Eigen::Index>(first + l)) = step.now().at(FormSignal::kPosition)[l];
      if (rate != nullptr && first == 0) (*rate)[i] = step.now().at(FormSignal::kVelocity)[0];
    }
  }
  return angles;
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
