#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>

#include "armcmc/gap/diagnose.hpp"
#include "armcmc/gap/driven_motion.hpp"
#include "armcmc/gap/features.hpp"
#include "armcmc/gap/form_file.hpp"
#include "armcmc/gap/smoothing.hpp"
#include "armcmc/gap/statistics.hpp"
#include "gap/plants/soft_actuator/actuator_equation.hpp"
#include "gap/plants/soft_actuator/actuator_signals.hpp"

namespace armcmc::gap {
namespace {

constexpr double kStep = 1e-4;        // of a coordinate of order one
constexpr double kSettling_s = 0.1;   // in which a state at the start is felt,
constexpr double kForgotten_s = 0.5;  // and after which it is forgotten
constexpr int kStartCoordinates = 2;
constexpr int kWidenAngle = 4;        // the error of the angle has no corners
constexpr double kNegligible = 1e-4;  // error over angle, below which it is rounding, not physics

MotionConstants LinearPart(const ActuatorConstants& constants) { return {constants.q1, constants.q2, constants.q3}; }

class BendEquation final : public Equation {
 public:
  explicit BendEquation(const EstimatorSettings& model) : plant_(model.model), constants_(model.constants) {}

  std::string name() const override { return "bend equation"; }
  [[nodiscard]] std::string plant() const override { return plant_; }
  std::string output_name() const override { return "angle"; }
  std::string output_unit() const override { return "rad"; }
  std::vector<std::string> columns() const override { return {"t", "u_c", "u_d", "p", "pdot", "alpha"}; }
  std::string active_name() const override { return "bending"; }
  std::string passive_name() const override { return "straightening"; }

  Signals Prepare(const Recording& recording, int window) const override {
    Signals s = WithMotion(recording, window);
    for (const Role role : {Role::kPosition, Role::kVelocity, Role::kAcceleration}) {
      s.scale[static_cast<std::size_t>(role)] = RootMeanSquare(s.at(role));
      if (!(s.scale_of(role) > 0.0)) throw std::invalid_argument(recording.source + ": alpha does not move");
    }
    s.output_scale = s.scale_of(Role::kPosition);
    s.output_peak = s.output.cwiseAbs().maxCoeff();
    return s;
  }

  Signals PrepareLike(const Recording& recording, int window, const Signals& like) const override {
    Signals s = WithMotion(recording, window);
    s.MeasureLike(like);
    return s;
  }

  // The estimator adds effects to a contact law only.
  bool online() const override { return false; }

  Suitability Check(const Signals& s) const override {
    const DrivenMotion simulation(LinearPart(constants_), s.dt);
    const Vector angle = simulation.Runs(s.t, s.at(Role::kPressure), {}, {StartOf(s, simulation)}, s.rows());
    const double error = RootMeanSquare(s.output - angle);
    if (error > kNegligible * s.output_scale) return {};
    char text[200];
    std::snprintf(text, sizeof(text),
                  "bend equation: predicts alpha to %.1e of its rms without any effect: nothing is missing in it",
                  error / s.output_scale);
    return {false, text, false};
  }

  // The state at the first row, from where StartOf() puts it: an effect that acts from the beginning moves it. Only the
  // first rows know it, so scores take it as known.
  std::vector<Coordinate> base(const Signals& s) const override {
    constexpr double kMost = 10.0;
    return {{"start_angle", "rad", -kMost, kMost, 0.0, 1.0, s.scale_of(Role::kPosition), false, true},
            {"start_rate", "rad/s", -kMost, kMost, 0.0, 1.0, s.scale_of(Role::kVelocity), false, true}};
  }

  Vector Start(const Signals& s) const override {
    (void)s;
    return Vector::Zero(kStartCoordinates);
  }

