#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>

#include "armcmc/gap/diagnose.hpp"
#include "armcmc/gap/features.hpp"
#include "armcmc/gap/form_file.hpp"
#include "armcmc/gap/smoothing.hpp"
#include "armcmc/gap/statistics.hpp"
#include "gap/plants/soft_actuator/actuator_equation.hpp"
#include "gap/plants/soft_actuator/actuator_signals.hpp"

namespace armcmc::gap {
namespace {

enum FlowBase { kGainFill = 0, kSlopeFill = 1, kGainVent = 2, kSlopeVent = 3, kNumFlowBase = 4 };
constexpr double kTypicalGain = 4e-4;   // sqrt(Pa) s/Pa: the coordinates are of order one for valves of this size
constexpr double kLeastGain = 0.02;     // of the typical one: a valve that passes fifty times more is none
constexpr double kMaxCondition = 1e3;   // of (p', p' p), above which p did not vary enough to tell effects apart
constexpr double kPriorReach = 5.0;     // sd
constexpr double kMinOpenShare = 0.02;  // of the samples

class FlowEquation final : public Equation {
 public:
  explicit FlowEquation(const EstimatorSettings& model) : plant_(model.model), constants_(model.constants) {}

  std::string name() const override { return "flow law"; }
  [[nodiscard]] std::string plant() const override { return plant_; }
  std::string output_name() const override { return "pressure rate"; }
  std::string output_unit() const override { return "Pa/s"; }
  std::vector<std::string> columns() const override { return {"t", "u_c", "u_d", "p", "pdot"}; }
  std::string active_name() const override { return "filling"; }
  std::string passive_name() const override { return "venting"; }

  Signals Prepare(const Recording& recording, int window) const override {
    Signals s = WithOutput(recording, window);
    s.output_scale = RootMeanSquare(s.output);
    s.output_peak = s.output.cwiseAbs().maxCoeff();
    if (!(s.output_scale > 0.0)) throw std::invalid_argument(recording.source + ": p does not move");
    return s;
  }

  Signals PrepareLike(const Recording& recording, int window, const Signals& like) const override {
    Signals s = WithOutput(recording, window);
    s.MeasureLike(like);
    return s;
  }

  void SetPriors(const std::vector<ParameterEstimate>& base, EstimatorSettings* settings) const override {
    // Both valves share a prior: it must hold either, of either sign.
    for (std::size_t i = 0; i < 2; ++i) {
      ParameterSettings& prior = settings->parameters[i];
      prior.sd = std::max({prior.sd, std::abs(base[i].mean), std::abs(base[i + 2].mean)});
      prior.upper = std::max(prior.upper, kPriorReach * prior.sd);
      prior.lower = std::min(prior.lower, -kPriorReach * prior.sd);
    }
  }

  Suitability Check(const Signals& s) const override {
    const Vector& v = s.at(Role::kOpening);
    const Vector& gauge = s.at(Role::kPressure);
    const char* valves[] = {"filling", "venting"};
    for (int valve = 0; valve < 2; ++valve) {
      const Vector open =
          valve == 0 ? Vector((v.array() > 0.0).cast<double>()) : Vector((v.array() < 0.0).cast<double>());
      char text[400];
      if (open.mean() < kMinOpenShare) {
        std::snprintf(text, sizeof(text), "flow law: no effect is named in it: %s is hardly seen in these data",
                      valves[valve]);
        return {false, text, true};
      }
      const double condition = Condition(s, open);
      if (condition < kMaxCondition) continue;
      std::snprintf(text, sizeof(text),
                    "flow law: no effect can be named in it from these data. While %s, p - p_atm stays within %.3g to "
                    "%.3g Pa, so that only g = theta1 + theta2 p_atm can be identified (condition number of the "
                    "regression on theta1 and theta2: %.1e; below %.0e is needed). Excite the pressure by tens of "
                    "kilopascals",
                    valves[valve], Least(gauge, open), -Least(-gauge, open), condition, kMaxCondition);
      return {false, text, true};
    }
    return {};
  }

  std::vector<Coordinate> base(const Signals& s) const override {
    (void)s;
    return {{"g_c", "sqrt(Pa) s/Pa", 0.02, 50.0, 1.0, 2.0, kTypicalGain, false},
            {"theta2_c", "sqrt(Pa) s/Pa^2", -20.0, 20.0, 0.0, 1.0, kTypicalGain / kTypicalPressure, false},
            {"g_d", "sqrt(Pa) s/Pa", -50.0, -0.02, -1.0, 2.0, kTypicalGain, false},
            {"theta2_d", "sqrt(Pa) s/Pa^2", -20.0, 20.0, 0.0, 1.0, kTypicalGain / kTypicalPressure, false}};
  }

