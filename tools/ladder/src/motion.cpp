#include "motion.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <initializer_list>
#include <optional>
#include <stdexcept>
#include <string_view>

#include "armcmc/expression/features.hpp"
#include "armcmc/expression/graph.hpp"
#include "armcmc/expression/syntax.hpp"

namespace armcmc::ladder {
namespace {

using expression::Graph;
using expression::SymbolKind;

constexpr double kTurn = 6.283185307179586;

/// The text with each # replaced by the next number.
std::string Fill(std::string_view text, int digits, std::initializer_list<double> numbers) {
  std::string out;
  const double* next = numbers.begin();
  for (const char c : text) {
    if (c != '#' || next == numbers.end()) {
      out += c;
      continue;
    }
    std::array<char, 32> number{};
    std::snprintf(number.data(), number.size(), "%.*g", digits, *next++);
    out += number.data();
  }
  return out;
}
/// A shape as an expression and as a phrase.
std::string Text(std::string_view text, std::initializer_list<double> numbers) { return Fill(text, 9, numbers); }
std::string Words(std::string_view text, std::initializer_list<double> numbers) { return Fill(text, 2, numbers); }

double Quantile(std::vector<double> values, double share) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// Arguments of a shape.
struct Frame {
  double low, high;   ///< Unit of the input.
  double hz;          ///< Strokes per second.
  double duration_s;  ///< Duration of the experiment.
  double rise_s;      ///< Half the rise time of a step.
};

/// Scales a shape from [-1, 1] to the range.
std::string Over(const Frame& f, const std::string& shape) {
  return Text("# + #*", {0.5 * (f.low + f.high), 0.5 * (f.high - f.low)}) + "(" + shape + ")";
}

/// Strokes at constant speed with rounded reversals, as drives make them.
std::string Strokes(const std::string& phase) { return "0.72968*asin(0.98*sin(" + phase + "))"; }

std::string Steady(double hz) { return Text("#*t", {kTurn * hz}); }

/// Phase of a sweep with rising frequency.
std::string Growing(double from_hz, double to_hz, double duration_s) {
  return Text("#*t + #*t^2", {kTurn * from_hz, 0.5 * kTurn * (to_hz - from_hz) / duration_s});
}

constexpr double kSlowest = 0.25, kFastest = 2.0;  // frequencies of a sweep, relative to the pace

std::string ConstantSpeed(const Frame& f) { return Over(f, Strokes(Steady(f.hz))); }
std::string ConstantSpeedWords(const Frame& f) {
  return Words("in strokes at constant speed, # s each way", {0.5 / f.hz});
}
std::string Speeds(const Frame& f) { return Over(f, Strokes(Growing(kSlowest * f.hz, kFastest * f.hz, f.duration_s))); }
std::string SpeedsWords(const Frame& f) {
  return Words("in strokes at constant speed, each faster than the last, from # to # s each way",
               {0.5 / (kSlowest * f.hz), 0.5 / (kFastest * f.hz)});
}
std::string Sweep(const Frame& f) {
  return Over(f, "sin(" + Growing(kSlowest * f.hz, kFastest * f.hz, f.duration_s) + ")");
}
std::string SweepWords(const Frame& f) {
  return Words("as a sine that is swept from # to # Hz", {kSlowest * f.hz, kFastest * f.hz});
}
std::string Lengths(const Frame& f) {
  return Over(f, Text("(0.05 + #*t)*", {0.95 / f.duration_s}) + Strokes(Steady(f.hz)));
}
std::string LengthsWords(const Frame& f) {
  return Words("in strokes of # s each way, each longer than the last, from a twentieth of the range to all of it",
               {0.5 / f.hz});
}
std::string Places(const Frame& f) {
  return Over(f, "0.75*" + Strokes(Steady(0.125 * f.hz)) + " + 0.25*" + Strokes(Steady(f.hz)));
}
std::string PlacesWords(const Frame& f) {
  return Words("in short strokes of # s each way, about places that wander slowly through the range", {0.5 / f.hz});
}
std::string Sines(const Frame& f) {
  return Over(f, "0.5*sin(" + Steady(0.5 * f.hz) + ") + 0.3*sin(" + Steady(1.35 * f.hz) + " + 1) + 0.2*sin(" +
                     Steady(3.05 * f.hz) + " + 2)");
}
std::string SinesWords(const Frame& f) {
  return Words("as a sum of three sines of #, # and # Hz", {0.5 * f.hz, 1.35 * f.hz, 3.05 * f.hz});
}
std::string UnequalStrokes(const Frame& f) {
  return Over(f, Strokes(Steady(f.hz) + " + 0.7*sin(" + Steady(f.hz) + ")"));
}
std::string UnequalStrokesWords(const Frame& f) {
  return Words("to and fro in # s, up about three times as quickly as down", {1.0 / f.hz});
}

constexpr std::array kLevels = {1.0, -0.6, 0.3, -1.0, 0.7, 0.0};
constexpr int kMostSteps = 10;

double HoldOf(const Frame& f) { return std::max(0.5 / f.hz, f.duration_s / kMostSteps); }
std::string Steps(const Frame& f) {
  const double hold = HoldOf(f);
  std::string shape = "0";
  double level = 0.0;
  for (int k = 0; k < kMostSteps && (k + 0.3) * hold < f.duration_s; ++k) {
    const double next = kLevels[static_cast<std::size_t>(k) % kLevels.size()], half = 0.5 * (next - level);
    shape += Text(" + #*(1 + tanh((t - #)/#))", {half, (k + 0.3) * hold, f.rise_s});
    level = next;
  }
  return Over(f, shape);
}
std::string StepsWords(const Frame& f) {
  return Words("in quick steps of # s to levels all over the range, each held for about # s",
               {4.0 * f.rise_s, HoldOf(f)});
}

struct Program {
  const char* name;
  std::string (*text)(const Frame&);
  std::string (*words)(const Frame&);
};
constexpr std::array<Program, 8> kPrograms = {{{"strokes", ConstantSpeed, ConstantSpeedWords},
                                               {"strokes_of_speeds", Speeds, SpeedsWords},
                                               {"sweep", Sweep, SweepWords},
                                               {"strokes_of_lengths", Lengths, LengthsWords},
                                               {"strokes_at_places", Places, PlacesWords},
                                               {"steps_and_holds", Steps, StepsWords},
                                               {"sines", Sines, SinesWords},
                                               {"one_way_quick", UnequalStrokes, UnequalStrokesWords}}};

/// The input of which a signal is a derivative, and the order; the signal itself if it is none.
std::pair<std::size_t, std::size_t> RootOf(const PlantDescription& plant, std::size_t signal) {
  std::size_t order = 0;
  for (; !plant.signals[signal].derivative_of.empty() && order < plant.signals.size(); ++order)
    for (std::size_t s = 0; s < plant.signals.size(); ++s)
      if (plant.signals[s].name == plant.signals[signal].derivative_of) {
        signal = s;
        break;
      }
  return {signal, order};
}

/// An expression and its derivatives with respect to t.
std::optional<expression::FeatureProgram> WithDerivatives(const std::string& text, std::size_t orders) {
  expression::Scope scope;
  scope.Add({.name = "t", .kind = SymbolKind::kTime, .unit = {}, .range = {}});
  Graph graph;
  std::vector<int> nodes{graph.Lower(expression::Parse(text), scope, {})};
  const int t = graph.Symbol(SymbolKind::kTime, 0);
  while (nodes.size() <= orders) nodes.push_back(graph.Differentiate(nodes.back(), t));
  try {
    return expression::FeatureProgram(graph, nodes);
  } catch (const std::length_error&) {
    return std::nullopt;
  }
}

/// Number of passages from below `low` to above `high`, counted in each run.
std::size_t Passes(const Dataset& data, const std::vector<double>& value, double low, double high) {
  std::size_t passes = 0, run = 0;
  bool below = false;
  for (std::size_t n = 0; n < value.size(); ++n) {
    if (run < data.series->runs.size() && data.series->runs[run] == n) {
      ++run;
      below = false;
    }
    if (data.training[n] == 0) continue;
    if (value[n] < low) below = true;
    if (value[n] <= high || !below) continue;
    below = false;
    ++passes;
  }
  return passes;
}

}  // namespace

std::vector<std::size_t> InputsOf(const PlantDescription& plant) {
  std::vector<std::size_t> inputs;
  for (std::size_t s = 0; s < plant.signals.size(); ++s) {
    const SignalDescription& signal = plant.signals[s];
    const bool state = std::any_of(plant.states.begin(), plant.states.end(), [&](const StateDescription& x) {
      return x.measured_by == signal.name || x.start == signal.name;
    });
    if (signal.name != plant.output && signal.derivative_of.empty() && !state) inputs.push_back(s);
  }
  return inputs;
}

std::vector<InputRange> RangesOf(const Dataset& data, const PlantDescription& plant) {
  constexpr double kApart = 0.005, kFast = 0.99, kStill = 1e-6;
  std::vector<InputRange> ranges;
  const identify::Series& series = *data.series;
  for (const std::size_t s : InputsOf(plant)) {
    const std::vector<double>& column = series.signals[s];
    std::vector<double> value, speed;
    for (std::size_t n = 0; n < column.size(); ++n)
      if (data.training[n] != 0) value.push_back(column[n]);
    // The recorded derivative is preferred, since differences of neighbouring samples contain noise.
    const std::vector<double>* rate = nullptr;
    for (std::size_t d = 0; d < plant.signals.size(); ++d)
      if (plant.signals[d].derivative_of == plant.signals[s].name) rate = &series.signals[d];
    for (std::size_t n = 1; n < column.size(); ++n)
      if (data.training[n] != 0 && data.training[n - 1] != 0)
        speed.push_back(std::fabs(rate != nullptr ? (*rate)[n] : (column[n] - column[n - 1]) / series.dt));
    InputRange range;
    range.signal = s;
    if (value.empty() || speed.empty()) continue;
    range.low = Quantile(value, kApart);
    range.high = Quantile(value, 1.0 - kApart);
    range.rest = Quantile(value, 0.5);
    if (range.high - range.low <= kStill * std::max(std::fabs(range.low), std::fabs(range.high)))
      range.low = range.high = range.rest;
    range.speed = Quantile(speed, kFast);
    const double quarter = 0.25 * (range.high - range.low);
    const auto passes = std::max<std::size_t>(1, Passes(data, column, range.low + quarter, range.high - quarter));
    range.frequency_hz = static_cast<double>(passes) / (static_cast<double>(value.size()) * series.dt);
    ranges.push_back(range);
  }
  return ranges;
}

std::vector<Motion> MotionsAt(double pace, const PlantDescription& plant, const std::vector<InputRange>& ranges,
                              double duration_s, double dt) {
  constexpr double kFewestStrokes = 2.0;
  constexpr double kLeastRise = 3.0;  // samples
  std::vector<Motion> motions;
  for (const InputRange& moved : ranges) {
    const double hz = pace * moved.frequency_hz;
    if (!moved.moved() || hz * duration_s < kFewestStrokes) continue;
    const auto frame_of = [&](const InputRange& range, double its_hz) {
      const double rise =
          range.speed > 0.0 ? 0.5 * (range.high - range.low) / (std::max(pace, 1.0) * range.speed) : 0.0;
      return Frame{range.low, range.high, its_hz, duration_s, std::clamp(rise, kLeastRise * dt, 0.1 / its_hz)};
    };
    const bool others_moved = std::any_of(ranges.begin(), ranges.end(), [&](const InputRange& other) {
      return other.signal != moved.signal && other.moved();
    });
    for (const Program& program : kPrograms)
      for (const bool step_others : {false, true}) {
        if (step_others && !others_moved) continue;
        const Frame frame = frame_of(moved, hz);
        Motion motion;
        motion.program = program.name;
        motion.words = program.words(frame);
        motion.pace = pace;
        motion.moved = moved;
        for (const InputRange& other : ranges) {
          const SignalDescription& signal = plant.signals[other.signal];
          if (other.signal == moved.signal) {
            motion.program_of[other.signal] = program.text(frame);
          } else if (step_others && other.moved()) {
            motion.program_of[other.signal] = Steps(frame_of(other, 3.0 / duration_s));
            motion.words += ", while " + signal.name +
                            Words(" steps slowly between # and # ", {other.low, other.high}) + signal.unit;
          } else {
            motion.program_of[other.signal] = Text("#", {other.rest});
            if (other.moved()) motion.words += ", with " + signal.name + Words(" at # ", {other.rest}) + signal.unit;
          }
        }
        motions.push_back(std::move(motion));
      }
  }
  return motions;
}

std::shared_ptr<identify::Series> SeriesOf(const Motion& motion, const PlantDescription& plant,
                                           const std::vector<double>& rest, std::size_t rows, double dt) {
  auto series = std::make_shared<identify::Series>();
  series->dt = dt;
  series->runs = {0};
  for (std::size_t n = 0; n < rows; ++n) series->t.push_back(dt * static_cast<double>(n));
  for (const double value : rest) series->signals.emplace_back(rows, value);
  for (const auto& [input, text] : motion.program_of) {
    std::vector<std::pair<std::size_t, std::size_t>> made;  // signal, order of its derivative
    std::size_t highest = 0;
    for (std::size_t s = 0; s < plant.signals.size(); ++s)
      if (const auto [root, order] = RootOf(plant, s); root == input) {
        made.emplace_back(s, order);
        highest = std::max(highest, order);
      }
    const std::optional<expression::FeatureProgram> program = WithDerivatives(text, highest);
    if (!program) return nullptr;
    std::vector<double> values(highest + 1);
    for (std::size_t n = 0; n < rows; ++n) {
      program->Evaluate({.signals = nullptr, .t = series->t[n], .dt = dt}, nullptr, values.data());
      for (const auto& [signal, order] : made) series->signals[signal][n] = values[order];
    }
  }
  return series;
}

}  // namespace armcmc::ladder