  void Law(const Signals& s, const double* theta, const LawInput& input, Prediction* out) const override {
    const DrivenMotion simulation(LinearPart(constants_), s.dt);
    std::vector<DrivenMotion::Force> forces;
    // One run as it is, then one for every slope.
    std::vector<DrivenMotion::Run> runs{StartOf(s, simulation)};
    runs[0].angle += theta[0] * s.scale_of(Role::kPosition);
    runs[0].rate += theta[1] * s.scale_of(Role::kVelocity);
    for (const LawInput::Force& force : input.forces) {
      forces.push_back({force.form, &force.gate});
      runs[0].values.push_back(Values(force));
    }
    std::vector<int> columns;
    const auto add = [&](int column) -> DrivenMotion::Run& {
      columns.push_back(column);
      runs.push_back(runs[0]);
      return runs.back();
    };
    if (out->wanted.Has(0)) add(0).angle += kStep * s.scale_of(Role::kPosition);
    if (out->wanted.Has(1)) add(1).rate += kStep * s.scale_of(Role::kVelocity);
    for (std::size_t f = 0; f < forces.size(); ++f) {
      const EffectForm& form = *forces[f].form;
      for (std::size_t c = 0; c < form.coordinates.size(); ++c)
        if (const int column = input.forces[f].first + static_cast<int>(c); out->wanted.Has(column))
          add(column).values[f][c] = form.coordinates[c].Value(input.forces[f].coordinates[c] + kStep);
    }
    const Matrix angles = simulation.Runs(s.t, s.at(Role::kPressure), forces, runs, s.rows());
    out->y = angles.col(0);
    out->elastic = Vector::Zero(s.rows());
    for (std::size_t i = 0; i < columns.size(); ++i)
      out->jacobian.col(columns[i]) = (angles.col(static_cast<Eigen::Index>(i) + 1) - out->y) / kStep;
    const auto felt = std::min<Eigen::Index>(s.rows(), static_cast<Eigen::Index>(kForgotten_s / s.dt) + 2);
    for (int column = 0; column < kStartCoordinates; ++column)
      if (out->wanted.Has(column)) out->jacobian.col(column).tail(s.rows() - felt).setZero();
  }

  std::vector<ParameterEstimate> Report(const Signals& s, const Vector& theta,
                                        const Matrix& covariance) const override {
    (void)s;
    (void)theta;
    (void)covariance;
    return {{"q1", "rad/(s^2 Pa)", constants_.q1, 0.0},
            {"q2", "1/s", constants_.q2, 0.0},
            {"q3", "1/s^2", constants_.q3, 0.0}};
  }

  std::vector<EffectForm> Catalogue(const Signals& s) const override {
    return FormsFor("bending", s, {{"q1", constants_.q1}, {"q2", constants_.q2}, {"q3", constants_.q3}});
  }
  std::vector<FeatureGroup> Groups(const Signals& s, const Vector& predicted) const override;

  std::vector<PlotFeature> PlotFeatures(const Signals& s) const override {
    return {{"angle alpha, rad", s.at(Role::kPosition), "alpha"},
            {"rate alpha', rad/s", s.at(Role::kVelocity), "alpha'"},
            {"pressure p - p_atm, Pa", s.at(Role::kPressure), "(p - p_atm)"},
            {"time, s", s.t, "t"}};
  }

  std::vector<SplitVariable> SplitVariables(const Signals& s) const override {
    const Vector speed = s.at(Role::kVelocity).cwiseAbs();
    return {
        {s.active, "while straightening", "while bending", {0.5}},
        {s.at(Role::kPosition), "below alpha = %s rad", "above alpha = %s rad", SplitQuantiles(s.at(Role::kPosition))},
        {speed, "slower than %s rad/s", "faster than %s rad/s", SplitQuantiles(speed)},
        {s.t, "before t = %s s", "after t = %s s", SplitQuantiles(s.t)}};
  }

  Experiment Separate(const Analysis& analysis, const std::vector<CandidatePtr>& candidates) const override;

 private:
  static std::vector<double> Values(const LawInput::Force& force) {
    std::vector<double> values;
    for (std::size_t c = 0; c < force.form->coordinates.size(); ++c)
      values.push_back(force.form->coordinates[c].Value(force.coordinates[c]));
    return values;
  }

  /// The state at the first row, by least squares over the time in which it is felt.
  DrivenMotion::Run StartOf(const Signals& s, const DrivenMotion& simulation) const {
    const auto rows = std::min<Eigen::Index>(s.rows(), static_cast<Eigen::Index>(kSettling_s / s.dt) + 2);
    const Matrix runs =
        simulation.Runs(s.t, s.at(Role::kPressure), {}, {{0.0, 0.0, {}}, {1.0, 0.0, {}}, {0.0, 1.0, {}}}, rows);
    const Matrix columns = runs.rightCols(2).colwise() - runs.col(0);
    const Vector state = columns.colPivHouseholderQr().solve(s.output.head(rows) - runs.col(0));
    return {state[0], state[1], {}};
  }

  /// How much of a smoothed error is put into the motion. It holds noise of the very samples that the flexible model
  /// explains from this motion, so none of it where it is not large: a noise of variance s^2 weighs as much as an error
  /// of that mean square.
  static double ShareOfMotion(const Vector& error, const Vector& slow, int window) {
    constexpr double kCubic = 2.25;  // variance of smoothed white noise: 9 / (4 window)
    const Eigen::Index n = error.size();
    const double noise = 0.5 * (error.tail(n - 1) - error.head(n - 1)).squaredNorm() / static_cast<double>(n - 1);
    const double motion = std::max(slow.squaredNorm() / static_cast<double>(n) - kCubic / window * noise, 0.0);
    return motion > 0.0 ? motion / (motion + noise) : 0.0;
  }