  Vector Start(const Signals& s) const override {
    const Vector& v = s.at(Role::kOpening);
    Vector theta{{1.0, 0.0, -1.0, 0.0}};
    for (int valve = 0; valve < 2; ++valve) {
      double cross = 0.0, square = 0.0;
      for (Eigen::Index i = 0; i < s.rows(); ++i) {
        if (v[i] == 0.0 || (v[i] < 0.0) != (valve == 1)) continue;
        cross += std::abs(v[i]) * ValveHead(v[i], s.at(Role::kPressure)[i], constants_) * s.output[i];
        square += s.output[i] * s.output[i];
      }
      if (square > 0.0) theta[2 * valve] = cross / square / kTypicalGain;
    }
    return theta;
  }

  void Law(const Signals& s, const double* theta, const LawInput& input, Prediction* out) const override {
    const Vector& opening = s.at(Role::kOpening);
    const Vector& pressure = s.at(Role::kPressure);
    out->y = Vector::Zero(s.rows());
    Vector by_shift = Vector::Zero(s.rows()), by_drive = Vector::Zero(s.rows());
    for (Eigen::Index i = 0; i < s.rows(); ++i) {
      const double v = opening[i] + (input.drive.size() > 0 ? input.drive[i] : 0.0);
      const double gauge = pressure[i] - (input.shift.size() > 0 ? input.shift[i] : 0.0);
      const int first = v < 0.0 ? kGainVent : kGainFill;
      const double sign = v < 0.0 ? -1.0 : 1.0;
      const double share = gauge / kTypicalPressure;
      // The gain keeps its sign: a fill valve raises the pressure at every pressure.
      const double raw = sign * (theta[first] + theta[first + 1] * share);
      const double gain = sign * kTypicalGain * std::max(raw, kLeastGain);
      const double head = ValveHead(v, gauge, constants_);
      const double rate = std::abs(v) * head / gain;
      out->y[i] = rate;
      by_drive[i] = sign * head / gain;
      const double head_slope = -sign * 0.5 / std::max(std::abs(head), 1e-3);
      by_shift[i] = -std::abs(v) * head_slope / gain;
      if (raw <= kLeastGain) continue;
      out->jacobian(i, first) = -rate * kTypicalGain / gain;
      out->jacobian(i, first + 1) = -rate * kTypicalGain * share / gain;
      by_shift[i] += rate / gain * kTypicalGain * theta[first + 1] / kTypicalPressure;
    }
    out->elastic = Vector::Zero(s.rows());
    for (const LawInput::Slope& slope : input.shift_slopes)
      out->jacobian.col(slope.coordinate) += by_shift.cwiseProduct(slope.rows);
    for (const LawInput::Slope& slope : input.drive_slopes)
      out->jacobian.col(slope.coordinate) += by_drive.cwiseProduct(slope.rows);
  }

  std::vector<ParameterEstimate> Report(const Signals& s, const Vector& theta,
                                        const Matrix& covariance) const override {
    const std::vector<Coordinate> coordinates = base(s);
    std::vector<ParameterEstimate> report;
    for (Eigen::Index i = 0; i < kNumFlowBase; ++i) {
      const Coordinate& c = coordinates[static_cast<std::size_t>(i)];
      report.push_back({c.name, c.unit, c.Value(theta[i]), c.unit_size * std::sqrt(std::max(covariance(i, i), 0.0))});
    }
    return report;
  }

  std::vector<EffectForm> Catalogue(const Signals& s) const override {
    return FormsFor("valve_flow", s, {{"p_supply", constants_.p_supply}, {"p_atm", constants_.p_atm}});
  }
  std::vector<FeatureGroup> Groups(const Signals& s, const Vector& predicted) const override;

  std::vector<PlotFeature> PlotFeatures(const Signals& s) const override {
    return {{"pressure p - p_atm, Pa", s.at(Role::kPressure), "(p - p_atm)"},
            {"opening, fill positive, vent negative", s.at(Role::kOpening), "u"},
            {"time, s", s.t, "t"}};
  }

  std::vector<SplitVariable> SplitVariables(const Signals& s) const override {
    const Vector size = s.at(Role::kOpening).cwiseAbs();
    return {{s.active, "while venting", "while filling", {0.5}},
            {s.at(Role::kPressure), "below p - p_atm = %s Pa", "above p - p_atm = %s Pa",
             SplitQuantiles(s.at(Role::kPressure))},
            {size, "opening below %s", "opening above %s", SplitQuantiles(size)},
            {s.t, "before t = %s s", "after t = %s s", SplitQuantiles(s.t)}};
  }

