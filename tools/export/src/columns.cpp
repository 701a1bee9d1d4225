#include "armcmc/log_export/columns.hpp"

#include <algorithm>

#include "armcmc/log_export/meaning.hpp"

namespace armcmc::log_export {
namespace {

std::string NameOr(const std::vector<std::string>& names, std::size_t i, const char* otherwise) {
  return i < names.size() && !names[i].empty() ? names[i] : otherwise + std::to_string(i);
}

std::string UnitOr(const std::vector<std::string>& units, std::size_t i) {
  return i < units.size() ? ColumnUnit(units[i]) : "";
}

std::string Inverse(const std::string& unit) {
  return unit.empty() ? std::string() : std::string("(").append(unit).append(")^-1");
}

std::string PerSecond(const std::string& unit) { return unit.empty() ? "s^-1" : unit + " s^-1"; }

/// What the plant's numbers are called: by its packs where they say so.
PlantWords WordsFor(const PlantScan& plant) {
  PlantWords words = WordsOf(plant.plant_kind);
  if (!plant.modes.empty()) words.modes = plant.modes;
  if (plant.output.empty()) return words;
  words.output = plant.output;
  words.output_unit = words.target_unit = plant.output_unit;
  words.inputs = plant.inputs;
  words.input_units = plant.input_units;
  return words;
}

/// Builds the columns of one type, field by field.
class Builder {
 public:
  Builder(const ChannelScan& channel, const PlantScan& plant, const TypeMeaning& meaning)
      : channel_(channel), plant_(plant), words_(WordsFor(plant)), meaning_(meaning) {}

  void Add(const MessageField& field, std::vector<Column>* columns) const {
    const auto found = meaning_.fields.find(field.name);
    const FieldMeaning what = found == meaning_.fields.end() ? FieldMeaning{} : found->second;
    const bool per_sample = !what.axes.empty() && what.axes[0] == Axis::kSample;
    const bool repeated =
        std::find(meaning_.repeat.begin(), meaning_.repeat.end(), field.name) != meaning_.repeat.end();
    if (meaning_.row_per_sample && !per_sample && !repeated) return;
    const bool text = !what.axes.empty() && what.axes.back() == Axis::kText;
    if (text && field.dims.size() > 1) return;  // names of parameters and modes: they stand in the headers
    Column column;
    column.field = &field;
    column.text = text;
    column.path = {field.name};
    Walk(what, field, 0, ColumnUnit(what.unit), column, columns);
  }

 private:
  [[nodiscard]] std::size_t Used(Axis axis, int size) const {
    const auto limit = [size](int used) { return static_cast<std::size_t>(used > 0 ? std::min(used, size) : size); };
    switch (axis) {
      case Axis::kParameter: return limit(channel_.num_parameters);
      case Axis::kMode: return limit(plant_.num_modes);
      case Axis::kInput: return limit(plant_.num_inputs);
      case Axis::kSample:
      case Axis::kText: return 1;
      case Axis::kBin: break;
    }
    return limit(channel_.num_bins);
  }

  /// One dimension after the other; the last one emits the column.
  void Walk(const FieldMeaning& what, const MessageField& field, std::size_t dim, const std::string& unit,
            const Column& so_far, std::vector<Column>* columns) const {
    if (dim == field.dims.size()) {
      Column column = so_far;
      column.unit = Resolved(unit);
      for (const std::string& name : column.path) column.header.append(column.header.empty() ? "" : ".").append(name);
      if (!column.unit.empty()) column.header.append(" [").append(column.unit).append("]");
      columns->push_back(column);
      return;
    }
    std::size_t stride = 1;
    for (std::size_t d = dim + 1; d < field.dims.size(); ++d) stride *= static_cast<std::size_t>(field.dims[d]);
    const Axis axis = dim < what.axes.size() ? what.axes[dim] : Axis::kBin;
    for (std::size_t i = 0; i < Used(axis, field.dims[dim]); ++i) {
      Column next = so_far;
      std::string next_unit = unit;
      next.index += i * stride;
      switch (axis) {
        case Axis::kSample:
          next.sample_stride = stride;
          if (what.unit == "output") next.path = {field.name == "y_true" ? words_.output + "_true" : words_.output};
          break;
        case Axis::kInput:
          next.path = {NameOr(words_.inputs, i, "u")};
          next_unit = UnitOr(words_.input_units, i);
          break;
        case Axis::kParameter:
          next.path.push_back(ParameterName(plant_, i));
          if (what.unit == "parameter") next_unit = ParameterUnit(plant_, i);
          if (what.unit == "1/parameter") next_unit = Inverse(ParameterUnit(plant_, i));
          if (what.unit == "parameter/s") next_unit = PerSecond(ParameterUnit(plant_, i));
          break;
        case Axis::kMode: next.path.push_back(NameOr(words_.modes, i, "mode")); break;
        case Axis::kBin:
          next.path.push_back(std::to_string(i));
          next.bin = true;
          break;
        case Axis::kText: break;
      }
      Walk(what, field, dim + 1, next_unit, next, columns);
    }
  }

  [[nodiscard]] std::string Resolved(const std::string& unit) const {
    if (unit == "output") return ColumnUnit(words_.output_unit);
    // With effects the estimator fits another output of the plant.
    const bool extended =
        !words_.extended_target_unit.empty() &&
        std::any_of(plant_.parameters.begin(), plant_.parameters.end(), [&](const std::string& name) {
          return std::find(words_.parameters.begin(), words_.parameters.end(), name) == words_.parameters.end();
        });
    if (unit == "target") return ColumnUnit(extended ? words_.extended_target_unit : words_.target_unit);
    return unit;
  }

  const ChannelScan& channel_;
  const PlantScan& plant_;
  PlantWords words_;
  const TypeMeaning& meaning_;
};

}  // namespace

std::string ParameterName(const PlantScan& plant, std::size_t i) {
  const auto& names = plant.parameters.empty() ? WordsOf(plant.plant_kind).parameters : plant.parameters;
  return NameOr(names, i, "parameter");
}

std::string ParameterUnit(const PlantScan& plant, std::size_t i) {
  return UnitOr(plant.parameters.empty() ? WordsOf(plant.plant_kind).parameter_units : plant.units, i);
}

std::vector<Column> ColumnsOf(const ChannelScan& channel, const PlantScan& plant) {
  static const TypeMeaning nothing_known;
  const auto found = Meanings().find(channel.type->name);
  const Builder builder(channel, plant, found == Meanings().end() ? nothing_known : found->second);
  std::vector<Column> columns;
  for (const MessageField& field : channel.type->fields) builder.Add(field, &columns);
  return columns;
}

}  // namespace armcmc::log_export
