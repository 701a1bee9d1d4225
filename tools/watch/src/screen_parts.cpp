#include "screen_parts.hpp"

#include <algorithm>
#include <cmath>

#include "armcmc/support/text_table.hpp"
#include "armcmc/watch/names.hpp"

namespace armcmc::watch {
namespace {

using support::Significant;

constexpr int kLabel = 10;
constexpr int kLowScreen = 24;  // rows, of which none is left empty between the stages and the rest

std::string Ms(std::int64_t ns) { return Significant(1e-6 * static_cast<double>(ns), 4); }

std::string Percent(double share) { return Significant(100.0 * share, 3) + " %"; }

/// To a tenth of a percent: of what is improbable nobody wants to know how much.
std::string Probability(double p) { return Percent(1e-3 * std::round(1e3 * p)); }

/// One of a row of labelled values.
void Item(const std::string& name, const std::string& value, TextLine* line, Ink ink = Ink::kBold) {
  if (line->columns() > kLabel) line->Add("   ");
  line->Add(name + " ").Add(value, ink);
}

void Count(const std::string& name, std::int64_t value, TextLine* line, Ink when_not_zero = Ink::kWarning) {
  Item(name, std::to_string(value), line, value == 0 ? Ink::kBold : when_not_zero);
}

TextLine Begin(const std::string& label) {
  TextLine line;
  line.Add(label, Ink::kDim).To(kLabel);
  return line;
}

TextLine StageLine(const std::string& name, std::int64_t ns, const estimator_status_t& s, const View& view) {
  TextLine line = Begin(name);
  line.AddRight(HasStep(s) ? Ms(ns) : "-", 10, Ink::kBold).Add(" ms ");
  const int columns = std::clamp(view.columns - line.columns() - 24, 10, 60);
  const double share = static_cast<double>(ns) / static_cast<double>(std::max<std::int64_t>(s.deadline_ns, 1));
  const bool late = ns > s.deadline_ns;
  line.Add("|").Add(Bar(share, columns, view.glyphs), late ? Ink::kBad : Ink::kGood).Add("|");
  return line;
}

}  // namespace

std::string GapPlace(const estimator_status_t& status) {
  std::string place = FieldText(status.gap_where, 32);
  std::replace(place.begin(), place.end(), '_', ' ');
  return place;
}

void AddStages(const WatchState& state, const View& view, std::vector<TextLine>* lines) {
  const estimator_status_t& s = *state.status;
  lines->push_back(StageLine("collect", s.collect_ns, s, view));
  lines->push_back(StageLine("adjust", s.adjust_ns, s, view));
  lines->push_back(StageLine("execute", s.execute_ns, s, view));
  TextLine all = StageLine("total", s.end_to_end_ns, s, view);
  all.Add(" deadline " + Ms(s.deadline_ns) + " ms", Ink::kDim);
  lines->push_back(all);
  TextLine slack = Begin("slack");
  if (!HasStep(s)) {
    slack.AddRight("-", 10).Add(" no pack in this period", Ink::kDim);
  } else if (s.slack_ns < 0) {
    slack.AddRight(Ms(s.slack_ns), 10, Ink::kBad).Add(" ms ").Add("MISSED", Ink::kBad);
  } else {
    slack.AddRight(Ms(s.slack_ns), 10, Ink::kBold).Add(" ms");
  }
  slack.To(kLabel + 15).Add("total, recent   ", Ink::kDim);
  const int room = std::clamp(view.columns - slack.columns() - 1, 0, 80);
  slack.Add(Sparkline(state.end_to_end_ms.Newest(static_cast<std::size_t>(room)), view.glyphs), Ink::kGood);
  lines->push_back(slack);
  TextLine missed = Begin("missed");
  Count("own", s.missed_own, &missed, Ink::kBad);
  Count("machine", s.missed_machine, &missed);
  Count("late data", s.missed_late_data, &missed);
  Item("witness", Ms(s.witness_max_ns) + " ms late", &missed);
  lines->push_back(missed);
  if (view.rows > kLowScreen) lines->emplace_back();
}

void AddChangeProbabilities(const WatchState& state, const View& view, std::vector<TextLine>* lines) {
  if (!state.change) return;
  const change_t& c = *state.change;
  const int modes = std::clamp<int>(c.n_modes, 0, change_t::MAX_MODES);
  for (int m = 0; m < modes; ++m) {
    if (c.known[m] == 0) continue;
    TextLine line = Begin("posterior");
    if (modes > 1) line.AddLeft(FieldText(c.mode_name[m], 16), 10);
    Item("persisted", Probability(c.p_persisted[m]), &line);
    Item("drifted", Probability(c.p_drifted[m]), &line);
    Item("changed", Probability(c.p_changed[m]), &line, c.p_changed[m] > 0.5 ? Ink::kWarning : Ink::kBold);
    if (m == c.mode) {
      line.Add("   drifted, recent ", Ink::kDim);
      const int room = std::clamp(view.columns - line.columns() - 1, 0, 60);
      line.Add(Sparkline(state.drifted.Newest(static_cast<std::size_t>(room)), 0.0, 1.0, view.glyphs), Ink::kGood);
    }
    lines->push_back(line);
  }
}

void AddSampler(const WatchState& state, const View& view, std::vector<TextLine>* lines) {
  if (!state.estimate) return;
  const estimate_t& e = *state.estimate;
  TextLine sampler = Begin("sampler");
  Item("draws", std::to_string(e.draws) + " (least " + std::to_string(e.k_min) + ")", &sampler);
  Item("ESS", std::to_string(std::llround(e.ess)), &sampler);
  Item("Kish", std::to_string(std::llround(e.kish_ess)), &sampler);
  Item("acceptance", Percent(e.acceptance), &sampler);
  Count("cut steps", state.status->truncated_steps, &sampler);
  lines->push_back(sampler);
  TextLine change = Begin("change");
  const bool above = e.zeta_threshold > 0.0 && std::abs(e.zeta) > e.zeta_threshold;
  Item("zeta", Significant(e.zeta, 3) + (above ? " ABOVE " : " of ") + Significant(e.zeta_threshold, 3), &change,
       above ? Ink::kWarning : Ink::kBold);
  Item("lambda", Significant(e.lambda, 4), &change);
  Item("decision", DecisionName(e.decision), &change);
  change.Add("   zeta, recent ", Ink::kDim);
  const int room = std::clamp(view.columns - change.columns() - 1, 0, 60);
  change.Add(Sparkline(state.zeta.Newest(static_cast<std::size_t>(room)), view.glyphs), Ink::kGood);
  lines->push_back(change);
}

void AddData(const WatchState& state, std::vector<TextLine>* lines) {
  const estimator_status_t& s = *state.status;
  TextLine data = Begin("data");
  Item("received", std::to_string(s.packs_received), &data);
  Count("lost", s.packs_lost, &data);
  Count("duplicate", s.packs_duplicate, &data);
  Count("reordered", s.packs_reordered, &data);
  Count("dropped", s.packs_dropped, &data);
  Count("silent periods", s.silent_periods, &data);
  lines->push_back(data);
  TextLine bad = Begin("");
  Count("rejected", s.packs_rejected, &bad);
  bad.Add(" (size " + std::to_string(s.rejected_size) + ", type " + std::to_string(s.rejected_type) + ", value " +
          std::to_string(s.rejected_value) + ")");
  Count("publish errors", s.publish_errors, &bad);
  Count("plant restarts", s.plant_restarts, &bad);
  lines->push_back(bad);
  TextLine gap = Begin("gap");
  // Before the first step nobody knows whether it is on.
  if (s.gap_watched == 0 && s.step > 0) {
    gap.Add("not watched", Ink::kDim);
  } else if (s.gap_check < 0 || s.gap_watched == 0) {
    gap.Add("no data judged yet", Ink::kDim);
  } else {
    gap.Add(s.gap_suspected != 0 ? "SUSPECTED" : "no", s.gap_suspected != 0 ? Ink::kBad : Ink::kBold);
    Item("evidence", Significant(s.gap_log_evidence, 3) + " of " + Significant(s.gap_log_threshold, 3) + " nats", &gap);
    gap.Add(s.gap_suspected != 0 ? "   " : "   nearest: ", Ink::kDim).Add(GapPlace(s), Ink::kDim);
  }
  lines->push_back(gap);
}

}  // namespace armcmc::watch
