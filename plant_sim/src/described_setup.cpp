// Described plants: everything that is decided before the first sample.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <regex>

#include "armcmc/plant_sim/described_simulation.hpp"

namespace armcmc::plant_sim {
namespace {

constexpr std::uint64_t kNoiseStream = 0x4e, kInputStream = 0x100;

std::string ModeKey(const DescribedPlant& plant, std::size_t mode, const std::string& what) {
  return plant.one_law ? what : "mode[" + std::to_string(mode) + "]." + what;
}

}  // namespace

DescribedSimulation::DescribedSimulation(const DescribedPlant& plant, const DescribedScenario& scenario)
    : plant_(plant), scenario_(scenario), rng_(scenario.seed, kNoiseStream) {
  output_ = plant_.SignalAt(plant_.output);
  if (output_ < 0) throw DescribedError("output", 0, "no signal is called \"" + plant_.output + '"');
  if (!(scenario_.dt > 0.0) || !std::isfinite(scenario_.dt))
    throw DescribedError("scenario.rate_hz", 0, "expected a sample interval above 0");
  noise_ = scenario_.noise.value_or(plant_.noise);
  MakeNames();
  MakeSources();
  MakeTruth();
  MakeExpressions();
  MakeHidden();
  signals_.assign(plant_.signals.size(), 0.0);
  seen_ = signals_;
}

void DescribedSimulation::MakeNames() {
  const auto add = [this](const std::string& key, const auto& list) {
    for (const auto& entry : list) {
      if (std::find(names_.begin(), names_.end(), entry.name) != names_.end() || entry.name == "t")
        throw DescribedError(key + "." + entry.name, 0, '"' + entry.name + "\" is already the name of something else");
      names_.push_back(entry.name);
    }
  };
  add("signals", plant_.signals);
  add("constants", plant_.constants);
  add("parameters", plant_.parameters);
  add("states", plant_.states);
  add("let", plant_.lets);
  names_.emplace_back("t");
  held_.assign(names_.size(), false);
  for (std::size_t s = 0; s < plant_.signals.size(); ++s) held_[s] = plant_.signals[s].between == "held";
  const auto constants = held_.begin() + static_cast<std::ptrdiff_t>(plant_.signals.size());
  std::fill_n(constants, plant_.constants.size() + plant_.parameters.size(), true);
  frame_.assign(names_.size(), 0.0);
  for (const DescribedPlant::Constant& constant : plant_.constants) frame_[Place(constant.name)] = constant.value;
}

std::size_t DescribedSimulation::Place(const std::string& name) const {
  return static_cast<std::size_t>(std::find(names_.begin(), names_.end(), name) - names_.begin());
}

void DescribedSimulation::MakeSources() {
  for (const auto& [name, program] : scenario_.inputs) {
    const std::string key = "scenario.inputs." + name;
    const int at = plant_.SignalAt(name);
    if (at < 0) throw DescribedError(key, 0, plant_.name + " has no signal of that name");
    if (at == output_) throw DescribedError(key, 0, "is the output, which the plant makes");
    if (!plant_.signals[static_cast<std::size_t>(at)].derivative_of.empty())
      throw DescribedError(key, 0, "follows from " + plant_.signals[static_cast<std::size_t>(at)].derivative_of);
  }
  sources_.resize(plant_.signals.size());
  for (std::size_t s = 0; s < plant_.signals.size(); ++s) {
    const DescribedPlant::Signal& signal = plant_.signals[s];
    if (static_cast<int>(s) == output_ || !signal.derivative_of.empty()) continue;
    const auto given = scenario_.inputs.find(signal.name);
    const std::string key = "scenario.inputs." + signal.name;
    if (given == scenario_.inputs.end()) {
      for (std::size_t x = 0; x < plant_.states.size(); ++x)
        if (plant_.states[x].measured_by == signal.name || plant_.states[x].start == signal.name)
          sources_[s].state = static_cast<int>(x);
      if (sources_[s].state < 0) throw DescribedError(key, 0, "is missing: how does " + signal.name + " move?");
    } else if (given->second.kind == InputProgram::Kind::kState) {
      sources_[s].state = plant_.StateAt(given->second.text);
      if (sources_[s].state < 0) throw DescribedError(key, 0, "no state is called \"" + given->second.text + '"');
    } else {
      sources_[s].input = static_cast<int>(inputs_.size());
      inputs_.emplace_back(given->second, plant_, key + ".expression", scenario_.duration_s, scenario_.seed,
                           kInputStream + s);
    }
  }
  for (std::size_t s = 0; s < plant_.signals.size(); ++s) {
    std::string of = plant_.signals[s].derivative_of;
    if (of.empty() || static_cast<int>(s) == output_) continue;
    const std::string key = "signals." + plant_.signals[s].name + ".derivative_of";
    int order = 0;
    int root = static_cast<int>(s);
    for (; !of.empty(); ++order) {
      root = plant_.SignalAt(of);
      if (root < 0) throw DescribedError(key, 0, "no signal is called \"" + of + '"');
      of = root == output_ ? "" : plant_.signals[static_cast<std::size_t>(root)].derivative_of;
      if (order > 3) throw DescribedError(key, 0, "is a derivative of an order above 3, or of itself");
    }
    if (root == output_) throw DescribedError(key, 0, "is the rate of the output: that cannot be simulated");
    sources_[s] = sources_[static_cast<std::size_t>(root)];
    sources_[s].order = order;
    if (order > (sources_[s].state >= 0 ? 1 : 3))
      throw DescribedError(key, 0, "is a derivative of too high an order to be simulated");
  }
}

void DescribedSimulation::MakeTruth() {
  for (const auto& [name, values] : scenario_.truth) {
    const auto is = [&wanted = name](const DescribedPlant::Parameter& p) { return p.name == wanted; };
    const auto known = std::find_if(plant_.parameters.begin(), plant_.parameters.end(), is);
    if (known == plant_.parameters.end())
      throw DescribedError("scenario.truth." + name, 0, plant_.name + " has no parameter of that name");
    if (values.size() != 1 && !(known->per_mode && values.size() == plant_.modes.size()))
      throw DescribedError("scenario.truth." + name, 0,
                           known->per_mode ? "expected one value, or one for each of the " +
                                                 std::to_string(plant_.modes.size()) + " modes in the file's order"
                                           : "expected one value");
  }
  for (const DescribedPlant::Parameter& parameter : plant_.parameters) {
    const auto given = scenario_.truth.find(parameter.name);
    std::vector<double> values = given == scenario_.truth.end() ? std::vector<double>{parameter.usual} : given->second;
    if (values.size() == 1) values.resize(plant_.modes.size(), values.front());
    truth_.push_back(std::move(values));
  }
  for (std::size_t m = 0; m < plant_.modes.size(); ++m)
    if (!plant_.modes[m].passive) last_active_ = static_cast<int>(m);
}

DescribedSimulation::Expression DescribedSimulation::Read(const std::string& key, const std::string& text,
                                                          bool sees_output, bool is_rate) const {
  try {
    Expression expression(text, names_, held_, is_rate);
    if (!sees_output && expression.Reads(output_))
      throw DescribedError(key, 0, "reads the output, which is not known before it is simulated");
    return expression;
  } catch (const expression::Error& error) {
    throw DescribedError(key, error.column(), error.what());
  }
}

void DescribedSimulation::MakeExpressions() {
  for (const DescribedPlant::Let& let : plant_.lets) {
    Expression value = Read("let." + let.name, let.text);
    bool late = false, remembers = value.has_memory();
    for (std::size_t other = 0; other < plant_.lets.size(); ++other) {
      if (!value.Reads(static_cast<int>(Place(plant_.lets[other].name)))) continue;
      if (other >= lets_.size())
        throw DescribedError("let." + let.name, 0, plant_.lets[other].name + " is defined further down");
      late = late || late_[other];
      remembers = remembers || remembers_[other];
    }
    for (const DescribedPlant::Parameter& parameter : plant_.parameters)
      late = late || (parameter.per_mode && value.Reads(static_cast<int>(Place(parameter.name))));
    held_[Place(let.name)] = value.is_held();
    lets_.push_back(std::move(value));
    late_.push_back(late);
    remembers_.push_back(remembers);
  }
  for (std::size_t m = 0; m < plant_.modes.size(); ++m) {
    const DescribedPlant::Mode& mode = plant_.modes[m];
    whens_.push_back(Read(ModeKey(plant_, m, "when"), mode.when.empty() ? "1" : mode.when));
    for (std::size_t l = 0; l < lets_.size(); ++l)
      if (late_[l] && whens_.back().Reads(static_cast<int>(Place(plant_.lets[l].name))))
        throw DescribedError(ModeKey(plant_, m, "when"), 0, "depends on a parameter that the mode decides");
    if (!mode.target.empty() && plant_.predicts.empty())
      throw DescribedError(ModeKey(plant_, m, "target"), 0,
                           "the output cannot be simulated from a law that explains a target: give \"predicts\"");
    laws_.push_back(Read(ModeKey(plant_, m, "law"), mode.law.empty() || !plant_.predicts.empty() ? "0" : mode.law));
  }
  if (!plant_.predicts.empty()) predicts_ = Read("predicts", plant_.predicts);
  const bool per_mode = std::any_of(plant_.parameters.begin(), plant_.parameters.end(),
                                    [](const DescribedPlant::Parameter& parameter) { return parameter.per_mode; });
  // Rates ask for the mode between samples, too.
  if (per_mode && !plant_.states.empty())
    for (std::size_t m = 0; m < whens_.size(); ++m) RefuseMemory(ModeKey(plant_, m, "when"), whens_[m]);
  for (const DescribedPlant::State& state : plant_.states) {
    const std::string key = "states." + state.name + ".";
    rates_.push_back(ReadRate(key + "rate", state.rate));
    starts_.push_back(Read(key + "start", state.start, /*sees_output=*/true));
    RefuseMemory(key + "start", starts_.back());
  }
  for (const auto& [name, value] : scenario_.start)
    if (plant_.StateAt(name) < 0 && plant_.SignalAt(name) < 0)
      throw DescribedError("scenario.start." + name, 0, plant_.name + " has no state and no signal of that name");
}

DescribedSimulation::Expression DescribedSimulation::ReadRate(const std::string& key, const std::string& text) const {
  Expression rate = Read(key, text, false, true);
  const auto reads_let = [&](const auto& which) {
    for (std::size_t l = 0; l < lets_.size(); ++l)
      if (which[l] && rate.Reads(static_cast<int>(Place(plant_.lets[l].name)))) return true;
    return false;
  };
  if (!rate.has_memory() && !reads_let(remembers_)) return rate;
  // What it remembers is its own: named parts are put in, the last one first, as each uses those above it.
  std::string whole = text;
  for (auto let = plant_.lets.rbegin(); let != plant_.lets.rend(); ++let)
    whole = std::regex_replace(whole, std::regex("\\b" + let->name + "\\b"), "(" + let->text + ")");
  rate = Read(key, whole, false, true);
  for (std::size_t place = 0; place + 1 < names_.size(); ++place) {
    if (!rate.RemembersPlace(static_cast<int>(place))) continue;
    const bool signal = place < plant_.signals.size();
    const std::string& name = names_[place];
    const auto parameter = std::find_if(plant_.parameters.begin(), plant_.parameters.end(),
                                        [&name](const DescribedPlant::Parameter& p) { return p.name == name; });
    if (plant_.StateAt(name) >= 0 || (signal && sources_[place].state >= 0))
      throw DescribedError(key, 0, "remembers the state " + name + ": between samples only signals are known");
    if (parameter != plant_.parameters.end() && parameter->per_mode)
      throw DescribedError(key, 0, "remembers what depends on " + name + ", which differs from mode to mode");
  }
  return rate;
}

void DescribedSimulation::RefuseMemory(const std::string& key, const Expression& rate) const {
  bool remembers = rate.has_memory();
  for (std::size_t l = 0; l < lets_.size(); ++l)
    remembers = remembers || (remembers_[l] && rate.Reads(static_cast<int>(Place(plant_.lets[l].name))));
  if (remembers) throw DescribedError(key, 0, "has a memory: between samples there is none but the states");
}

void DescribedSimulation::MakeHidden() {
  for (std::size_t h = 0; h < scenario_.hidden.size(); ++h) {
    const HiddenTerm& term = scenario_.hidden[h];
    const std::string key = "scenario.hidden[" + std::to_string(h) + "].";
    Hidden hidden{term.slot, 0, Read(key + "value", term.value)};
    if (term.slot == HiddenTerm::Slot::kInput) {
      hidden.of = plant_.SignalAt(term.of);
      if (hidden.of < 0 || hidden.of == output_ || sources_[static_cast<std::size_t>(hidden.of)].state >= 0)
        throw DescribedError(key + "slot", 0, plant_.name + " has no input called \"" + term.of + '"');
      const std::size_t inputs_end = plant_.signals.size() + plant_.constants.size();
      for (std::size_t place = inputs_end; place + 1 < names_.size(); ++place)
        if (hidden.value.Reads(static_cast<int>(place)))
          throw DescribedError(key + "value", 0,
                               "reads " + names_[place] + ": an input is made of signals, constants and t");
    } else if (term.slot == HiddenTerm::Slot::kRate) {
      hidden.of = plant_.StateAt(term.of);
      if (hidden.of < 0) throw DescribedError(key + "slot", 0, plant_.name + " has no state called \"" + term.of + '"');
      RefuseMemory(key + "value", hidden.value);
    }
    hidden_.push_back(std::move(hidden));
  }
}

}  // namespace armcmc::plant_sim
