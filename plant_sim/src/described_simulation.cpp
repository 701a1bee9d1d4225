#include "armcmc/plant_sim/described_simulation.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

namespace armcmc::plant_sim {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

std::vector<double> Moved(const std::vector<double>& from, const std::vector<double>& rate, double by) {
  std::vector<double> to = from;
  for (std::size_t i = 0; i < to.size(); ++i) to[i] += by * rate[i];
  return to;
}

}  // namespace

void DescribedSimulation::MoveInputs(std::vector<double>* signals, std::vector<double>* seen) {
  signals->assign(plant_.signals.size(), kUnknown);
  std::vector<expression::Jet> jets;
  for (InputSignal& input : inputs_) jets.push_back(input.At(t()));
  for (std::size_t s = 0; s < sources_.size(); ++s)
    if (sources_[s].input >= 0)
      (*signals)[s] = jets[static_cast<std::size_t>(sources_[s].input)][static_cast<std::size_t>(sources_[s].order)];
  *seen = *signals;
  // All of them see the signals as they are recorded, so that their order does not matter.
  std::vector<double> frame = frame_;
  std::copy(signals->begin(), signals->end(), frame.begin());
  frame.back() = t();
  for (Hidden& hidden : hidden_)
    if (hidden.slot == HiddenTerm::Slot::kInput)
      (*seen)[static_cast<std::size_t>(hidden.of)] = hidden.value.Evaluate(frame, index_ == 0 ? 0.0 : scenario_.dt);
}

void DescribedSimulation::PlaceStates(const std::vector<double>& state, std::vector<double>* frame) const {
  const std::size_t first = plant_.signals.size() + plant_.constants.size() + plant_.parameters.size();
  std::copy(state.begin(), state.end(), frame->begin() + static_cast<std::ptrdiff_t>(first));
  for (std::size_t s = 0; s < sources_.size(); ++s)
    if (sources_[s].state >= 0 && sources_[s].order == 0)
      (*frame)[s] = state[static_cast<std::size_t>(sources_[s].state)];
}

void DescribedSimulation::PlaceParameters(int mode, std::vector<double>* frame) const {
  const bool acts = mode >= 0 && !plant_.modes[static_cast<std::size_t>(mode)].passive;
  const auto column = static_cast<std::size_t>(acts ? mode : last_active_);
  const std::size_t first = plant_.signals.size() + plant_.constants.size();
  for (std::size_t p = 0; p < truth_.size(); ++p) (*frame)[first + p] = truth_[p][column];
}

int DescribedSimulation::ModeOf(const std::vector<double>& frame, double dt, bool with_memory) {
  int mode = -1;
  for (std::size_t m = 0; m < whens_.size(); ++m) {
    // Then no parameter differs from mode to mode, and the mode of the last sample does as well.
    if (whens_[m].has_memory() && !with_memory) return mode_;
    const bool holds = whens_[m].Evaluate(frame, dt) != 0.0;
    if (holds && mode < 0) mode = static_cast<int>(m);
  }
  return mode;
}

void DescribedSimulation::FollowSignals(double dt) {
  std::vector<double> frame = frame_;
  std::copy(seen_.begin(), seen_.end(), frame.begin());
  frame.back() = t();
  PlaceParameters(last_active_, &frame);
  for (Expression& rate : rates_)
    if (rate.has_memory()) static_cast<void>(rate.Evaluate(frame, dt));
}

std::vector<double> DescribedSimulation::Rates(std::vector<double> frame, const std::vector<double>& state,
                                               double part) {
  const std::size_t first_let = names_.size() - 1 - lets_.size();
  const auto lets = [&](bool late) {
    for (std::size_t l = 0; l < lets_.size(); ++l)
      if (late_[l] == late && !remembers_[l]) frame[first_let + l] = lets_[l].EvaluateNow(frame);
  };
  PlaceStates(state, &frame);
  PlaceParameters(last_active_, &frame);
  lets(false);
  PlaceParameters(ModeOf(frame, 0.0, false), &frame);
  lets(true);
  std::vector<double> rates;
  for (Expression& rate : rates_)
    rates.push_back(rate.has_memory() ? rate.EvaluateBetween(frame, part) : rate.EvaluateNow(frame));
  for (Hidden& hidden : hidden_)
    if (hidden.slot == HiddenTerm::Slot::kRate)
      rates[static_cast<std::size_t>(hidden.of)] += hidden.value.EvaluateNow(frame);
  return rates;
}

