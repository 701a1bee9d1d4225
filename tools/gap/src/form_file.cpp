#include "armcmc/gap/form_file.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <utility>

#include "armcmc/expression/check.hpp"
#include "armcmc/gap/features.hpp"
#include "armcmc/gap/form_tools.hpp"
#include "armcmc/gap/sensor_forms.hpp"
#include "armcmc/support/strict_toml.hpp"
#include "form_formula.hpp"

namespace armcmc::embedded {
std::string_view ContactForms() noexcept;
std::string_view BendingForms() noexcept;
std::string_view ValveFlowForms() noexcept;
}  // namespace armcmc::embedded

namespace armcmc::gap {
namespace {

using support::StrictTable;

constexpr double kHuge = 1e300;
constexpr std::size_t kMostCoordinates = 12;
constexpr int kMostStarts = 100;

/// Values of all coordinates and, after them, the origin.
using Values = std::array<double, kMostCoordinates + 1>;

/// What sizes are measured in.
class Scales {
 public:
  Scales(const Signals& s, const std::map<std::string, double>& constants) {
    Add("dt", s.dt);
    Add("record", s.duration);
    Add("output", s.output_scale);
    for (std::size_t r = 0; r < kNumRoles; ++r) Add(kFormSignals[r], s.scale[r]);
    for (const auto& [name, value] : constants) Add(name, value);
  }

  [[nodiscard]] double Of(StrictTable* table, const std::string& key, double fallback) const {
    if (!table->Has(key)) return fallback;
    if (!table->IsText(key)) return table->RequiredNumber(key, -kHuge, kHuge);
    try {
      const expression::Syntax syntax = expression::Parse(table->RequiredText(key));
      (void)expression::Check(syntax, scope_);
      expression::Graph graph;
      const int node = graph.Lower(syntax, scope_, {});
      if (graph.IsNumber(node) && std::isfinite(graph.at(node).value)) return graph.at(node).value;
    } catch (const expression::Error& error) {
      throw table->ErrorInText(key, error.column(), error.what());
    }
    throw table->Error(key, "expected a size that is a number");
  }

 private:
  void Add(const std::string& name, double value) {
    expression::Symbol symbol;
    symbol.name = name;
    symbol.kind = expression::SymbolKind::kConstant;
    symbol.value = value;
    symbol.range = {value, value};
    scope_.Add(std::move(symbol));
  }