  Experiment Separate(const Analysis& analysis, const std::vector<CandidatePtr>& candidates) const override;

 private:
  static constexpr double kTypicalPressure = 5e4;  // Pa

  Signals WithOutput(const Recording& recording, int window) const {
    Signals s = ActuatorSignals(recording, window, constants_);
    s.output = recording.Column("pdot");
    s.active = (s.at(Role::kOpening).array() > 0.0).cast<double>();
    return s;
  }

  static double Least(const Vector& series, const Vector& mask) {
    double least = HUGE_VAL;
    for (Eigen::Index i = 0; i < series.size(); ++i)
      if (mask[i] != 0.0) least = std::min(least, series[i]);
    return least;
  }

  /// Of the columns p' and p' p, scaled to unit length.
  double Condition(const Signals& s, const Vector& open) const {
    const Vector rate = s.output.cwiseProduct(open);
    const Vector product = rate.array() * (s.at(Role::kPressure).array() + constants_.p_atm);
    const double cosine = std::abs(rate.dot(product)) / (rate.norm() * product.norm() + 1e-300);
    return std::sqrt((1.0 + cosine) / std::max(1.0 - cosine, 1e-15));
  }

  std::string plant_;
  ActuatorConstants constants_;
};

std::vector<FeatureGroup> FlowEquation::Groups(const Signals& s, const Vector& predicted) const {
  const Vector& v = s.at(Role::kOpening);
  const Vector& gauge = s.at(Role::kPressure);
  const Vector all = Vector::Ones(s.rows());
  const Vector vent = 1.0 - s.active.array();
  const Vector time = s.Elapsed();
  Vector flow(s.rows());  // p' by opening, but for a gain
  for (Eigen::Index i = 0; i < s.rows(); ++i) flow[i] = ValveHead(v[i], gauge[i], constants_);
  const Vector size = v.cwiseAbs();
  std::vector<FeatureGroup> groups;
  const Matrix pressure = HatFunctions(gauge, QuantileKnots(gauge, all, 7));
  groups.push_back({"pressure", pressure});
  groups.push_back({"pressure while filling", Gated(pressure, s.active)});
  groups.push_back({"pressure x rate", JoinColumns(Gated(pressure, s.active.cwiseProduct(predicted)),
                                                   Gated(pressure, vent.cwiseProduct(predicted)))});
  const Matrix opening = HatFunctions(size, QuantileKnots(size, all, 9));
  groups.push_back(
      {"opening", JoinColumns(Gated(opening, s.active.cwiseProduct(flow)), Gated(opening, vent.cwiseProduct(flow)))});
  Matrix changes(s.rows(), 8);
  Eigen::Index at = 0;
  for (const double samples : {2.0, 6.0, 20.0, 60.0}) {
    const Vector missing = (Leaky(v, samples) - v).cwiseProduct(flow);
    changes.col(at++) = missing.cwiseProduct(s.active);
    changes.col(at++) = missing.cwiseProduct(vent);
  }
  groups.push_back({"change of opening", changes});
  Matrix rates(s.rows(), 4);
  rates.col(0) = SavitzkyGolay(predicted, 3, 1);
  for (int i = 0; i < 3; ++i) rates.col(i + 1) = predicted - Leaky(predicted, 4.0 * std::pow(6.0, i));
  groups.push_back({"change of the rate", rates});
  groups.push_back({"filling or venting", JoinColumns(s.active, vent)});
  groups.push_back({"time", HatFunctions(time, EvenKnots(9))});
  groups.push_back(
      {"time x rate", JoinColumns(Gated(HatFunctions(time, EvenKnots(4)), predicted.cwiseProduct(s.active)),
                                  Gated(HatFunctions(time, EvenKnots(4)), predicted.cwiseProduct(vent)))});
  Matrix memory(s.rows(), 3);
  for (int i = 0; i < 3; ++i) memory.col(i) = gauge - Leaky(gauge, 30.0 * std::pow(6.0, i));
  groups.push_back({"memory of the pressure", memory});
  return groups;
}

Experiment FlowEquation::Separate(const Analysis& analysis, const std::vector<CandidatePtr>& candidates) const {
  return ActuatorExperiment(plant_, analysis.signals, constants_, candidates);
}

}  // namespace

std::unique_ptr<Equation> MakeFlowEquation(const std::string& model) {
  return std::make_unique<FlowEquation>(BuiltinSettings(model));
}

}  // namespace armcmc::gap
