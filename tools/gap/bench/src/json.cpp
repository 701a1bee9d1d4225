#include <cmath>
#include <nlohmann/json.hpp>

#include "armcmc/gap/result_json.hpp"
#include "armcmc/gap_bench/plant.hpp"
#include "armcmc/gap_bench/report.hpp"
#include "armcmc/gap_bench/summary.hpp"

namespace armcmc::gap_bench {
namespace {

using nlohmann::json;

json CaseJson(const Outcome& o) {
  std::string plant = "armcmc-plant", tool = "armcmc-gap --data " + o.what.Name() + ".csv --out " + o.what.Name();
  for (const std::string& argument : PlantProcess::Arguments(o.what)) plant += " " + argument;
  if (o.what.earlier) tool += " --earlier " + o.what.earlier->Name() + ".csv";
  if (o.what.model != Case{}.model) tool += " --model " + o.what.model;
  for (const std::string& name : o.what.without) tool += " --without " + name;
  json effects = json::array();
  for (const TrueEffect& effect : o.truth.effects) {
    json one = {{"name", effect.name}, {"variant", effect.variant}, {"kind", effect.kind}, {"gate", effect.gate}};
    for (const auto& [name, value] : effect.parameters) one["parameters"][name] = value;
    effects.push_back(std::move(one));
  }
  json out = {{"stratum", o.what.stratum},   {"group", o.what.group}, {"seed", o.what.seed},
              {"strength", o.what.strength}, {"plant", plant},        {"tool", tool},
              {"grade", GradeName(o.grade)}, {"truth", effects}};
  if (o.what.part != Part::kWhole) out["part"] = PartName(o.what.part);
  if (!o.answer.error.empty()) out["error"] = o.answer.error;
  if (o.grade == Grade::kNotMade || o.grade == Grade::kFailed) return out;
  for (const auto& [name, value] : o.truth.base_parameters) out["base_parameters"][name] = value;
  const gap::Result& r = o.answer.result;
  json answer = gap::ToJson(r);
  for (const char* key : {"verdict", "effects", "ambiguous_set", "gap", "parameters"})
    if (answer.contains(key)) out["answer"][key] = answer[key];
  out["answer"]["sentence"] = r.sentence;
  out["label"] = {{"text", o.label}, {"probability", o.label_probability}, {"right", o.label_right}};
  out["cpu_s"] = o.answer.cpu_s;
  if (o.onset_error_s) out["onset_error_s"] = *o.onset_error_s;
  if (o.onset_off_s) out["onset_off_s"] = *o.onset_off_s;
  if (o.diagnosed_strength) out["diagnosed_strength"] = *o.diagnosed_strength;
  if (o.model_error) out["model_error"] = *o.model_error;
  if (o.first_rung) out["first_rung"] = *o.first_rung;
  if (o.when_right) out["when_right"] = *o.when_right;
  if (o.equation_right) out["equation_right"] = *o.equation_right;
  return out;
}

}  // namespace

json ToJson(const std::vector<Outcome>& outcomes, std::uint64_t seed) {
  json out = {{"schema", 1}, {"seed", seed}};
  for (const Row& row : Rows(outcomes)) {
    json one = {{"stratum", row.stratum}, {"group", row.group}, {"n", row.counted()}};
    for (int g = 0; g < kNumGrades; ++g) one[GradeName(static_cast<Grade>(g))] = row.of(static_cast<Grade>(g));
    out["strata"].push_back(std::move(one));
  }
  for (const Gate& gate : Gates(outcomes))
    out["gates"].push_back({{"stratum", gate.stratum},
                            {"metric", gate.metric},
                            {"value", gate.value},
                            {"limit", gate.limit},
                            {"at_least", gate.at_least},
                            {"n", gate.n},
                            {"passed", gate.passed()}});
  const Onsets onsets = LocateOnsets(outcomes);
  if (onsets.n > 0)
    out["onset"] = {{"n", onsets.n},
                    {"dated", onsets.dated},
                    {"within_20_ms", onsets.within_20_ms},
                    {"within_200_ms", onsets.within_200_ms},
                    {"within_200_ms_of_the_truth", onsets.off_within_200_ms},
                    {"median_s", onsets.median_s},
                    {"quantile90_s", onsets.quantile90_s}};
  const Calibration calibration = Calibrate(outcomes);
  out["calibration"] = {{"expected_error", calibration.error}, {"n", calibration.n}};
  for (const Bin& bin : calibration.bins)
    out["calibration"]["bins"].push_back(
        {{"low", bin.low}, {"high", bin.high}, {"n", bin.n}, {"printed", bin.printed}, {"right", bin.right}});
  const Confusion confusion = Confuse(outcomes);
  out["confusion"] = {{"names", confusion.names}, {"answers", confusion.answers}, {"count", confusion.count}};
  for (const Outcome& outcome : outcomes) out["cases"].push_back(CaseJson(outcome));
  return out;
}

}  // namespace armcmc::gap_bench
