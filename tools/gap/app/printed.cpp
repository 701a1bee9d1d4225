#include "printed.hpp"

#include <cstdio>
#include <sstream>

namespace armcmc::gap {
namespace {

std::string WithUnit(const std::string& number, const std::string& unit) {
  return unit.empty() ? number : number + " " + unit;
}

std::string WithSd(double value, double sd, const std::string& unit) {
  char text[64];
  std::snprintf(text, sizeof(text), "%.4g +- %.2g", value, sd);
  return WithUnit(text, unit);
}

/// The standard deviation of a confounded parameter is that of its prior: what it is confounded with stands instead.
void AddParameter(const std::string& effect, const ParameterEstimate& p, std::ostream& out) {
  out << "  " << effect << ' ' << p.name << " = ";
  if (p.confounded_with.empty()) {
    out << WithSd(p.mean, p.sd, p.unit) << '\n';
    return;
  }
  char value[32];
  std::snprintf(value, sizeof(value), "%.4g", p.mean);
  out << WithUnit(value, p.unit) << ", confounded with ";
  for (std::size_t i = 0; i < p.confounded_with.size(); ++i) out << (i == 0 ? "" : ", ") << p.confounded_with[i];
  out << '\n';
}

}  // namespace

std::string Summary(const Result& result) {
  std::ostringstream out;
  out << result.sentence << '\n';
  for (const EffectFinding& effect : result.effects)
    for (const ParameterEstimate& parameter : effect.parameters) AddParameter(effect.name, parameter, out);
  for (const Combination& c : result.determined)
    out << "  determined: " << c.text << " = " << WithSd(c.value, c.sd, c.unit) << '\n';
  if (result.gap.before.rmse > 0.0) {
    char line[200];
    std::snprintf(line, sizeof(line), "held-out rms error %.4g -> %.4g %s, noise floor %.4g, gap closed by %.1f %%\n",
                  result.gap.before.rmse, result.gap.after.rmse, result.gap.unit.c_str(), result.gap.noise_floor,
                  100.0 * result.gap.closed_fraction);
    out << line;
  }
  if (!result.separate_by.words.empty()) out << result.separate_by.words << '\n';
  for (const std::string& note : result.notes) out << "note: " << note << '\n';
  return out.str();
}

std::string LadderText(const Result& result) {
  std::ostringstream out;
  char line[240];
  std::snprintf(line, sizeof(line), "%-44s %12s %9s %12s\n", "", "error", "closed", "probability");
  out << line;
  std::snprintf(line, sizeof(line), "%-44s %12.4g\n", "base model", result.gap.before.rmse);
  out << line;
  for (const LadderRung& rung : result.ladder) {
    std::string names;
    for (const std::string& name : rung.effects) names += (names.empty() ? "+ " : " or ") + name;
    std::snprintf(line, sizeof(line), "%-44s %12.4g %7.1f %% %12.2f%s\n", names.c_str(), rung.heldout_error,
                  100.0 * rung.closed_fraction, rung.probability, rung.provisional ? "  (few events)" : "");
    out << line;
  }
  if (!result.gap.stretches.empty()) {
    std::snprintf(line, sizeof(line), "%-44s %12s %9s %12s\n", "held-out segment", "before", "after", "samples");
    out << line;
  }
  for (const SegmentFit& s : result.gap.stretches) {
    char when[48];
    std::snprintf(when, sizeof(when), "%.4g to %.4g s", s.from_s, s.until_s);
    std::snprintf(line, sizeof(line), "%-44s %12.4g %9.4g %12lld\n", when, s.rmse_before, s.rmse_after,
                  static_cast<long long>(s.samples));
    out << line;
  }
  return out.str();
}

}  // namespace armcmc::gap
