#include "armcmc/watch/screen.hpp"

#include <algorithm>

#include "armcmc/rt/lcm_url.hpp"
#include "armcmc/support/text_table.hpp"
#include "armcmc/watch/names.hpp"
#include "screen_parts.hpp"

namespace armcmc::watch {
namespace {

using support::Significant;

TextLine Title(const WatchState& state) {
  TextLine line;
  line.Add("ARMCMC", Ink::kBold).Add("  " + state.prefix + rt::kStatusChannel + " on " + state.url, Ink::kDim);
  return line;
}

TextLine Progress(const WatchState& state) {
  const estimator_status_t& s = *state.status;
  TextLine line;
  line.Add("step " + std::to_string(s.step), Ink::kBold).Add("  pack " + std::to_string(s.last_seq));
  line.Add("  period " + Significant(1e-6 * static_cast<double>(s.period_ns), 4) + " ms");
  if (state.period_s > 0.0) line.Add("  " + Significant(1.0 / state.period_s, 3) + " messages/s");
  if (state.estimate) line.Add("  mode ").Add(ModeName(state.estimate->plant_kind, state.estimate->mode), Ink::kBold);
  return line;
}

std::string Warned(const std::string& text, const View& view) {
  return (view.glyphs == Glyphs::kUnicode ? "⚠ " : "! ") + text;
}

void Alarm(const std::string& text, const View& view, std::vector<TextLine>* lines) {
  TextLine line;
  line.Add(" ", Ink::kAlarm).Add(Warned(text, view), Ink::kAlarm).Add(" ", Ink::kAlarm);
  lines->push_back(line);
}

void Warning(const std::string& text, const View& view, std::vector<TextLine>* lines) {
  TextLine line;
  line.Add(Warned(text, view), Ink::kWarning);
  lines->push_back(line);
}

void AddAlarms(const WatchState& state, const View& view, double now_s, std::vector<TextLine>* lines) {
  const estimator_status_t& s = *state.status;
  if (now_s - state.status_s > kStale_s) {
    Warning("no EST_STATUS for " + Significant(now_s - state.status_s, 2) + " s: what is shown is old", view, lines);
  }
  if (s.degraded_flags != 0) Alarm("DEGRADED: " + Joined(DegradedWords(s.degraded_flags)), view, lines);
  if (s.gap_suspected != 0) {
    Alarm("MODEL GAP: the model is missing something: " + GapPlace(s) + ", since pack " +
              std::to_string(s.gap_since_seq) + "; armcmc-gap finds out what",
          view, lines);
  }
  if (state.held_faults != 0) Warning("faults: " + Joined(FaultWords(state.held_faults)), view, lines);
  if (state.bus.foreign + state.bus.undecodable > 0) {
    Warning(std::to_string(state.bus.foreign) + " messages of a foreign type, " +
                std::to_string(state.bus.undecodable) + " undecodable: does another version publish here?",
            view, lines);
  }
}

}  // namespace

std::string WaitingText(const WatchState& state) {
  return "waiting for " + state.prefix + rt::kStatusChannel + " on " + state.url +
         ": is the estimator running? same URL and prefix?";
}

std::vector<TextLine> Lines(const WatchState& state, const View& view, double now_s) {
  std::vector<TextLine> lines;
  lines.push_back(Title(state));
  if (!state.status) {
    Warning(WaitingText(state), view, &lines);
    TextLine since;
    since.Add("for " + Significant(now_s - state.started_s, 3) + " s; ", Ink::kDim);
    since.Add(std::to_string(state.bus.foreign) + " messages of a foreign type, " +
                  std::to_string(state.bus.undecodable) + " undecodable",
              Ink::kDim);
    lines.push_back(since);
  } else {
    lines.push_back(Progress(state));
    AddAlarms(state, view, now_s, &lines);
    lines.emplace_back();
    AddParameters(state, view, &lines);
    AddStages(state, view, &lines);
    AddSampler(state, view, &lines);
    AddChangeProbabilities(state, view, &lines);
    AddData(state, &lines);
  }
  TextLine keys;
  keys.Add("q or Ctrl-C: quit", Ink::kDim);
  lines.push_back(keys);
  return lines;
}

std::string Render(const WatchState& state, const View& view, double now_s) {
  const std::vector<TextLine> lines = Lines(state, view, now_s);
  const std::size_t shown = std::min(lines.size(), static_cast<std::size_t>(std::max(view.rows, 1)));
  std::string text;
  for (std::size_t i = 0; i < shown; ++i) {
    if (i > 0) text += '\n';
    text += lines[i].Text(view.columns, view.colour);
  }
  return text;
}

}  // namespace armcmc::watch
