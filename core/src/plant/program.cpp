#include "armcmc/plant/program.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "armcmc/expression/compile.hpp"
#include "armcmc/expression/linearity.hpp"
#include "plant/remembered.hpp"

namespace armcmc {
namespace {

using expression::Op;
using expression::SymbolKind;

static_assert(Plant::kMaxInputs <= kMaxPackInputs && Plant::kMaxPlantModes <= kMaxModes);

bool IsLognormal(const ParameterDescription& p) { return p.prior == "lognormal"; }

}  // namespace

PlantProgram::PlantProgram(std::shared_ptr<const Plant> plant, Part part)
    : plant_(std::move(plant)), part_(part), graph_(plant_->graph()) {
  for (std::size_t m = 0; m < plant_->modes().size(); ++m)
    if (!plant_->modes()[m].passive) active_.push_back(m);
  const auto& parameters = plant_->description().parameters;
  const bool one_law = part_ == Part::kPrediction || LawsNeedStates() ||
                       std::any_of(parameters.begin(), parameters.end(), [](const auto& p) { return !p.per_mode; });
  merged_ = active_.size() > 1 && one_law;
  ChooseParameters();
  CompileModes();
  FillInfo();
  if (part_ == Part::kLaws && plant_->predicts() >= 0) MakePrediction();
}

bool PlantProgram::LawsNeedStates() const {
  for (const std::size_t m : active_)
    if (Remembered::MakesStates(graph_, plant_->modes()[m].law)) return true;
  // Without another prediction of the output, the laws predict it.
  if (plant_->predicts() < 0) return !plant_->states().empty();
  for (std::size_t s = 0; s < plant_->states().size(); ++s) {
    const int state = plant_->NodeOf(SymbolKind::kState, static_cast<int>(s));
    for (const std::size_t m : active_)
      if (graph_.DependsOn(plant_->modes()[m].law, state)) return true;
  }
  return false;
}

void PlantProgram::MakePrediction() {
  prediction_ = std::make_unique<const PlantProgram>(plant_, Part::kPrediction);
  for (std::size_t a = 0; a < active_.size(); ++a)
    for (std::size_t d = 0; d < plant_->description().parameters.size(); ++d) {
      const std::size_t mode = merged_ ? 0 : a;
      in_prediction_[mode][static_cast<std::size_t>(index_[a][d])] = prediction_->index_[a][d];
    }
}

void PlantProgram::ChooseParameters() {
  const auto& description = plant_->description();
  index_.assign(active_.size(), std::vector<int>(description.parameters.size()));
  for (std::size_t d = 0; d < description.parameters.size(); ++d) {
    const ParameterDescription& p = description.parameters[d];
    const bool copies = merged_ && p.per_mode;
    for (std::size_t a = 0; a < active_.size(); ++a) {
      if (a == 0 || copies) {
        sampled_.push_back(p);
        if (copies) sampled_.back().name += '_' + plant_->modes()[active_[a]].name;
      }
      index_[a][d] = static_cast<int>(sampled_.size()) - 1;
    }
  }
  if (part_ == Part::kPrediction && sampled_.size() > static_cast<std::size_t>(kMaxParams))
    throw PlantError("predicts", 0,
                     "depends on " + std::to_string(sampled_.size()) + " parameters of all modes together, at most " +
                         std::to_string(kMaxParams) + " are possible");
  const std::size_t coordinates = sampled_.size() + (description.noise.estimate && part_ == Part::kLaws ? 1 : 0);
  if (coordinates > static_cast<std::size_t>(kMaxParams))
    throw PlantError("parameters", 0,
                     "there are " + std::to_string(coordinates) +
                         " parameters to sample (noise scale included), at most " + std::to_string(kMaxParams) +
                         " are possible");
}

int PlantProgram::InMode(int node, std::size_t active) {
  std::map<int, int> by;
  for (std::size_t d = 0; d < index_[active].size(); ++d) {
    const int sampled = index_[active][d];
    const int symbol = graph_.Symbol(SymbolKind::kParameter, sampled);
    const bool log = IsLognormal(sampled_[static_cast<std::size_t>(sampled)]);
    by.emplace(plant_->NodeOf(SymbolKind::kParameter, static_cast<int>(d)),
               log ? graph_.Make(Op::kExp, symbol) : symbol);
  }
  return graph_.Substitute(node, by);
}

void PlantProgram::CompileLaw(int law, int target, const std::string& key, std::vector<int>* scalars) {
  try {
    SampledMode& mode = modes_.back();
    // law - target: the sign is irrelevant for squares, and a product is added to minus the target in one instruction.
    for (const bool error : {false, true}) {
      std::vector<expression::Tape>& tapes = error ? mode.errors : mode.laws;
      const int node = error ? graph_.Make(Op::kSubtract, law, target) : law;
      expression::CompiledTape compiled =
          CompileTape(&graph_, {node},
                      {.num_parameters = static_cast<int>(sampled_.size()),
                       .num_states = states_.size(),
                       .first_free = tapes.empty() ? states_.step().num_registers : tapes.back().num_registers},
                      std::move(*scalars));
      *scalars = std::move(compiled.scalars);
      expression::Tape& tape = tapes.emplace_back(std::move(compiled.tape));
      if (tape.shape != expression::TapeShape::kPower) continue;
      double largest = 0.0;
      for (std::size_t k = 0; k < static_cast<std::size_t>(tape.num_powers); ++k) {
        const ParameterDescription& exponent = sampled_[tape.power[k].exponent];
        largest = std::fmax(largest, IsLognormal(exponent)
                                         ? HUGE_VAL
                                         : std::fmax(std::fabs(*exponent.lower), std::fabs(*exponent.upper)));
      }
      if (largest < HUGE_VAL) tape.largest_exponent = largest;
    }
  } catch (const std::logic_error& error) {  // length_error, invalid_argument
    throw PlantError(key, 0, std::string("the law ") + error.what());
  }
}

template <class NodeOfMode>
int PlantProgram::OfActingMode(NodeOfMode node_of) {
  int node = node_of(active_.size() - 1);
  for (std::size_t a = active_.size() - 1; a-- > 0;)
    node = graph_.Make(Op::kIf, plant_->modes()[active_[a]].when, node_of(a), node);
  return node;
}

void PlantProgram::CompileModes() {
  const auto& modes = plant_->modes();
  const auto& described = plant_->description().modes;
  const int output = plant_->NodeOf(SymbolKind::kSignal, plant_->output());
  const auto key_of = [&](std::size_t a) {
    return plant_->description().law.empty() ? "mode[" + std::to_string(active_[a]) + "].law" : std::string("law");
  };
  std::vector<int> scalars;
  std::vector<Remembered::State> states;
  // In a mode a parameter means that mode's value; in a passive one that of the last mode that is none.
  for (const PlantState& state : plant_->states())
    states.push_back({OfActingMode([&](std::size_t a) { return InMode(state.rate, a); }),
                      OfActingMode([&](std::size_t a) { return InMode(state.start, a); }), state.measured_by >= 0});
  Remembered remembered(&graph_, std::move(states), HeldSignals(plant_->description()));
  std::vector<int> laws;
  const auto add_law = [&](int node, const std::string& key) {
    try {
      laws.push_back(remembered.InLaw(node));
    } catch (const std::logic_error& error) {  // length_error, invalid_argument
      throw PlantError(key, 0, std::string("the law ") + error.what());
    }
  };
  for (std::size_t a = 0; a < active_.size() && part_ == Part::kLaws; ++a)
    add_law(InMode(modes[active_[a]].law, a), key_of(a));
  if (part_ == Part::kPrediction)
    add_law(OfActingMode([&](std::size_t a) { return InMode(plant_->predicts(), a); }), "predicts");
  if (part_ == Part::kPrediction || LawsNeedStates()) CompileStates(&remembered, &scalars);
  if (part_ == Part::kPrediction) {
    modes_.push_back({.name = "prediction"});
    CompileLaw(laws[0], output, "predicts", &scalars);
  }
  for (std::size_t a = 0; a < active_.size() && part_ == Part::kLaws; ++a) {
    const PlantMode& mode = modes[active_[a]];
    if (a == 0 || !merged_) modes_.push_back({.name = merged_ ? "active" : described[active_[a]].name});
    CompileLaw(laws[a], mode.target, key_of(a), &scalars);
    modes_.back().law_is_output = modes_.back().law_is_output && mode.target == output;
    modes_.back().linear =
        FindLinearPart(&graph_, merged_ ? laws : std::vector<int>{laws[a]}, static_cast<int>(sampled_.size()));
  }
  CompileFeatures(scalars, remembered);
}

void PlantProgram::CompileFeatures(const std::vector<int>& scalars, const Remembered& remembered) {
  const auto& modes = plant_->modes();
  num_scalars_ = static_cast<int>(scalars.size());
  std::vector<int> features = scalars;
  const auto feature = [&](int node) {
    features.push_back(node);
    return static_cast<int>(features.size()) - 1;
  };
  int next = 0;
  for (std::size_t m = 0; m < modes.size() && part_ == Part::kLaws; ++m) {
    Outputs out;
    if (modes[m].when >= 0) out.when = feature(modes[m].when);
    if (modes[m].passive) {
      if (graph_.at(modes[m].law).sampled)
        throw PlantError("mode[" + std::to_string(m) + "].law", 1, "what a passive mode shows depends on no parameter");
      out.passive = feature(modes[m].law);
      out.passive_given = !plant_->description().modes[m].law.empty();
    } else {
      const int active = next++;
      (merged_ ? out.law : out.sampled) = active;
      if (merged_) out.sampled = 0;
      out.target = feature(modes[m].target);
    }
    outputs_.push_back(out);
  }
  // Predictions are computed at every sample, in every mode.
  if (part_ == Part::kPrediction)
    outputs_.push_back({.target = feature(plant_->NodeOf(SymbolKind::kSignal, plant_->output())), .sampled = 0});
  first_remembered_ = static_cast<int>(features.size());
  num_remembered_ = static_cast<int>(remembered.inputs().size());
  features.insert(features.end(), remembered.inputs().begin(), remembered.inputs().end());
  first_line_ = static_cast<int>(features.size());
  num_lines_ = static_cast<int>(remembered.lines().size());
  features.insert(features.end(), remembered.lines().begin(), remembered.lines().end());
  try {
    features_ = expression::FeatureProgram(graph_, features);
  } catch (const std::length_error& error) {
    throw PlantError("name", 0, std::string("the plant ") + error.what());
  }
}

void PlantProgram::CompileStates(Remembered* remembered, std::vector<int>* scalars) {
  std::vector<int> rates;
  for (std::size_t s = 0; s < plant_->states().size(); ++s) {
    try {
      rates.push_back(remembered->InRate(remembered->of_plant()[s].rate));
    } catch (const std::logic_error& error) {  // length_error, invalid_argument
      throw PlantError("states." + plant_->description().states[s].name + ".rate", 0,
                       std::string("the rate ") + error.what());
    }
  }
  for (const RememberedState& state : remembered->states()) rates.push_back(remembered->RateOf(state));
  if (rates.empty()) return;
  states_ = PlantStates(*plant_, &graph_, rates, remembered->Starts(), remembered->states(), remembered->Held(),
                        static_cast<int>(sampled_.size()), scalars);
}

void PlantProgram::FillInfo() {
  const PlantDescription& description = plant_->description();
  const std::vector<ReportDescription> none;
  const auto& reports = part_ == Part::kLaws ? description.reports : none;
  if (sampled_.size() + reports.size() > static_cast<std::size_t>(kMaxReported))
    throw PlantError("report", 0,
                     "at most " + std::to_string(kMaxReported) + " quantities are reported, parameters included");
  std::vector<int> nodes;
  for (std::size_t d = 0; d < sampled_.size(); ++d) {
    const int symbol = graph_.Symbol(SymbolKind::kParameter, static_cast<int>(d));
    nodes.push_back(IsLognormal(sampled_[d]) ? graph_.Make(Op::kExp, symbol) : symbol);
    names_.push_back(sampled_[d].name);
    units_.push_back(sampled_[d].unit);
  }
  for (std::size_t r = 0; r < reports.size(); ++r) {
    const int first = InMode(plant_->reports()[r], 0);
    for (std::size_t a = 1; merged_ && a < active_.size(); ++a)
      if (InMode(plant_->reports()[r], a) != first)
        throw PlantError("report." + reports[r].name + ".value", 1,
                         "differs from mode to mode, and there is one value to report");
    if (std::find(names_.begin(), names_.end(), reports[r].name) != names_.end())
      throw PlantError("report." + reports[r].name, 0,
                       '"' + reports[r].name + "\" is already reported: it is a parameter");
    nodes.push_back(first);
    names_.push_back(reports[r].name);
    units_.push_back(reports[r].unit);
  }
  for (const int node : nodes) reports_.emplace_back(graph_, std::vector<int>{node});

  const auto& first_mode = plant_->modes()[active_[0]];
  target_unit_ = first_mode.target_unit ? first_mode.target_unit->Text() : "?";
  for (const SignalDescription& signal : description.signals)
    if (signal.name == description.output && description.modes[active_[0]].target.empty()) target_unit_ = signal.unit;
  info_.name = description.name;
  info_.plant = PlantNumber::kDescribed;
  info_.described = this;
  info_.target_unit = target_unit_;
  info_.num_parameters = static_cast<int>(sampled_.size());
  for (std::size_t d = 0; d < sampled_.size(); ++d) {
    const ParameterDescription& p = sampled_[d];
    info_.parameters[d] = {names_[d], units_[d], p.mean, p.sd, *p.lower, *p.upper};
  }
  info_.num_modes = static_cast<int>(modes_.size());
  for (std::size_t m = 0; m < modes_.size(); ++m) {
    info_.modes[m] = modes_[m].name;
    info_.linear[m] = modes_[m].linear;
  }
  info_.modes[modes_.size()] = "passive";
  for (const ModeDescription& mode : description.modes)
    if (mode.passive) info_.modes[modes_.size()] = mode.name;
  info_.num_inputs = static_cast<int>(description.signals.size()) - 1;
  info_.default_noise_std = description.noise.std;
  info_.num_reported = static_cast<int>(nodes.size());
  for (std::size_t r = 0; r < nodes.size(); ++r) info_.reported[r] = {names_[r], units_[r]};
}

void PlantProgram::CopyPastSamples(const expression::PastSamples& kept, int line, double first,
                                   expression::PastLines* out) const noexcept {
  constexpr int kLength = expression::kMaxDelaySamples;
  const auto& samples = kept.line[static_cast<std::size_t>(line)];
  double* newest = &out->value[static_cast<std::size_t>(expression::PastLines::Place(line, -1))];
  double oldest = first;
  for (int age = 0; age < kLength; ++age) {
    if (age < kept.samples) oldest = samples[static_cast<std::size_t>((kept.samples - 1 - age) % kLength)];
    *(newest - age) = oldest;
  }
  *(newest - kLength) = kept.samples >= kLength ? std::numeric_limits<double>::quiet_NaN() : oldest;
}

bool PlantProgram::Prepare(const DataPack& pack, expression::FeatureMemory* memory, const StateMemory* before,
                           PlantPack* out) const noexcept {
  PlantSignals signals{};
  std::array<double, expression::kMaxTapeScalars + 2 * Plant::kMaxPlantModes + PlantPoint::kMaxRemembered +
                         expression::kMaxDelays>
      value{};
  out->scalars.stride = num_scalars_;
  bool finite = true;
  for (int n = 0; n < pack.num_samples; ++n) {
    const auto in = static_cast<std::size_t>(n);
    SignalsAt(pack, n, plant_->output(), &signals);
    PlantPoint::Values& point = out->point[in];
    std::copy(signals.begin(), signals.end(), point.begin());
    for (int l = 0; l < num_lines_; ++l)
      point[static_cast<std::size_t>(PlantPoint::kFirstPosition + l)] = expression::PastLines::Place(l, n);
    features_.Evaluate({point.data(), pack.t_last_s - (pack.num_samples - 1 - n) * pack.dt, pack.dt}, memory,
                       value.data());
    out->mode[in] = static_cast<std::int8_t>(info_.num_modes);
    out->target[in] = out->passive[in] = 0.0;
    out->passive_given[in] = false;
    for (const Outputs& mode : outputs_) {
      if (mode.when >= 0 && value[static_cast<std::size_t>(mode.when)] == 0.0) continue;
      if (mode.sampled >= 0) {
        out->mode[in] = static_cast<std::int8_t>(mode.sampled);
        out->law[in] = static_cast<std::uint8_t>(mode.law);
        out->target[in] = value[static_cast<std::size_t>(mode.target)];
        finite = finite && std::isfinite(out->target[in]);
      } else {
        out->passive[in] = value[static_cast<std::size_t>(mode.passive)];
        out->passive_given[in] = mode.passive_given;
      }
      break;
    }
    std::copy_n(value.begin(), num_scalars_, out->scalars.Row(n));
    std::copy_n(value.begin() + first_remembered_, num_remembered_, point.begin() + PlantPoint::kFirstRemembered);
    for (int l = 0; l < num_lines_; ++l) {
      const double kept = value[static_cast<std::size_t>(first_line_ + l)];
      if (n == 0) CopyPastSamples(memory->kept, l, kept, &out->past);
      out->past.value[static_cast<std::size_t>(expression::PastLines::Place(l, n))] = kept;
      finite = finite && std::isfinite(kept);
    }
  }
  for (int l = 0; l < num_lines_; ++l)
    for (int n = 0; n < pack.num_samples; ++n)
      memory->kept.line[static_cast<std::size_t>(l)]
                       [static_cast<std::size_t>((memory->kept.samples + n) % expression::kMaxDelaySamples)] =
          out->past.value[static_cast<std::size_t>(expression::PastLines::Place(l, n))];
  // Keeps counting without overflow and without changing the position in the lines.
  if (num_lines_ > 0) {
    memory->kept.samples += pack.num_samples;
    while (memory->kept.samples >= 2 * expression::kMaxDelaySamples)
      memory->kept.samples -= expression::kMaxDelaySamples;
  }
  return states_.Prepare(pack, out->point.data(), before, &out->states) && finite;
}

void PlantProgram::Leave(const PlantPack& pack, int num_samples, StateMemory* memory) const noexcept {
  memory->point = pack.point[static_cast<std::size_t>(num_samples - 1)];
  for (int l = 0; l < num_lines_; ++l)
    memory->point[static_cast<std::size_t>(PlantPoint::kFirstPosition + l)] = expression::PastLines::Place(l, -1);
}

void PlantProgram::Fill(const PlantPack& pack, int num_samples, int mode, ModeData* data) const noexcept {
  int m = 0;
  for (int n = 0; n < num_samples; ++n) {
    if (pack.mode[static_cast<std::size_t>(n)] != mode) continue;
    const auto im = static_cast<std::size_t>(m++);
    data->sample[im] = static_cast<std::int16_t>(n);
    data->target[im] = pack.target[static_cast<std::size_t>(n)];
  }
  data->num_samples = m;
  const SampledMode& sampled = modes_[static_cast<std::size_t>(mode)];
  data->tape = sampled.laws.data();
  data->error_tape = sampled.errors.data();
  data->num_tapes = static_cast<int>(sampled.laws.size());
  data->law = data->num_tapes > 1 ? pack.law.data() : nullptr;
  data->scalars = &pack.scalars;
  data->past = pack.past.value.data();
  data->states = pack.states.step != nullptr ? &pack.states : nullptr;
  data->start_fit = nullptr;
}

double PlantProgram::Report(int r, const double* theta) const noexcept {
  double value = 0.0;
  reports_[static_cast<std::size_t>(r)].Evaluate({theta, 0.0, 0.0}, nullptr, &value);
  return value;
}

bool PlantProgram::IsReportedAsSampled(int r) const noexcept {
  return static_cast<std::size_t>(r) < sampled_.size() && !IsLognormal(sampled_[static_cast<std::size_t>(r)]);
}

double PlantProgram::Sampled(int d, double reported) const noexcept {
  return IsLognormal(sampled_[static_cast<std::size_t>(d)]) ? std::log(reported) : reported;
}

}  // namespace armcmc