void DescribedSimulation::Begin() {
  std::vector<double> frame = frame_;
  std::copy(seen_.begin(), seen_.end(), frame.begin());
  for (std::size_t s = 0; s < sources_.size(); ++s)
    if (sources_[s].input < 0) frame[s] = 0.0;
  for (const auto& [name, value] : scenario_.start)
    if (const int s = plant_.SignalAt(name); s >= 0) frame[static_cast<std::size_t>(s)] = value;
  const std::size_t first_let = names_.size() - 1 - lets_.size();
  for (int round = 0; round < 2; ++round) {
    PlaceParameters(round == 0 ? last_active_ : ModeOf(frame, 0.0, false), &frame);
    for (std::size_t l = 0; l < lets_.size(); ++l)
      if (!remembers_[l]) frame[first_let + l] = lets_[l].EvaluateNow(frame);
  }
  for (std::size_t x = 0; x < starts_.size(); ++x) {
    const auto given = scenario_.start.find(plant_.states[x].name);
    state_.push_back(given != scenario_.start.end() ? given->second : starts_[x].EvaluateNow(frame));
  }
}

double DescribedSimulation::Between(std::size_t signal, double from, double to, double part, double t) {
  const std::string& between = plant_.signals[signal].between;
  if (between == "held") return from;
  const bool hidden = std::any_of(hidden_.begin(), hidden_.end(), [signal](const Hidden& h) {
    return h.slot == HiddenTerm::Slot::kInput && static_cast<std::size_t>(h.of) == signal;
  });
  const auto& [input, state, order] = sources_[signal];
  if (between != "smooth" || hidden || input < 0) return from + part * (to - from);
  return inputs_[static_cast<std::size_t>(input)].At(t)[static_cast<std::size_t>(order)];
}

void DescribedSimulation::Advance(const std::vector<double>& from, const std::vector<double>& to) {
  int substeps = 1;
  for (const DescribedPlant::State& state : plant_.states) substeps = std::max(substeps, state.substeps);
  const double h = scenario_.dt / substeps;
  const auto rates = [&](double part, const std::vector<double>& state) {
    std::vector<double> frame = frame_;
    frame.back() = (static_cast<double>(index_ - 1) + part) * scenario_.dt;
    for (std::size_t s = 0; s < from.size(); ++s) frame[s] = Between(s, from[s], to[s], part, frame.back());
    return Rates(std::move(frame), state, part);
  };
  for (int j = 0; j < substeps; ++j) {
    const double begin = static_cast<double>(j) / substeps, end = static_cast<double>(j + 1) / substeps;
    const double middle = (begin + end) / 2.0;
    const std::vector<double> k1 = rates(begin, state_);
    const std::vector<double> k2 = rates(middle, Moved(state_, k1, h / 2.0));
    const std::vector<double> k3 = rates(middle, Moved(state_, k2, h / 2.0));
    const std::vector<double> k4 = rates(end, Moved(state_, k3, h));
    for (std::size_t i = 0; i < state_.size(); ++i) state_[i] += h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]);
  }
}

void DescribedSimulation::Law(std::vector<double>* frame, double dt) {
  const std::size_t first_let = names_.size() - 1 - lets_.size();
  const auto lets = [&](bool late) {
    for (std::size_t l = 0; l < lets_.size(); ++l)
      if (late_[l] == late) (*frame)[first_let + l] = lets_[l].Evaluate(*frame, dt);
  };
  PlaceParameters(last_active_, frame);
  lets(false);
  mode_ = ModeOf(*frame, dt, true);
  PlaceParameters(mode_, frame);
  lets(true);
  true_output_ = 0.0;
  // Every law follows the time, also one that does not act.
  for (std::size_t m = 0; m < laws_.size(); ++m) {
    const double value = laws_[m].Evaluate(*frame, dt);
    if (static_cast<int>(m) == mode_) true_output_ = value;
  }
  if (predicts_) true_output_ = predicts_->Evaluate(*frame, dt);
  for (Hidden& hidden : hidden_)
    if (hidden.slot == HiddenTerm::Slot::kOutput) true_output_ += hidden.value.Evaluate(*frame, dt);
}

void DescribedSimulation::Next() {
  ++index_;
  const double dt = index_ == 0 ? 0.0 : scenario_.dt;
  const std::vector<double> before = seen_;
  MoveInputs(&signals_, &seen_);
  FollowSignals(dt);
  if (index_ == 0) {
    Begin();
  } else if (!state_.empty()) {
    Advance(before, seen_);
  }
  std::vector<double> frame = frame_;
  std::copy(seen_.begin(), seen_.end(), frame.begin());
  frame.back() = t();
  PlaceStates(state_, &frame);
  const std::vector<double> rates = Rates(frame, state_, 1.0);
  for (std::size_t s = 0; s < sources_.size(); ++s) {
    if (sources_[s].state < 0) continue;
    const auto of = static_cast<std::size_t>(sources_[s].state);
    signals_[s] = frame[s] = sources_[s].order == 0 ? state_[of] : rates[of];
  }
  Law(&frame, dt);
  frame_ = std::move(frame);
  measured_ = signals_;
  measured_[static_cast<std::size_t>(output_)] = true_output_ + Draw(noise_, &rng_);
}

}  // namespace armcmc::plant_sim