  Signals WithMotion(const Recording& recording, int window) const {
    Signals s = ActuatorSignals(recording, window, constants_);
    s.output = recording.Column("alpha");
    // The simulation follows fast motion; its error, which is slow, is smoothed widely.
    const DrivenMotion simulation(LinearPart(constants_), s.dt);
    Vector rate;
    const Vector angle = simulation.Runs(s.t, s.at(Role::kPressure), {}, {StartOf(s, simulation)}, s.rows(), &rate);
    const int wide = kWidenAngle * window + 1;
    const Vector error = s.output - angle;
    const Vector slow = SavitzkyGolay(error, wide, 0);
    const double share = ShareOfMotion(error, slow, wide);
    const Vector error_rate = share / s.dt * SavitzkyGolay(error, wide, 1);
    s.at(Role::kPosition) = angle + share * slow;
    s.at(Role::kVelocity) = rate + error_rate;
    s.at(Role::kAcceleration) = constants_.q1 * s.at(Role::kPressure) - constants_.q2 * rate - constants_.q3 * angle +
                                SavitzkyGolay(error_rate, wide, 1) / s.dt;
    s.active = (s.at(Role::kVelocity).array() > 0.0).cast<double>();
    return s;
  }

  std::string plant_;
  ActuatorConstants constants_;
};

std::vector<FeatureGroup> BendEquation::Groups(const Signals& s, const Vector& predicted) const {
  const DrivenMotion simulation(LinearPart(constants_), s.dt);
  // What acts as an acceleration shows as its response.
  const auto felt = [&](Matrix columns) {
    for (Eigen::Index c = 0; c < columns.cols(); ++c)
      columns.col(c) = constants_.q3 * simulation.Response(columns.col(c));
    return columns;
  };
  const Vector& angle = s.at(Role::kPosition);
  const Vector& rate = s.at(Role::kVelocity);
  const Vector& gauge = s.at(Role::kPressure);
  const Vector all = Vector::Ones(s.rows());
  const Vector time = s.Elapsed();
  const Vector direction = (rate / (0.03 * s.scale_of(Role::kVelocity))).array().tanh();
  std::vector<FeatureGroup> groups;
  groups.push_back({"angle", felt(HatFunctions(angle, QuantileKnots(angle, all, 8)))});
  groups.push_back({"rate", felt(HatFunctions(rate, QuantileKnots(rate, all, 9)))});
  groups.push_back({"direction of motion", felt(Gated(HatFunctions(angle, QuantileKnots(angle, all, 4)), direction))});
  groups.push_back({"acceleration",
                    felt(HatFunctions(s.at(Role::kAcceleration), QuantileKnots(s.at(Role::kAcceleration), all, 6)))});
  groups.push_back({"time", HatFunctions(time, EvenKnots(9))});
  groups.push_back({"time x angle", Gated(HatFunctions(time, EvenKnots(4)), predicted)});
  groups.push_back({"time x acceleration", felt(Gated(HatFunctions(time, EvenKnots(6)), s.at(Role::kAcceleration)))});
  groups.push_back({"angle x rate", felt(Products(HatFunctions(angle, QuantileKnots(angle, all, 3)),
                                                  HatFunctions(rate, QuantileKnots(rate, all, 4))))});
  Matrix memory(s.rows(), 3);
  for (int i = 0; i < 3; ++i) memory.col(i) = gauge - Leaky(gauge, 30.0 * std::pow(6.0, i));
  groups.push_back({"memory of the pressure", felt(memory)});
  Matrix reversals(s.rows(), 3);
  for (int i = 0; i < 3; ++i) reversals.col(i) = Bristle(rate, 0.02 * std::pow(4.0, i), s.dt);
  groups.push_back({"angle since reversal", felt(reversals)});
  Matrix change(s.rows(), 3);
  change.col(0) = SavitzkyGolay(predicted, 3, 1);
  change.col(1) = SavitzkyGolay(Vector(change.col(0)), 3, 1);
  change.col(2) = predicted - Leaky(predicted, 20.0);
  groups.push_back({"change of angle", change});
  return groups;
}

Experiment BendEquation::Separate(const Analysis& analysis, const std::vector<CandidatePtr>& candidates) const {
  return ActuatorExperiment(plant_, analysis.signals, constants_, candidates);
}

}  // namespace

std::unique_ptr<Equation> MakeBendEquation(const std::string& model) {
  return std::make_unique<BendEquation>(BuiltinSettings(model));
}

}  // namespace armcmc::gap
