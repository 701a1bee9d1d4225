#include "event_printer.hpp"

#include <cstdio>

#include "armcmc/rt/clock.hpp"
#include "armcmc/rt/deadline_monitor.hpp"
#include "armcmc/rt/injection.hpp"
#include "armcmc/rt/pack_codec.hpp"
#include "armcmc/rt/watchdog.hpp"
#include "armcmc/status.hpp"

namespace armcmc::app {
namespace {

using rt::EventKind;

std::string Millis(Nanos ns) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3f ms", static_cast<double>(ns) / static_cast<double>(rt::kNanosPerMilli));
  return text;
}

std::string Cause(std::uint8_t detail) { return std::string(rt::ToString(static_cast<rt::MissCause>(detail))); }

const char* KindName(std::size_t kind) {
  switch (static_cast<EventKind>(kind)) {
    case EventKind::kPackRejected: return "rejected packs";
    case EventKind::kPacksLost: return "gaps in the pack numbers";
    case EventKind::kDeadlineMissed: return "missed deadlines";
    case EventKind::kPackDropped: return "dropped packs";
    case EventKind::kNumericTrouble: return "numeric troubles";
    case EventKind::kPublishFailed: return "failed publications";
    case EventKind::kPlantRestarted: return "restarts of the plant";
    case EventKind::kGapSuspected: return "suspected gaps";
    case EventKind::kClockJumped: return "jumps of the plant's clock";
    case EventKind::kBusFlooded: return "floods of the bus";
    case EventKind::kStageHung: return "hung stages";
    case EventKind::kInjected: return "injected faults";
    default: return "events";
  }
}

std::string Count(std::int64_t n, const char* what) { return std::to_string(n) + " " + what + (n == 1 ? "" : "s"); }

/// Lines that every user wants; the others only with --verbose.
bool IsShownByDefault(EventKind kind) { return kind != EventKind::kPacksLost && kind != EventKind::kPackDropped; }

}  // namespace

std::string EventText(const rt::Event& event, const GapCheckNames& gap_check) {
  const std::string a = std::to_string(event.a);
  switch (event.kind) {
    case EventKind::kWaitingForPlant: return "waiting for the plant";
    case EventKind::kPlantFirstSeen: return "plant found, first pack " + a;
    case EventKind::kPlantSilent: return "plant has been silent since pack " + a;
    case EventKind::kPlantBack: return "plant is back with pack " + a + " after " + Count(event.b, "silent period");
    case EventKind::kPlantRestarted:
      return "plant was restarted (pack " + a + "); continuing from the current posterior";
    case EventKind::kPackRejected:
      return "pack rejected: " + std::string(rt::ToString(static_cast<rt::RejectCause>(event.a)));
    case EventKind::kPacksLost: return Count(event.a, "pack") + " lost before pack " + std::to_string(event.b);
    case EventKind::kDeadlineMissed:
      return "deadline of pack " + a + " missed by " + Millis(event.b) + ", cause: " + Cause(event.detail);
    case EventKind::kPackDropped: return "pack " + a + " dropped, too late to be used, cause: " + Cause(event.detail);
    case EventKind::kNumericTrouble:
      return "pack " + a + ": " + std::string(ToString(static_cast<Status>(event.detail))) + ", what was known is kept";
    case EventKind::kPublishFailed: return "publishing failed, " + a + " times so far";
    case EventKind::kGapSuspected:
      return "GAP SUSPECTED: the model is missing something since pack " + a +
             (gap_check ? ", seen in " + gap_check(event.detail) : "");
    case EventKind::kClockJumped: return "the plant's clock jumped by " + Millis(event.b) + " at pack " + a;
    case EventKind::kBusFlooded: return "the bus is flooded: " + Count(event.a, "message") + " of other channels";
    case EventKind::kStageHung:
      return "stage " + std::string(rt::ToString(static_cast<rt::Watched>(event.detail))) + " hangs: overdue by " +
             Millis(event.a);
    case EventKind::kInjected:
      return "INJECTED " + std::string(rt::ToString(static_cast<rt::InjectionKind>(event.detail))) + " at pack " + a;
    case EventKind::kOverlapDiffers:
      return "packs come every " + Count(event.a, "sample") + ", but [timing] overlap implies every " +
             std::to_string(event.b) +
             (event.a < event.b ? ": samples are counted more than once" : ": packs of a recursion leave samples out");
  }
  return "unknown event";
}

void EventPrinter::Line(Nanos t_ns, const std::string& text) {
  char time[32];
  std::snprintf(time, sizeof time, "[%9.3f s] ",
                static_cast<double>(t_ns - start_ns_) / static_cast<double>(rt::kNanosPerSecond));
  out_ << time << plant_ << (plant_.empty() ? "" : ": ") << text << '\n' << std::flush;
}

void EventPrinter::Print(const rt::Event& event) {
  if (!verbose_ && !IsShownByDefault(event.kind)) return;
  const auto kind = static_cast<std::size_t>(event.kind);
  if (printed_[kind] >= kMaxPerSecond) {
    ++held_back_[kind];
    return;
  }
  ++printed_[kind];
  Line(event.t_ns, EventText(event, gap_check_));
}

void EventPrinter::PrintHeldBack(Nanos now_ns) {
  for (std::size_t kind = 0; kind < held_back_.size(); ++kind) {
    if (held_back_[kind] > 0) Line(now_ns, std::to_string(held_back_[kind]) + " more " + KindName(kind));
    printed_[kind] = held_back_[kind] = 0;
  }
}

}  // namespace armcmc::app
