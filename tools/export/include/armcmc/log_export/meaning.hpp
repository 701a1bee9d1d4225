#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace armcmc::log_export {

/// What a dimension of an array counts.
enum class Axis { kParameter, kMode, kSample, kInput, kBin, kText };

/// What the numbers of a field are.
struct FieldMeaning {
  std::string unit;  ///< SI, or "parameter", "output", "input", "target", "1/parameter", "parameter/s"; empty: none.
  std::vector<Axis> axes;
};

/// How the messages of a type become rows (lcm_types/columns.toml).
struct TypeMeaning {
  std::string channel;              ///< Without prefix.
  bool row_per_sample = false;      ///< Else one row a message.
  std::vector<std::string> repeat;  ///< Fields that stand on every row, when there are several a message.
  std::map<std::string, FieldMeaning> fields;
};

/// By name of the type. @throws support::ConfigError naming the line.
[[nodiscard]] std::map<std::string, TypeMeaning> ReadMeanings(std::string_view toml);

/// Of the released types.
[[nodiscard]] const std::map<std::string, TypeMeaning>& Meanings();

/// What a plant kind calls its numbers: data_pack_t.PLANT_*. Unknown kinds get numbers for names and no units.
struct PlantWords {
  std::string output, output_unit, target_unit;
  std::vector<std::string> inputs, input_units, parameters, parameter_units, modes;
  std::string extended_target_unit;  ///< Where a model has other parameters besides; empty: the same.
};
[[nodiscard]] PlantWords WordsOf(int plant_kind);

/// A unit without "/", which PlotJuggler takes for a folder: "N s/m^(p+1)" becomes "N s m^-(p+1)", "-" becomes "".
[[nodiscard]] std::string ColumnUnit(std::string_view unit);

}  // namespace armcmc::log_export
