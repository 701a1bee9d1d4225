#include "armcmc/log_export/meaning.hpp"

#include <array>
#include <cctype>
#include <sstream>
#include <utility>

#include "armcmc/models/registry.hpp"
#include "armcmc/support/strict_toml.hpp"

namespace armcmc::embedded {
std::string_view ColumnTable() noexcept;
}

namespace armcmc::log_export {
namespace {

constexpr std::array<std::pair<std::string_view, Axis>, 6> kAxes = {{{"parameter", Axis::kParameter},
                                                                     {"mode", Axis::kMode},
                                                                     {"sample", Axis::kSample},
                                                                     {"input", Axis::kInput},
                                                                     {"bin", Axis::kBin},
                                                                     {"text", Axis::kText}}};

std::vector<std::string> Words(const std::string& text) {
  std::istringstream in(text);
  std::vector<std::string> words;
  for (std::string word; in >> word;) words.push_back(word);
  return words;
}

FieldMeaning ReadField(support::StrictTable& fields, const std::string& name) {
  const std::string text = fields.RequiredText(name);
  const std::size_t bar = text.find('|');
  FieldMeaning meaning;
  const std::vector<std::string> unit = Words(text.substr(0, bar));
  for (const std::string& word : unit) meaning.unit += (meaning.unit.empty() ? "" : " ") + word;
  if (bar == std::string::npos) return meaning;
  for (const std::string& word : Words(text.substr(bar + 1))) {
    bool known = false;
    for (const auto& [axis, value] : kAxes)
      if (axis == word) meaning.axes.push_back(value), known = true;
    if (!known) throw fields.Error(name, "unknown axis " + word);
  }
  return meaning;
}

PlantWords WordsOf(const ModelInfo& model) {
  const CompiledPlant& plant = *model.compiled;
  PlantWords words;
  words.output = plant.output.name;
  words.output_unit = plant.output.unit;
  words.target_unit = model.target_unit;
  words.extended_target_unit = plant.rate_unit;
  for (std::size_t i = 0; i < static_cast<std::size_t>(model.num_inputs); ++i) {
    words.inputs.emplace_back(plant.inputs[i].name);
    words.input_units.emplace_back(plant.inputs[i].unit);
  }
  for (std::size_t r = 0; r < static_cast<std::size_t>(model.num_reported); ++r) {
    words.parameters.emplace_back(model.reported[r].name);
    words.parameter_units.emplace_back(model.reported[r].unit);
  }
  for (std::size_t m = 0; m < static_cast<std::size_t>(model.num_modes); ++m) words.modes.emplace_back(model.modes[m]);
  return words;
}

}  // namespace

std::map<std::string, TypeMeaning> ReadMeanings(std::string_view toml) {
  auto root = support::StrictTable::FromText(toml, "columns.toml");
  root.RequireSchema();
  std::map<std::string, TypeMeaning> meanings;
  for (const std::string& type : root.Keys()) {
    if (type == "schema") continue;
    support::StrictTable table = root.Table(type);
    TypeMeaning& meaning = meanings[type];
    meaning.channel = table.RequiredText("channel");
    meaning.row_per_sample = table.Choice("rows", "message", {"message", "sample"}) == "sample";
    meaning.repeat = Words(table.Text("repeat", ""));
    support::StrictTable fields = table.Table("fields");
    for (const std::string& field : fields.Keys()) meaning.fields[field] = ReadField(fields, field);
  }
  root.Finish();
  return meanings;
}

const std::map<std::string, TypeMeaning>& Meanings() {
  static const std::map<std::string, TypeMeaning> meanings = ReadMeanings(embedded::ColumnTable());
  return meanings;
}

PlantWords WordsOf(int plant_kind) {
  const ModelInfo* model = ModelOf(PlantNumber{plant_kind});
  return model != nullptr ? WordsOf(*model) : PlantWords{"y", "", "", {}, {}, {}, {}, {}, ""};
}

std::string ColumnUnit(std::string_view unit) {
  if (unit == "-") return "";
  std::string text;
  if (unit.substr(0, 2) == "1/") unit.remove_prefix(1);
  for (std::size_t at = 0; at < unit.size(); ++at) {
    if (unit[at] != '/') {
      text.push_back(unit[at]);
      continue;
    }
    if (!text.empty()) text.push_back(' ');
    // The divisor is one symbol, or several in parentheses, with an exponent or without.
    std::size_t end = at + 1;
    if (const std::size_t closing = unit.find(')', end);
        unit.substr(end, 1) == "(" && closing != std::string_view::npos) {
      text.append("(").append(ColumnUnit(unit.substr(end + 1, closing - end - 1))).append(")");
      end = closing + 1;
    } else {
      while (end < unit.size() && (std::isalpha(static_cast<unsigned char>(unit[end])) != 0)) ++end;
      text.append(unit.substr(at + 1, end - at - 1));
    }
    if (end < unit.size() && unit[end] == '^') {
      text.append("^-");
      at = end;
    } else {
      text.append("^-1");
      at = end - 1;
    }
  }
  return text;
}

}  // namespace armcmc::log_export
