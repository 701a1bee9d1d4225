#include "plant_text.hpp"

#include <cmath>
#include <memory>

#include "armcmc/plant/program.hpp"
#include "armcmc/support/printable.hpp"
#include "armcmc/support/text_table.hpp"

namespace armcmc::model {
namespace {

using support::Significant;
using support::TextTable;

std::string OrDash(const std::string& text) { return text.empty() ? "-" : text; }

std::string SignalsText(const Plant& plant) {
  TextTable table({"signal", "unit", "role", "where a recording lacks it", "between samples"},
                  TextTable::Content::kWords);
  const auto& signals = plant.description().signals;
  for (std::size_t s = 0; s < signals.size(); ++s) {
    const SignalDescription& signal = signals[s];
    const bool is_output = static_cast<int>(s) == plant.output();
    table.AddRow({signal.name + (is_output ? "  (output)" : ""), signal.unit, OrDash(signal.role),
                  signal.derivative_of.empty() ? "-" : "rate of " + signal.derivative_of, signal.between});
  }
  return table.ToString();
}

std::string PriorText(const ParameterDescription& p) {
  if (p.prior == "uniform") return "uniform";
  if (p.prior == "lognormal")
    return "lognormal, median " + Significant(p.mean, 4) + ", sd of the logarithm " + Significant(p.sd, 3);
  return Significant(p.mean, 4) + " +- " + Significant(p.sd, 3);
}

std::string ParametersText(const Plant& plant) {
  TextTable table({"parameter", "unit", "prior", "lower", "upper", "per mode"}, TextTable::Content::kWords);
  for (const ParameterDescription& p : plant.description().parameters)
    table.AddRow(
        {p.name, p.unit, PriorText(p), Significant(*p.lower, 4), Significant(*p.upper, 4), p.per_mode ? "yes" : "-"});
  return table.ToString();
}

std::string LetsText(const Plant& plant) {
  TextTable table({"name", "stands for"}, TextTable::Content::kWords);
  for (const ConstantDescription& c : plant.description().constants)
    table.AddRow({c.name, Significant(c.value, 12) + (c.unit.empty() ? "" : ' ' + c.unit)});
  for (const LetDescription& let : plant.description().lets) table.AddRow({let.name, let.text});
  return table.ToString();
}

std::string StatesText(const Plant& plant) {
  TextTable table({"state", "unit", "rate", "start", "substeps", "each pack starts from"}, TextTable::Content::kWords);
  for (const StateDescription& s : plant.description().states)
    table.AddRow({s.name, s.unit, s.rate, s.start, std::to_string(s.substeps), OrDash(s.measured_by)});
  return table.ToString();
}

std::string ModesText(const Plant& plant) {
  TextTable table({"mode", "when", "explains", "unit", "law"}, TextTable::Content::kWords);
  const PlantDescription& description = plant.description();
  const std::string& output_unit = description.signals[static_cast<std::size_t>(plant.output())].unit;
  if (description.modes.empty()) {
    table.AddRow({"-", "always", description.output, output_unit, description.law});
  }
  for (std::size_t m = 0; m < description.modes.size(); ++m) {
    const ModeDescription& mode = description.modes[m];
    const auto& unit = plant.modes()[m].target_unit;
    const std::string when = mode.when.empty() ? (m == 0 ? "always" : "otherwise") : mode.when;
    if (mode.passive) {
      table.AddRow({mode.name, when, "nothing: carries no information", "-", OrDash(mode.law)});
    } else {
      const bool is_output = mode.target.empty();
      table.AddRow({mode.name, when, is_output ? description.output : mode.target,
                    is_output ? output_unit
                    : unit    ? unit->Text()
                              : "not checked",
                    mode.law});
    }
  }
  return table.ToString();
}

std::string NoiseText(const Plant& plant) {
  const NoiseDescription& noise = plant.description().noise;
  return "noise: " + noise.law + ", standard deviation " + Significant(noise.std, 4) +
         (noise.estimate ? ", estimated along with the parameters" : "") + '\n';
}

std::string EstimatorText(const Plant& plant) {
  std::string text = "the estimator samples";
  try {
    const PlantProgram program(std::make_shared<const Plant>(plant));
    for (std::size_t d = 0; d < program.sampled().size(); ++d)
      text += (d == 0 ? " " : ", ") + program.sampled()[d].name;
    const int modes = program.info().num_modes;
    text += modes > 1 ? ", in each of " + std::to_string(modes) + " modes apart\n" : "\n";
  } catch (const PlantError& error) {
    return std::string("the estimator does not run it: ") + error.what() + '\n';
  }
  return text;
}

}  // namespace

std::string PlantText(const Plant& plant) {
  const PlantDescription& description = plant.description();
  std::string text = description.name + ": " + support::Printable(description.title, 200) + "\n\n" +
                     SignalsText(plant) + '\n' + ParametersText(plant) + '\n' + ModesText(plant);
  if (!description.constants.empty() || !description.lets.empty()) text += '\n' + LetsText(plant);
  if (!description.states.empty()) text += '\n' + StatesText(plant);
  if (!description.predicts.empty())
    text += "\nshown as prediction of " + description.output + ": " + description.predicts + '\n';
  for (const ReportDescription& report : description.reports)
    text += "\nalso reported: " + report.name + " [" + report.unit + "] = " + report.value + '\n';
  return text + '\n' + NoiseText(plant) + EstimatorText(plant);
}

}  // namespace armcmc::model
