#include "armcmc/gap/result_json.hpp"

#include <cmath>

#include "armcmc/plots/html.hpp"

namespace armcmc::gap {
namespace {

using nlohmann::json;

json Number(double value) { return std::isfinite(value) ? json(value) : json(); }
json Text(const std::string& text) { return plots::ValidUtf8(text); }

json Texts(const std::vector<std::string>& texts) {
  json out = json::array();
  for (const std::string& text : texts) out.push_back(Text(text));
  return out;
}

template <class T, class Function>
json List(const std::vector<T>& items, Function to_json) {
  json out = json::array();
  for (const T& item : items) out.push_back(to_json(item));
  return out;
}

json WhenJson(const When& when) {
  switch (when.kind) {
    case When::Kind::kContact: return "contact";
    case When::Kind::kFree: return "free";
    case When::Kind::kFrom: return {{"from_s", Number(when.time_s)}};
    case When::Kind::kUntil: return {{"until_s", Number(when.time_s)}};
    case When::Kind::kAlways: break;
  }
  return "always";
}

json ParameterJson(const ParameterEstimate& p) {
  json out = {{"mean", Number(p.mean)}, {"sd", Number(p.sd)}, {"unit", Text(p.unit)}};
  if (!p.confounded_with.empty()) out["confounded_with"] = Texts(p.confounded_with);
  return out;
}

json CombinationJson(const Combination& c) {
  return {{"combination", Text(c.text)},
          {"parameters", Texts(c.parameters)},
          {"mean", Number(c.value)},
          {"sd", Number(c.sd)},
          {"unit", Text(c.unit)}};
}

json EffectJson(const EffectFinding& e) {
  json parameters = json::object();
  for (const ParameterEstimate& p : e.parameters) parameters[plots::ValidUtf8(p.name)] = ParameterJson(p);
  return {{"name", Text(e.name)},        {"probability", Number(e.probability)},
          {"parameters", parameters},    {"when", WhenJson(e.when)},
          {"family", Text(e.family)},    {"formula", e.approximate ? "approximate" : "exact"},
          {"provisional", e.provisional}};
}

json CandidateJson(const CandidateScore& c) {
  return {{"effects", Texts(c.effects)},
          {"log_evidence", Number(c.log_evidence)},
          {"heldout_score", Number(c.heldout_score)},
          {"probability", Number(c.probability)},
          {"closed_fraction", Number(c.closed_fraction)}};
}

json WhereJson(const Where& w) {
  return {{"feature", Text(w.feature)},
          {"region", Text(w.region)},
          {"share_of_excess_error", Number(w.share_of_excess)},
          {"effect_size", Number(w.effect_size)},
          {"p_value", Number(w.p_value)}};
}

json FitJson(const Fit& fit) {
  return {{"rmse", Number(fit.rmse)},
          {"mae", Number(fit.mae)},
          {"worst_1_percent", Number(fit.worst_1_percent)},
          {"coverage95", Number(fit.coverage95)},
          {"whiteness", Number(fit.whiteness)}};
}

json GapJson(const GapSummary& gap) {
  json modes = json::object();
  for (const ModeFit& m : gap.modes)
    modes[plots::ValidUtf8(m.mode)] = {
        {"samples", m.samples}, {"rmse_before", Number(m.rmse_before)}, {"rmse_after", Number(m.rmse_after)}};
  json stretches = json::array();
  for (const SegmentFit& s : gap.stretches)
    stretches.push_back({{"from_s", Number(s.from_s)},
                         {"until_s", Number(s.until_s)},
                         {"samples", s.samples},
                         {"rmse_before", Number(s.rmse_before)},
                         {"rmse_after", Number(s.rmse_after)}});
  return {{"heldout_rmse_before", Number(gap.before.rmse)},
          {"heldout_rmse_after", Number(gap.after.rmse)},
          {"noise_floor", Number(gap.noise_floor)},
          {"closed_fraction", Number(gap.closed_fraction)},
          {"unit", Text(gap.unit)},
          {"closed_fraction_95", {Number(gap.closed_low), Number(gap.closed_high)}},
          {"gap_ratio", Number(gap.gap_ratio)},
          {"before", FitJson(gap.before)},
          {"after", FitJson(gap.after)},
          {"modes", modes},
          {"stretches", stretches},
          {"negative_control",
           {{"effects", Text(gap.control_effects)}, {"closed_fraction", Number(gap.control_closed_fraction)}}}};
}

json ParametersJson(const std::vector<ParameterChange>& changes) {
  json before = json::object(), after = json::object();
  for (const ParameterChange& change : changes) {
    before[plots::ValidUtf8(change.before.name)] = ParameterJson(change.before);
    after[plots::ValidUtf8(change.after.name)] = ParameterJson(change.after);
  }
  return {{"before", before}, {"after", after}};
}

json SparseJson(const SparseTerm& t) {
  return {{"expression", Text(t.expression)}, {"coefficient", Number(t.coefficient)}, {"share", Number(t.share)}};
}

json RungJson(const LadderRung& r) {
  return {{"effects", Texts(r.effects)},
          {"closed_fraction", Number(r.closed_fraction)},
          {"heldout_error", Number(r.heldout_error)},
          {"probability", Number(r.probability)},
          {"remainder_ratio", Number(r.remainder_ratio)},
          {"provisional", r.provisional}};
}

json PublishedJson(const PublishedFigure& p) {
  return {{"what", Text(p.what)}, {"value", Number(p.value)}, {"source", Text(p.source)}};
}

json BudgetJson(const Budget& b) {
  // null, not zero, if it was not measured.
  return {{"measured", b.measured},
          {"adjust_ms_before", b.measured ? Number(b.adjust_ms_before) : json()},
          {"adjust_ms_after", b.measured ? Number(b.adjust_ms_after) : json()},
          {"deadline_ms", b.measured ? Number(b.deadline_ms) : json()},
          {"meets_deadline", b.measured ? json(b.meets_deadline) : json()}};
}

json ConstancyJson(const Constancy& s) {
  if (!s.known()) return {};
  json stretches = json::array();
  for (std::size_t k = 0; k < s.course.x.size(); ++k)
    stretches.push_back({{"t_s", Number(s.course.x[k])},
                         {"value", Number(s.course.y[k])},
                         {"low95", Number(s.course.low[k])},
                         {"high95", Number(s.course.high[k])}});
  return {{"mean", Number(s.mean)},
          {"moves_by", Number(s.moves_by)},
          {"p_value", Number(s.p_value)},
          {"constant", s.constant},
          {"stretches", stretches}};
}

json DriftJson(const std::vector<ParameterDrift>& drift) {
  json out = json::object();
  for (const ParameterDrift& p : drift)
    out[plots::ValidUtf8(p.name)] = {
        {"unit", Text(p.unit)}, {"before", ConstancyJson(p.before)}, {"after", ConstancyJson(p.after)}};
  return out;
}

json OneStepScoreJson(const OneStepScore& all, const OneStepScore& apart) {
  const auto scores = [](const OneStepScore& s) -> json {
    return {{"samples", s.samples},
            {"rmse", Number(s.rmse)},
            {"coverage95", Number(s.coverage95)},
            {"half_width95", Number(s.half_width)}};
  };
  json out = scores(all);
  out["kept_apart"] = scores(apart);
  return out;
}

json OneStepJson(const Result& result) {
  const RunAlong& run = result.run;
  if (!run.done) return {};
  return {{"unit", Text(result.gap.unit)},
          {"ahead_s", Number(run.pack_s)},
          {"before", OneStepScoreJson(run.before, run.before_apart)},
          {"after", run.has_after ? OneStepScoreJson(run.after, run.after_apart) : json()}};
}

std::string SeparateBy(const Experiment& e) {
  if (e.scenario_file.empty()) return plots::ValidUtf8(e.words);
  return plots::ValidUtf8(e.words + (e.words.empty() ? "" : " ") + "(scenario file: " + e.scenario_file + ")");
}

}  // namespace

std::string_view Name(Verdict verdict) noexcept {
  switch (verdict) {
    case Verdict::kNamed: return "named";
    case Verdict::kAmbiguous: return "ambiguous";
    case Verdict::kUnnamed: return "unnamed";
    case Verdict::kNone: break;
  }
  return "none";
}

json ToJson(const Result& result) {
  json out;
  out["schema"] = 1;
  out["program"] = Text("armcmc-gap " + result.version);
  out["verdict"] = Name(result.verdict);
  out["equation"] = Text(result.equation);
  out["sentence"] = Text(result.sentence);
  out["probability"] = {{"none", Number(result.probability_none)}, {"unnamed", Number(result.probability_unnamed)}};
  out["effects"] = List(result.effects, EffectJson);
  out["ambiguous_set"] = List(result.ambiguous_set, Texts);
  out["separate_by"] = SeparateBy(result.separate_by);
  out["experiment"] = {{"words", Text(result.separate_by.words)},
                       {"scenario_file", Text(result.separate_by.scenario_file)},
                       {"nats", Number(result.separate_by.nats)}};
  out["candidates"] = List(result.candidates, CandidateJson);
  out["where"] = List(result.where, WhereJson);
  out["aliases"] = Texts(result.aliases);
  out["sparse"] = List(result.sparse, SparseJson);
  out["ladder"] = List(result.ladder, RungJson);
  out["complete"] = result.complete;
  out["remainder"] = {{"share", Number(result.remainder.share)},
                      {"where", List(result.remainder.where, WhereJson)},
                      {"sparse", List(result.remainder.sparse, SparseJson)}};
  out["published"] = List(result.published, PublishedJson);
  out["relative_error"] = {{"before", Number(result.relative_before)}, {"after", Number(result.relative_after)}};
  out["gap"] = GapJson(result.gap);
  out["parameters"] = ParametersJson(result.parameters);
  out["determined"] = List(result.determined, CombinationJson);
  out["drift"] = DriftJson(result.drift);
  out["one_step"] = OneStepJson(result);
  out["budget"] = BudgetJson(result.budget);
  out["model"] = Text(result.model);
  out["model_file"] = Text(result.model_file);
  out["data"] = {{"file", Text(result.data_file)},
                 {"sha256", Text(result.data_sha256)},
                 {"rows", result.rows},
                 {"dt_s", Number(result.dt)}};
  out["seed"] = result.seed;
  out["notes"] = Texts(result.notes);
  out["seconds"] = json::object();
  for (const auto& [step, seconds] : result.seconds) out["seconds"][plots::ValidUtf8(step)] = Number(seconds);
  return out;
}

}  // namespace armcmc::gap
