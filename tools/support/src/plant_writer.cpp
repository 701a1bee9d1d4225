#include "armcmc/support/plant_writer.hpp"

#include <algorithm>
#include <cctype>
#include <sstream>
#include <vector>

#include "armcmc/support/csv.hpp"

namespace armcmc::support {
namespace {

std::string Quoted(const std::string& text) {
  constexpr const char* kHex = "0123456789abcdef";
  std::string quoted = "\"";
  for (const char c : text) {
    const auto code = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      quoted += '\\';
      quoted += c;
    } else if (code < 0x20 || code == 0x7f) {
      quoted += "\\u00";
      quoted += kHex[code >> 4U];
      quoted += kHex[code & 15U];
    } else {
      quoted += c;
    }
  }
  return quoted + '"';
}

/// A TOML float: one that looks like an integer would be read as one, and may be too great for it.
std::string Number(double value) {
  std::string text = ExactNumber(value);
  if (text.find_first_of(".e") == std::string::npos) text += ".0";
  return text;
}

/// { key = value, .. } in the order in which keys are added.
class Inline {
 public:
  Inline& Text(const char* key, const std::string& value) { return value.empty() ? *this : Raw(key, Quoted(value)); }
  Inline& Value(const char* key, double value) { return Raw(key, Number(value)); }
  Inline& Value(const char* key, const std::optional<double>& value) { return value ? Value(key, *value) : *this; }
  Inline& Raw(const char* key, const std::string& value) {
    text_ += (text_.empty() ? "{ " : ", ") + std::string(key) + " = " + value;
    return *this;
  }
  [[nodiscard]] std::string Closed() const { return text_.empty() ? "{}" : text_ + " }"; }

 private:
  std::string text_;
};

void Line(std::ostringstream* out, const std::string& key, const std::string& value) {
  *out << key << " = " << value << '\n';
}

void TextLine(std::ostringstream* out, const std::string& key, const std::string& value) {
  if (!value.empty()) Line(out, key, Quoted(value));
}

std::string ParameterText(const ParameterDescription& p) {
  Inline at;
  at.Text("unit", p.unit);
  if (p.prior != "normal") at.Text("prior", p.prior);
  if (p.prior != "uniform") at.Value("mean", p.mean).Value("sd", p.sd);
  at.Value("lower", p.lower).Value("upper", p.upper);
  if (p.per_mode) at.Raw("per_mode", "true");
  return at.Closed();
}

void WriteModes(const PlantDescription& plant, std::ostringstream* out) {
  if (!plant.law.empty()) return;  // Plant() fills the only mode in
  for (const ModeDescription& mode : plant.modes) {
    *out << "\n[[mode]]\n";
    TextLine(out, "name", mode.name);
    TextLine(out, "when", mode.when);
    if (mode.passive) Line(out, "passive", "true");
    TextLine(out, "target", mode.target);
    TextLine(out, "law", mode.law);
  }
}

void WriteStates(const PlantDescription& plant, std::ostringstream* out) {
  if (!plant.states.empty()) *out << "\n[states]\n";
  for (const StateDescription& state : plant.states) {
    Inline at;
    at.Text("unit", state.unit).Text("role", state.role).Text("start", state.start).Text("rate", state.rate);
    at.Text("measured_by", state.measured_by);
    if (state.substeps != 1) at.Raw("substeps", std::to_string(state.substeps));
    Line(out, state.name, at.Closed());
  }
}

}  // namespace

std::string PlantFileText(const PlantDescription& plant, const std::string& comment) {
  std::ostringstream out;
  std::istringstream lines(comment);
  for (std::string line; std::getline(lines, line);) out << "# " << line << '\n';
  out << "schema = 1\n";
  Line(&out, "name", Quoted(plant.name));
  TextLine(&out, "title", plant.title);
  Line(&out, "output", Quoted(plant.output));
  TextLine(&out, "law", plant.law);
  TextLine(&out, "predicts", plant.predicts);
  out << "\n[signals]\n";
  for (const SignalDescription& s : plant.signals)
    Line(&out, s.name,
         Inline()
             .Text("unit", s.unit)
             .Text("role", s.role)
             .Text("derivative_of", s.derivative_of)
             .Text("between", s.between == "linear" ? "" : s.between)
             .Closed());
  if (!plant.constants.empty()) out << "\n[constants]\n";
  for (const ConstantDescription& c : plant.constants)
    Line(&out, c.name,
         c.unit.empty() ? Number(c.value) : Inline().Value("value", c.value).Text("unit", c.unit).Closed());
  out << "\n[parameters]\n";
  for (const ParameterDescription& p : plant.parameters) Line(&out, p.name, ParameterText(p));
  if (!plant.lets.empty()) out << "\n[let]\n";
  for (const LetDescription& let : plant.lets) Line(&out, let.name, Quoted(let.text));
  WriteModes(plant, &out);
  WriteStates(plant, &out);
  if (!plant.reports.empty()) out << "\n[report]\n";
  for (const ReportDescription& r : plant.reports)
    Line(&out, r.name, Inline().Text("unit", r.unit).Text("value", r.value).Closed());
  out << "\n[noise]\n";
  Line(&out, "law", Quoted(plant.noise.law));
  Line(&out, "std", Number(plant.noise.std));
  if (plant.noise.estimate) Line(&out, "estimate", "true");
  return out.str();
}

}  // namespace armcmc::support