  expression::Scope scope_;
};

void ReadEnds(StrictTable* table, Coordinate* coordinate) {
  coordinate->event = table->Boolean("event", false);
  const std::string stop = table->Choice("stop", "", {"", "above", "below", "both"});
  coordinate->other_above = stop == "above" || stop == "both";
  coordinate->other_below = stop == "below" || stop == "both";
}

Coordinate ReadAmplitude(StrictTable* table, const Scales& scales) {
  const std::string name = table->RequiredText("name"), unit = table->RequiredText("unit");
  const double size = scales.Of(table, "size", 1.0), upper = scales.Of(table, "upper", 3.0);
  Coordinate amplitude = AmplitudeOf(name.c_str(), unit.c_str(), size, table->Boolean("positive", false),
                                     scales.Of(table, "sd", 0.2), upper);
  amplitude.lower = scales.Of(table, "lower", amplitude.lower);
  amplitude.prior_mean = scales.Of(table, "mean", 0.0);
  ReadEnds(table, &amplitude);
  return amplitude;
}

Coordinate ReadShape(StrictTable* table, const Scales& scales) {
  if (!table->Has("from")) return ReadAmplitude(table, scales);
  const std::string name = table->RequiredText("name"), unit = table->RequiredText("unit");
  Coordinate shape = ShapeOf(name.c_str(), unit.c_str(), scales.Of(table, "size", 1.0), scales.Of(table, "from", 1.0),
                             scales.Of(table, "to", 1.0));
  shape.prior_mean = scales.Of(table, "mean", shape.prior_mean);
  shape.prior_sd = scales.Of(table, "sd", shape.prior_sd);
  ReadEnds(table, &shape);
  return shape;
}

Slot SlotOf(const std::string& slot) {
  if (slot == "elastic") return Slot::kMemory;
  if (slot == "input") return Slot::kInputMap;
  if (slot == "drive") return Slot::kDrive;
  if (slot == "parameter") return Slot::kParameter;
  return slot == "rate" ? Slot::kForce : Slot::kAdditive;
}

/// @param shape  Coordinates after the first `amplitudes`, whose values no column needs.
Values ValuesOf(const std::vector<Coordinate>& coordinates, int amplitudes, const double* shape, const Signals& in) {
  Values values{};
  const auto first = static_cast<std::size_t>(amplitudes);
  for (std::size_t c = first; c < coordinates.size(); ++c) values[c] = coordinates[c].Value(shape[c - first]);
  values[coordinates.size()] = in.origin;
  return values;
}

void SetFunctions(FormFormula* formula, const std::string& of, EffectForm* form) {
  if (form->slot == Slot::kForce) {
    const auto program = formula->Whole();
    form->force = [program](const Motion& m, const double* v, const double* z) { return program->At(m, v, z); };
    if (program->has_states())
      form->remember = [program](const Motion& m, const double* v, double* z) { program->Remember(m, v, z); };
    return;
  }
  const std::vector<Coordinate> all = form->coordinates;
  const int amplitudes = form->num_amplitudes;
  if (form->slot == Slot::kDrive) {
    formula->TakeOff("u");
    const auto program = formula->Whole();
    form->features = [program, all](const Signals& in, const double* shape) -> Matrix {
      return program->Over(in, nullptr, ValuesOf(all, 0, shape, in).data())[0];
    };
    return;
  }
  if (form->slot == Slot::kInputMap) formula->TakeFrom(of);
  const auto columns = formula->Columns(amplitudes);
  if (form->slot == Slot::kMemory) {
    form->filter = [columns, all, amplitudes](const Signals& in, const Vector& series, int a, const double* shape) {
      const auto k = static_cast<std::size_t>(a);
      return Vector(all[k].unit_size * columns[k]->Over(in, &series, ValuesOf(all, amplitudes, shape, in).data())[0]);
    };
    return;
  }
  form->features = [columns, all, amplitudes](const Signals& in, const double* shape) {
    const Values values = ValuesOf(all, amplitudes, shape, in);
    Matrix out(in.rows(), amplitudes);
    for (std::size_t a = 0; a < columns.size(); ++a)
      out.col(static_cast<Eigen::Index>(a)) = all[a].unit_size * columns[a]->Over(in, nullptr, values.data())[0];
    return out;
  };
}

void ReadStarts(StrictTable* table, EffectForm* form) {
  form->starts.clear();
  form->find_starts = nullptr;
  const std::string line = table->Choice("start_at_line", "", {"", "whole", "parts"});
  const auto amplitudes = static_cast<std::size_t>(form->num_amplitudes);
  if (!line.empty()) {
    form->find_starts = [amplitudes, parts = line == "parts"](const Signals& in, const Vector& residual) {
      std::vector<std::vector<double>> starts;
      const auto add = [&](double frequency) {
        starts.emplace_back(amplitudes, 0.0);
        starts.back().push_back(std::log(frequency));
      };
      const double least = 3.0 / in.duration;
      add(std::max(StrongestLine(residual, in.dt).frequency, least));
      // One that begins or ends is lost in the spectrum of the whole.
      const Eigen::Index part = residual.size() / 4;
      for (const Vector& some : {Vector(residual.head(part)), Vector(residual.tail(part))})
        if (const Line strongest = StrongestLine(some, in.dt); parts && strongest.frequency > least)
          add(strongest.frequency);
      return starts;
    };
    return;
  }
  if (table->Has("start_at")) {
    form->starts = table->NumberLists("start_at", form->coordinates.size(), -kHuge, kHuge);
    return;
  }
  const std::size_t shapes = form->coordinates.size() - amplitudes;
  std::vector<int> counts;
  for (const double count : table->Numbers("starts", {}, shapes, shapes, 1.0, kMostStarts))
    counts.push_back(static_cast<int>(count));
  if (counts.size() != shapes) throw table->Error("starts", "expected as many numbers as there are shapes");
  SetStarts(form, counts);
}

std::vector<EffectForm> SensorForms(const std::string& sensor, const Signals& signals) {
  if (sensor == "saturation") return SaturationForms(signals);
  if (sensor == "dead_zone") return {DeadZoneForm(signals)};
  std::vector<EffectForm> latency = LatencyForms(signals);
  if (sensor == "latency") return latency;
  return {latency[sensor == "delay" ? 0 : 1]};
}

void ReadWords(StrictTable* table, EffectForm* form) {
  form->effect = table->Text("effect", form->effect);
  form->family = table->Text("family", form->family);
  form->formula = table->Text("text", form->formula);
  form->listed = table->Boolean("listed", form->listed);
  if (table->Has("own_groups")) form->own_groups = table->Texts("own_groups");
}

/// What a variant has from the form of its effect: all but the functions and the formula.
EffectForm VariantOf(const EffectForm& form, const std::string& variant) {
  EffectForm other = form;
  other.variant = variant;
  other.formula.clear();
  other.features = nullptr;
  other.force = nullptr;
  other.remember = nullptr;
  other.filter = nullptr;
  other.sense = nullptr;
  return other;
}

/// @param before  Forms of the file up to this one.
EffectForm ReadForm(StrictTable* table, const Signals& signals, const Scales& scales,
                    const std::map<std::string, double>& constants, const std::vector<EffectForm>& before) {
  EffectForm form;
  if (const std::string variant = table->Text("variant", ""); !variant.empty()) {
    if (before.empty()) throw table->Error("variant", "expected it after the form of its effect");
    form = VariantOf(before.back(), variant);
  }
  ReadWords(table, &form);
  if (form.effect.empty() || form.family.empty() || form.formula.empty())
    throw table->Error("effect", "expected effect, family and text");
  const std::string slot = table->RequiredChoice("slot", {"output", "elastic", "input", "drive", "parameter", "rate"});
  form.slot = SlotOf(slot);
  if (table->Has("amplitudes") || table->Has("shapes")) {
    form.coordinates.clear();
    for (StrictTable& amplitude : table->Tables("amplitudes"))
      form.coordinates.push_back(ReadAmplitude(&amplitude, scales));
    form.num_amplitudes = static_cast<int>(form.coordinates.size());
    for (StrictTable& shape : table->Tables("shapes")) form.coordinates.push_back(ReadShape(&shape, scales));
    ReadStarts(table, &form);
  }
  if (form.coordinates.empty() || form.coordinates.size() > kMostCoordinates)
    throw table->Error("amplitudes", "expected 1 to 12 amplitudes and shapes");
  if ((form.num_amplitudes == 0) != (form.slot == Slot::kDrive))
    throw table->Error("amplitudes", "expected amplitudes, and none in the slot drive");
  form.linear = form.slot != Slot::kInputMap && form.slot != Slot::kDrive;
  form.plain_error = table->Text("plain_error", form.plain_error);
  form.from_surface = table->Boolean("from_surface", form.from_surface);
  form.gates_by_mode = table->Boolean("gates_by_mode", form.gates_by_mode);
  form.gates_by_time = table->Boolean("gates_by_time", form.gates_by_time);
  FormFormula formula(table, form.coordinates, signals, constants);
  SetFunctions(&formula, table->Choice("of", "x", {"x", "p"}), &form);
  return form;
}

}  // namespace

std::vector<EffectForm> FormsFromText(std::string_view text, std::string_view name, const Signals& signals,
                                      const std::map<std::string, double>& constants) {
  StrictTable root = StrictTable::FromText(text, name);
  root.RequireSchema();
  const Scales scales(signals, constants);
  std::vector<EffectForm> forms;
  for (StrictTable& table : root.Tables("form")) {
    if (!table.Has("sensor")) {
      forms.push_back(ReadForm(&table, signals, scales, constants, forms));
      continue;
    }
    for (EffectForm& form :
         SensorForms(table.RequiredChoice("sensor", {"delay", "lag", "latency", "saturation", "dead_zone"}), signals)) {
      ReadWords(&table, &form);
      forms.push_back(std::move(form));
    }
  }
  root.Finish();
  return forms;
}

std::vector<EffectForm> FormsFor(std::string_view law, const Signals& signals,
                                 const std::map<std::string, double>& constants) {
  static const std::map<std::string_view, std::string_view> files = {{"contact", embedded::ContactForms()},
                                                                     {"bending", embedded::BendingForms()},
                                                                     {"valve_flow", embedded::ValveFlowForms()}};
  return FormsFromText(files.at(law), std::string(law) + ".toml", signals, constants);
}

}  // namespace armcmc::gap
