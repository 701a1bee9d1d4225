#include "armcmc/stress/flight_recorder.hpp"

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <stdexcept>

#include "armcmc/stress/fault_catalog.hpp"

namespace armcmc::stress {
namespace {

constexpr const char* kColumns =
    "  time_ms    pack  collect   adjust  execute  end_to_end    slack  witness  "
    "+own +machine +late +dropped +truncated +rejected  flags\n";

double Milliseconds(std::int64_t ns) { return static_cast<double>(ns) * 1e-6; }

}  // namespace

void FlightRecorder::Add(const estimator_status_t& now) {
  const auto rise = [&](std::int64_t estimator_status_t::*counter) {
    return static_cast<long long>(now.*counter - last_.*counter);
  };
  using S = estimator_status_t;
  char line[256];
  const int length = std::snprintf(
      line, sizeof line, "%9.2f %7lld %8.3f %8.3f %8.3f %11.3f %8.3f %8.3f %5lld %8lld %5lld %8lld %10lld %9lld  ",
      Milliseconds(now.t_status_ns - last_.t_status_ns), static_cast<long long>(now.last_seq),
      Milliseconds(now.collect_ns), Milliseconds(now.adjust_ns), Milliseconds(now.execute_ns),
      Milliseconds(now.end_to_end_ns), Milliseconds(now.slack_ns), Milliseconds(now.witness_max_ns),
      rise(&S::missed_own), rise(&S::missed_machine), rise(&S::missed_late_data), rise(&S::packs_dropped),
      rise(&S::truncated_steps), rise(&S::packs_rejected));
  lines_.emplace_back(line, static_cast<std::size_t>(std::clamp<int>(length, 0, sizeof line - 1)));
  lines_.back() += FlagNames(now.fault_flags) + "\n";
  if (lines_.size() > kStatuses) lines_.pop_front();
  last_ = now;
}

void FlightRecorder::Write(const std::string& heading, std::size_t most) {
  if (++reports_ > kMostReports) return;
  std::ofstream out(file_, std::ios::app);
  out << heading << "\n" << kColumns;
  for (std::size_t i = lines_.size() - std::min(most, lines_.size()); i < lines_.size(); ++i) out << lines_[i];
  out << (reports_ == kMostReports ? "\nFurther ones are not written.\n" : "\n") << std::flush;
  if (!out) throw std::runtime_error("cannot write " + file_.string());
}

}  // namespace armcmc::stress
