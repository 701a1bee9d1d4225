#include "armcmc/stress/plant_runs.hpp"

#include <algorithm>
#include <cmath>
#include <csignal>
#include <utility>

#include "armcmc/rt/clock.hpp"

namespace armcmc::stress {
namespace {

constexpr int kPollMs = 10;
constexpr double kPlantStartMs = 3000.0;  // a loaded machine may take that long to start a process

Nanos ToNanos(double ms) { return static_cast<Nanos>(ms * static_cast<double>(rt::kNanosPerMilli)); }

}  // namespace

PlantRuns::PlantRuns(Context context, FaultLayout layout) : context_(std::move(context)), layout_(std::move(layout)) {}

const FaultSpec* PlantRuns::Selected(const char* name) const {
  const auto& all = context_.options->faults;
  const auto found =
      std::find_if(all.begin(), all.end(), [name](const FaultSpec* fault) { return std::string(fault->name) == name; });
  return found != all.end() ? *found : nullptr;
}

void PlantRuns::Start(const std::string& plan, std::vector<Slot> slots, bool log_fails) {
  const StressOptions& options = *context_.options;
  if (ended_by_ != nullptr) {
    Slot restart{ended_by_, 1 - Slot::kQuietBefore, 0};
    const double recovery_packs = std::ceil(150.0 / options.period_ms);
    restart.end = std::min<std::int64_t>(LearningPacks(options.period_ms) - 1,
                                         std::max<std::int64_t>(9, static_cast<std::int64_t>(recovery_packs)));
    slots.insert(slots.begin(), restart);
  }
  std::vector<std::string> command = {(options.programs / "armcmc-plant").string(),
                                      "--scenario",
                                      context_.scenario.string(),
                                      "--lcm-url",
                                      context_.lcm_url,
                                      "--prefix",
                                      options.prefix};
  if (!plan.empty()) command.insert(command.end(), {"--inject", plan});
  if (log_fails) command.insert(command.end(), {"--log", "/dev/full"});
  context_.judge->BeginRun(std::move(slots));
  if (log_failure_reported_) context_.judge->LogFailureReported();
  ended_by_ = nullptr;
  log_failure_reported_ = false;
  handled_ = nullptr;
  context_.bus->BeginRun();
  plant_ = std::make_unique<Child>(command, options.work / "plant.log");
}

void PlantRuns::Supervise(double most_ms) {
  const Nanos end_ns = rt::MonotonicNow() + ToNanos(most_ms + kPlantStartMs);
  while (!context_.judge->finished() && rt::MonotonicNow() < end_ns && plant_->running()) {
    context_.bus->Poll(kPollMs, context_.judge);
    DriveSignals();
    context_.tick();
    if (!context_.estimator->running()) {
      estimator_died_ = true;
      break;
    }
  }
  if (active_ != nullptr) EndSignal(*active_);
}

void PlantRuns::DriveSignals() {
  if (active_ != nullptr) {
    if (rt::MonotonicNow() >= active_until_ns_) EndSignal(*active_);
    return;
  }
  const Slot* slot = context_.judge->current();
  if (slot == nullptr || slot == handled_ || slot->fault->source != FaultSource::kSignal) return;
  if (!context_.judge->run_started() || context_.bus->newest_pack() < slot->at()) return;
  handled_ = slot;
  BeginSignal(*slot->fault);
}

void PlantRuns::BeginSignal(const FaultSpec& fault) {
  context_.judge->SignalBegins();
  const std::string name = fault.name;
  if (name == "plant_stop") plant_->Signal(SIGSTOP);
  if (name == "estimator_stop") context_.estimator->Signal(SIGSTOP);
  if (name == "bus_flood") {
    const std::string self = std::filesystem::read_symlink("/proc/self/exe").string();
    flood_ =
        std::make_unique<Child>(std::vector<std::string>{self, "--generate", "flood", "--lcm-url", context_.lcm_url},
                                context_.options->work / "flood.log");
  }
  active_ = &fault;
  active_since_ns_ = rt::MonotonicNow();
  active_until_ns_ = active_since_ns_ + ToNanos(fault.LastsMs(context_.options->period_ms));
}

void PlantRuns::EndSignal(const FaultSpec& fault) {
  const std::string name = fault.name;
  std::int64_t over = 0;
  if (name == "plant_stop") {
    plant_->Signal(SIGCONT);
    // It sends at once what it owes, and what falls due meanwhile: those packs belong to the fault.
    constexpr double kCatchingUp = 0.2;  // of the time that it stood
    const double stood_ms = static_cast<double>(rt::MonotonicNow() - active_since_ns_) / 1e6;
    over = static_cast<std::int64_t>(std::ceil((1.0 + kCatchingUp) * stood_ms / context_.options->period_ms));
  }
  if (name == "estimator_stop") context_.estimator->Signal(SIGCONT);
  flood_.reset();
  context_.bus->Poll(1, context_.judge);
  context_.judge->SignalEnds(context_.bus->newest_pack() + over);
  active_ = nullptr;
}

void PlantRuns::Pause(double ms) {
  for (const Nanos end_ns = rt::MonotonicNow() + ToNanos(ms); rt::MonotonicNow() < end_ns;) {
    if (!context_.estimator->running()) return;
    context_.bus->Poll(kPollMs, context_.judge);
    context_.tick();
  }
}

void PlantRuns::RunWithFaults() {
  const FaultSpec* full = Selected("log_disk_full");
  Start(layout_.plant_plan, layout_.slots, full != nullptr);
  Supervise(static_cast<double>(layout_.last_pack + 10) * context_.options->period_ms * 1.2 + 2000.0);
  plant_->Signal(SIGTERM);
  plant_->Wait(10'000);
  if (full != nullptr) {
    ended_by_ = full;
    log_failure_reported_ = plant_->exit_code() == 1 && plant_->output().find("disk full") != std::string::npos;
  }
  Pause(3.0 * context_.options->period_ms);
}

void PlantRuns::RunQuietly(double ms) {
  Start("", {}, false);
  Pause(ms);
  plant_->Signal(SIGTERM);
  plant_->Wait(10'000);
  estimator_died_ = !context_.estimator->running();
}

void PlantRuns::RunShortly() {
  Start("", {}, false);
  const double wanted_ms = 12.0 * context_.options->period_ms + 500.0;
  Supervise(wanted_ms);
  Pause(3.0 * context_.options->period_ms);
  plant_->Signal(SIGKILL);
  plant_->Wait(1000);
  ended_by_ = Selected("plant_death");
  Pause(std::max(3.0 * context_.options->period_ms, 50.0));
}

}  // namespace armcmc::stress
