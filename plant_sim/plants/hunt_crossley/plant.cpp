#include "hunt_crossley/plant.hpp"

#include <cmath>
#include <iterator>
#include <stdexcept>
#include <utility>

#include "armcmc/data_pack_t.hpp"
#include "armcmc/plant_sim/solver.hpp"
#include "hunt_crossley/effects.hpp"

namespace armcmc::plant_sim {
namespace {

enum ContactParameter { kK = 0, kB = 1, kP = 2 };
enum Input { kX = 0, kV = 1 };

// The slave's own mass, damping and stiffness act bare only while no command is sent.
constexpr double kSlaveMass = 1.0, kSlaveDamping = 0.5, kSlaveStiffness = 0.8;
// Fast enough that the solver's error stays below 1e-11 of the amplitude for waves up to 30 rad/s.
constexpr double kMaxStep = 1e-4;
constexpr double kSpeedPerDepth = 5.0;  // 1/s, of a lively press

double ContactForce(double k, double b, double p, double x, double v) noexcept {
  return x >= 0.0 ? std::pow(x, p) * (k + b * v) : 0.0;
}

const std::vector<EffectSpec>& AllContactEffects() {
  static const std::vector<EffectSpec> effects = [] {
    std::vector<EffectSpec> all;
    for (std::vector<EffectSpec> part : {ForceEffects(), FrictionEffects(), MaterialEffects(), SensorEffects()})
      std::move(part.begin(), part.end(), std::back_inserter(all));
    return all;
  }();
  return effects;
}

std::unique_ptr<Plant> MakeHuntCrossley(const PlantSetup& setup) { return std::make_unique<HuntCrossleyPlant>(setup); }

}  // namespace

HuntCrossleyPlant::HuntCrossleyPlant(const PlantSetup& setup)
    : schedule_(setup.schedule),
      offset_(setup.options.Number("master_offset")),
      damping_(setup.options.Number("damping")),
      stiffness_(setup.options.Number("stiffness")),
      start_force_(setup.options.Number("start_force")),
      dt_(setup.sample_interval_s),
      paper_tracking_(setup.options.Choice("tracking") == "paper"),
      substeps_(NumSubsteps(setup.sample_interval_s, kMaxStep)),
      error_(setup.options.Number("error"), setup.seed) {
  const std::vector<double>& amplitude = setup.options.List("master_amplitude");
  const std::vector<double>& omega = setup.options.List("master_omega");
  const std::vector<double>& phase = setup.options.List("master_phase");
  if (omega.size() != amplitude.size() || (!phase.empty() && phase.size() != amplitude.size()))
    throw std::invalid_argument("motion.master_amplitude, master_omega and master_phase must have one entry per wave");
  for (std::size_t i = 0; i < amplitude.size(); ++i)
    waves_.push_back({amplitude[i], omega[i], phase.empty() ? 0.0 : phase[i]});
  if (setup.options.Choice("tracking") == "prescribed") {
    motion_.emplace(setup.options, setup.seed);
    depth_range_ = setup.options.Number("depth");
    speed_range_ = kSpeedPerDepth * depth_range_ * setup.options.Number("pace");
  } else {
    double swing = 0.0, speed = 0.0;
    for (const Wave& wave : waves_) {
      swing += std::abs(wave.amplitude);
      speed += std::abs(wave.amplitude * wave.omega);
    }
    if (offset_ + swing > 0.0) depth_range_ = offset_ + swing;
    if (speed > 0.0) speed_range_ = speed;
  }
}

double HuntCrossleyPlant::MasterPosition(double t) const noexcept {
  double position = offset_;
  for (const Wave& wave : waves_) position += wave.amplitude * std::sin(wave.omega * t + wave.phase);
  return position;
}

double HuntCrossleyPlant::MasterVelocity(double t) const noexcept {
  double velocity = 0.0;
  for (const Wave& wave : waves_) velocity += wave.amplitude * wave.omega * std::cos(wave.omega * t + wave.phase);
  return velocity;
}

HuntCrossleyPlant::State HuntCrossleyPlant::ExactDerivative(double t, const State& state) const noexcept {
  return {state[1], -damping_ * (state[1] - MasterVelocity(t)) - stiffness_ * (state[0] - MasterPosition(t))};
}

HuntCrossleyPlant::State HuntCrossleyPlant::PaperStep(double t, const State& state) const noexcept {
  const double here = MasterPosition(t);
  const double velocity_here = k_ == 0 ? 0.0 : (here - MasterPosition(static_cast<double>(k_ - 1) * dt_)) / dt_;
  const auto derivative = [&](double at, const State& y) -> State {
    const bool first_stage = at <= t;
    if (first_stage && k_ == 1)
      return {y[1], (-start_force_ - kSlaveDamping * y[1] - kSlaveStiffness * y[0]) / kSlaveMass};
    const double position = MasterPosition(at);
    const double velocity = first_stage ? velocity_here : (position - here) / (at - t);
    return {y[1], -damping_ * (y[1] - velocity) - stiffness_ * (y[0] - position)};
  };
  return BogackiShampineStep(derivative, t, state, dt_);
}

void HuntCrossleyPlant::Advance(PlantSample* sample) noexcept {
  if (motion_) {
    const Motion::State at = motion_->At(static_cast<double>(k_ + 1) * dt_);
    state_ = State(at.x, at.v);
  } else if (k_ >= 0) {
    const double t = static_cast<double>(k_) * dt_;
    if (paper_tracking_) {
      state_ = PaperStep(t, state_);
    } else {
      const double h = dt_ / substeps_;
      for (int i = 0; i < substeps_; ++i)
        state_ = BogackiShampineStep([this](double at, const State& y) { return ExactDerivative(at, y); }, t + i * h,
                                     state_, h);
    }
  }
  ++k_;
  sample->t_s = static_cast<double>(k_) * dt_;
  sample->inputs = {state_[0], state_[1], 0.0, 0.0};
  sample->mode = state_[0] >= 0.0 ? kContact : kFree;
  sample->output = Respond(Truth(kContact, sample->t_s), *sample);
}

double HuntCrossleyPlant::Respond(const Theta& theta, const PlantSample& sample) const noexcept {
  return Predict(theta, sample) * error_.Factor(sample.inputs[kX] / depth_range_, sample.inputs[kV] / speed_range_);
}

Theta HuntCrossleyPlant::Truth(int /*mode*/, double t_s) const noexcept {
  return {schedule_.Value(kK, t_s), schedule_.Value(kB, t_s), schedule_.Value(kP, t_s)};
}

double HuntCrossleyPlant::Predict(const Theta& theta, const PlantSample& sample) const noexcept {
  return ContactForce(theta[kK], theta[kB], theta[kP], sample.inputs[kX], sample.inputs[kV]);
}

double HuntCrossleyPlant::Target(const PlantSample& sample) const noexcept { return sample.output; }

const PlantFamily& HuntCrossleyFamily() {
  static const PlantFamily family = [] {
    PlantFamily f;
    f.name = "hunt_crossley";
    f.kind = data_pack_t::PLANT_HUNT_CROSSLEY;
    f.inputs = {{"x", "m"}, {"v", "m/s"}};
    f.output = {"f", "N"};
    f.parameters = {{"K", "N/m^p", 0.0, 1e12, "p"}, {"B", "N s/m^(p+1)", 0.0, 1e12, "p"}, {"p", "-", 0.1, 10.0}};
    f.options = {OptionSpec::Choice("motion", "tracking", {"exact", "paper", "prescribed"}),
                 OptionSpec::Number("motion", "master_offset", 0.6, -100.0, 100.0),
                 OptionSpec::List("motion", "master_amplitude", {1.0}, -100.0, 100.0),
                 OptionSpec::List("motion", "master_omega", {1.0}, 0.0, 1000.0),
                 OptionSpec::List("motion", "master_phase", {}, -10.0, 10.0),
                 OptionSpec::Number("motion", "damping", 3.0, 0.0, 1000.0),
                 OptionSpec::Number("motion", "stiffness", 2.0, 0.0, 1e5),
                 OptionSpec::Number("motion", "start_force", 0.0, -1e3, 1e3)};
    for (OptionSpec& spec : MotionOptions()) f.options.push_back(std::move(spec));
    f.options.push_back(LawErrorOption());
    f.modes = {"contact"};
    f.truth_names = {"K", "B", "p"};
    f.target = {"f_true", "clean_force_mae_mN", 1e3, "noisy_force_l2_N"};
    f.make = MakeHuntCrossley;
    f.makes_contact = true;
    f.effects = AllContactEffects;
    f.make_gap_meter = MakeContactGapMeter;
    f.model_form = ContactModelForm;
    return f;
  }();
  return family;
}

}  // namespace armcmc::plant_sim
