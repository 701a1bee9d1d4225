#include "armcmc/rt/pipeline.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "armcmc/estimator_status_t.hpp"
#include "armcmc/rt/clock.hpp"
#include "armcmc/rt/process_setup.hpp"
#include "armcmc/rt/warm_up.hpp"

namespace armcmc::rt {

std::vector<std::string> DegradedNames(std::int32_t flags) {
  std::vector<std::string> names;
  if ((flags & estimator_status_t::DEGRADED_NO_FIFO) != 0) names.emplace_back("no_fifo");
  if ((flags & estimator_status_t::DEGRADED_NO_AFFINITY) != 0) names.emplace_back("no_affinity");
  if ((flags & estimator_status_t::DEGRADED_NO_MLOCK) != 0) names.emplace_back("no_mlock");
  if ((flags & estimator_status_t::DEGRADED_SHARED_CPU) != 0) names.emplace_back("shared_cpu");
  if ((flags & estimator_status_t::DEGRADED_NO_WITNESS) != 0) names.emplace_back("no_witness");
  if ((flags & estimator_status_t::DEGRADED_INJECTED) != 0) names.emplace_back("injected_faults");
  if ((flags & estimator_status_t::DEGRADED_CPUS_SLEEP) != 0) names.emplace_back("cpus_sleep");
  return names;
}

Pipeline::Pipeline(const RtSettings& settings, StepEngine* engine, const PipelineOptions& options)
    : settings_((settings.Validate(), settings)),
      options_(options),
      engine_(engine),
      monitor_(settings_),
      receiver_(ParseLcmUrl(settings_.lcm_url), settings_.prefix + engine->pack_format().channel()),
      publisher_(ParseLcmUrl(settings_.lcm_url), settings_.prefix),
      collect_(settings_, engine->pack_format(), &packs_, &counters_, &events_[0]),
      adjust_(settings_, engine, &packs_, &results_, &monitor_, &counters_, &events_[1]),
      execute_(engine, &results_, &outputs_, &monitor_, &counters_, &events_[2]),
      publish_(settings_, engine, &outputs_, &publisher_, &monitor_, &counters_, &events_[3]),
      watchdog_(settings_, &events_[4]) {
  publish_.SetWatchdog(&watchdog_);
  if (options_.injection != nullptr) {
    options_.injection->SetEventLogs({&events_[0], &events_[1], &events_[2], &events_[3]});
    collect_.SetInjection(options_.injection);
    publish_.SetInjection(options_.injection);
    degraded_flags_ |= estimator_status_t::DEGRADED_INJECTED;
  }
  if (!options_.record_packs) return;
  record_ = std::make_unique<RecordRing>();
  collect_.SetRecord(record_.get());
}

Pipeline::~Pipeline() {
  RequestStop();
  Join();
}

void Pipeline::Place() {
  const std::vector<int> cpus = AvailableCpus();
  // One CPU: everything runs there, and says so. A CPU that is not ours is the user's mistake: kept, so that
  // starting the thread names it.
  if (cpus.size() == 1) {
    for (ThreadSettings* thread : {&settings_.collect, &settings_.adjust, &settings_.execute, &settings_.publish}) {
      thread->cpu = cpus.front();
    }
  }
  if (settings_.adjust.cpu == settings_.collect.cpu || settings_.adjust.cpu == settings_.execute.cpu) {
    degraded_flags_ |= estimator_status_t::DEGRADED_SHARED_CPU;
  }
}

const ThreadPlacement& Pipeline::StartThread(RtThread* thread, const char* name, const ThreadSettings& settings,
                                             RtThread::Entry entry) {
  ThreadRequest request;
  request.name = name;
  request.priority = settings.priority;
  request.cpu = settings.cpu;
  const ThreadPlacement& placement = thread->Start(request, settings_.mode, entry, this);
  if (!placement.fifo) degraded_flags_ |= estimator_status_t::DEGRADED_NO_FIFO;
  if (!placement.pinned) degraded_flags_ |= estimator_status_t::DEGRADED_NO_AFFINITY;
  publish_.SetDegraded(degraded_flags_);
  return placement;
}

void Pipeline::StartWitnesses() {
  const std::array<int, kNumStages> cpu{settings_.collect.cpu, settings_.adjust.cpu, settings_.execute.cpu};
  std::vector<Witness*> views;
  for (std::size_t i = 0; i < kNumStages; ++i) {
    auto found = std::find_if(witnesses_.begin(), witnesses_.end(), [&](const auto& w) { return w->cpu() == cpu[i]; });
    if (found == witnesses_.end()) {
      witnesses_.push_back(std::make_unique<Witness>(cpu[i], Witness::PeriodFor(settings_.deadline_ns)));
      witnesses_.back()->Start(settings_.witness_priority, settings_.mode);
      views.push_back(witnesses_.back().get());
      found = witnesses_.end() - 1;
    }
    if ((*found)->trustworthy()) {
      monitor_.SetWitness(static_cast<Stage>(i), &(*found)->wake_ups());
    } else {
      degraded_flags_ |= estimator_status_t::DEGRADED_NO_WITNESS;
    }
  }
  publish_.SetWitnesses(std::move(views));
}

void Pipeline::ShareCpuTimes() {
  struct StageThread {
    CpuTimeMeter* meter;
    const RtThread* thread;
    const ThreadSettings* settings;
  };
  const std::array<StageThread, kNumStages> stages{{{collect_.cpu_time(), &collect_thread_, &settings_.collect},
                                                    {adjust_.cpu_time(), &adjust_thread_, &settings_.adjust},
                                                    {execute_.cpu_time(), &execute_thread_, &settings_.execute}}};
  for (const StageThread& stage : stages) {
    const auto share = [&](const RtThread& thread, int cpu, bool goes_first) {
      if (cpu == stage.settings->cpu) stage.meter->AddOther(&thread.cpu_time_ns(), goes_first);
    };
    for (const StageThread& other : stages)
      if (other.thread != stage.thread)
        share(*other.thread, other.settings->cpu, other.settings->priority >= stage.settings->priority);
    share(publish_thread_, settings_.publish.cpu, false);
    share(watchdog_.thread(), watchdog_.cpu(), false);
    for (const auto& witness : witnesses_) share(witness->thread(), witness->cpu(), false);
  }
}

void Pipeline::Start() {
  Place();
  memory_locked_ = SetUpProcessMemory(settings_);
  if (!memory_locked_) degraded_flags_ |= estimator_status_t::DEGRADED_NO_MLOCK;
  if (settings_.KeepsCpusAwake()) KeepCpusAwake();
  try {
    StartThreads();
  } catch (...) {
    RequestStop();
    Join();
    throw;
  }
}

void Pipeline::KeepCpusAwake() {
  if (wake_request_.Hold()) return;
  const int error = errno;
  degraded_flags_ |= estimator_status_t::DEGRADED_CPUS_SLEEP;
  if (settings_.mode == RtMode::kEnforce && settings_.cpu_idle == CpuIdle::kAwake) {
    throw PrivilegeError(std::string("cannot keep the CPUs awake (") + CpuWakeRequest::kDevice + ": " +
                         std::strerror(error) + ").\n" + CpuWakeRemedy());
  }
}

void Pipeline::StartThreads() {
  // Adjust first: it warms the engine up before anything can be released. Collect last: it releases.
  // The monitor knows its witnesses before a thread that asks it starts.
  const auto trust = [](CpuTimeMeter* meter, const ThreadPlacement& placement) {
    meter->SetTrusted(placement.fifo && placement.pinned);
  };
  trust(adjust_.cpu_time(), StartThread(&adjust_thread_, "adjust", settings_.adjust, [](void* self) noexcept {
          static_cast<Pipeline*>(self)->WarmUpEngine();
          static_cast<Pipeline*>(self)->AdjustLoop();
        }));
  while (!warm_waiter_.WaitUntil(MonotonicNow() + kNanosPerSecond)) {
  }
  StartWitnesses();
  ShareCpuTimes();
  trust(execute_.cpu_time(), StartThread(&execute_thread_, "execute", settings_.execute,
                                         [](void* self) noexcept { static_cast<Pipeline*>(self)->ExecuteLoop(); }));
  StartThread(&publish_thread_, "publish", settings_.publish,
              [](void* self) noexcept { static_cast<Pipeline*>(self)->PublishLoop(); });
  trust(collect_.cpu_time(), StartThread(&collect_thread_, "collect", settings_.collect,
                                         [](void* self) noexcept { static_cast<Pipeline*>(self)->CollectLoop(); }));
  watchdog_.Start();
}

void Pipeline::RequestStop() noexcept {
  stop_.store(true, std::memory_order_release);
  receiver_.Wake();
  adjust_waiter_.Post();
  execute_waiter_.Post();
  publish_waiter_.Post();
}

void Pipeline::Join() noexcept {
  watchdog_.Stop();
  collect_thread_.Join();
  adjust_thread_.Join();
  execute_thread_.Join();
  execute_ended_.store(true, std::memory_order_release);
  publish_waiter_.Post();
  publish_thread_.Join();
  for (auto& witness : witnesses_) witness->Stop();
}

std::uint64_t Pipeline::HeapCalls() const noexcept {
  return options_.heap_probe != nullptr ? options_.heap_probe() : 0;
}

void Pipeline::CountHeapCalls(Stage stage, std::uint64_t baseline) noexcept {
  counters_.heap_calls[IndexOf(stage)].Set(static_cast<std::int64_t>(HeapCalls() - baseline));
}

void Pipeline::CollectLoop() noexcept {
  constexpr int kMaxPacksPerWait = 64;
  constexpr Nanos kDatagramNs = 20'000;  // to take one from the socket and to look at it, several times over
  std::int64_t passed_over = 0;
  auto& count = counters_.collect;
  receiver_.Drain();  // packs that came during the warm-up are older than any deadline
  collect_.Begin(MonotonicNow());
  const std::uint64_t baseline = HeapCalls();
  while (!stopping()) {
    Datagram datagram;
    std::int64_t heard = 0;
    const Nanos wait_ns = std::max<Nanos>(0, collect_.next_tick_ns() - MonotonicNow());
    watchdog_.Promise(Watched::kCollect, MonotonicNow(), wait_ns);
    if (receiver_.WaitUntil(collect_.next_tick_ns())) {
      watchdog_.Promise(Watched::kCollect, MonotonicNow(), settings_.period_ns / 2);
      for (int i = 0; i < kMaxPacksPerWait && receiver_.TryReceive(&datagram); ++i) {
        ++heard;
        if (collect_.Step(datagram)) adjust_waiter_.Post();
      }
      count.foreign.Set(receiver_.counts().foreign);
      count.fragments.Set(receiver_.counts().fragments);
      count.malformed.Set(receiver_.counts().malformed);
    }
    // Also when others keep the bus busy: only the time decides.
    const Nanos now_ns = MonotonicNow();
    collect_.NoteForeign(receiver_.counts().foreign, now_ns);
    if (now_ns >= collect_.next_tick_ns()) {
      collect_.Tick(now_ns);
      status_due_.store(true, std::memory_order_release);
      publish_waiter_.Post();
    }
    CountHeapCalls(Stage::kCollect, baseline);
    // A stall that the hypervisor does not report is charged to whoever ran. What was told to disturb may use any time.
    heard += receiver_.counts().passed_over() - passed_over;
    passed_over = receiver_.counts().passed_over();
    collect_thread_.NoteCpuTime(options_.injection != nullptr ? RtThread::kNoLimit
                                                              : RtThread::kShortTurnNs + heard * kDatagramNs);
  }
  watchdog_.Dismiss(Watched::kCollect);
}

void Pipeline::WarmUpEngine() noexcept {
  WarmUp(engine_);
  warm_waiter_.Post();
}

void Pipeline::AdjustLoop() noexcept {
  const std::uint64_t baseline = HeapCalls();
  while (!stopping()) {
    watchdog_.Promise(Watched::kAdjust, MonotonicNow(), settings_.period_ns);
    (void)adjust_waiter_.WaitUntil(MonotonicNow() + settings_.period_ns);
    adjust_.cpu_time()->NoteWoken(adjust_waiter_.TakePostTime());
    watchdog_.Promise(Watched::kAdjust, MonotonicNow(), settings_.adjust_budget_ns);
    while (!stopping() && adjust_.Step()) {
      execute_waiter_.Post();
      watchdog_.Promise(Watched::kAdjust, MonotonicNow(), settings_.adjust_budget_ns);
      adjust_.Remember();
      watchdog_.Promise(Watched::kAdjust, MonotonicNow(), settings_.adjust_budget_ns);
    }
    CountHeapCalls(Stage::kAdjust, baseline);
    adjust_thread_.NoteCpuTime();
  }
  watchdog_.Dismiss(Watched::kAdjust);
}

void Pipeline::ExecuteLoop() noexcept {
  const std::uint64_t baseline = HeapCalls();
  while (!stopping()) {
    watchdog_.Promise(Watched::kExecute, MonotonicNow(), settings_.period_ns);
    (void)execute_waiter_.WaitUntil(MonotonicNow() + settings_.period_ns);
    execute_.cpu_time()->NoteWoken(execute_waiter_.TakePostTime());
    watchdog_.Promise(Watched::kExecute, MonotonicNow(), settings_.period_ns / 2);
    while (!stopping() && execute_.Step()) {
      watchdog_.Promise(Watched::kExecute, MonotonicNow(), settings_.period_ns / 2);
      publish_waiter_.Post();
      if (packs_.size() > 0) adjust_waiter_.Post();  // it may have waited for us
      if (options_.max_steps > 0 && counters_.execute.steps.Get() >= options_.max_steps) RequestStop();
    }
    CountHeapCalls(Stage::kExecute, baseline);
    execute_thread_.NoteCpuTime();
  }
  watchdog_.Dismiss(Watched::kExecute);
}

void Pipeline::PublishLoop() noexcept {
  while (true) {
    // A status is due every period; collect asks for it while the plant is silent. The longer bound is for the case
    // that collect itself hangs.
    watchdog_.Promise(Watched::kPublish, MonotonicNow(), 2 * settings_.period_ns);
    const bool posted = publish_waiter_.WaitUntil(MonotonicNow() + 2 * settings_.period_ns);
    const bool ended = execute_ended_.load(std::memory_order_acquire);
    watchdog_.Promise(Watched::kPublish, MonotonicNow(), settings_.period_ns);
    const int published = publish_.PublishSteps();
    const bool due = status_due_.exchange(false, std::memory_order_acq_rel);
    if (published == 0 && (due || !posted)) publish_.PublishIdleStatus();
    publish_thread_.NoteCpuTime();
    if (ended) break;
  }
  watchdog_.Dismiss(Watched::kPublish);
}

bool Pipeline::TakeEvent(Event* event) noexcept {
  return std::any_of(events_.begin(), events_.end(), [event](EventLog& log) { return log.Take(event); });
}

std::int64_t Pipeline::events_dropped() const noexcept {
  std::int64_t sum = 0;
  for (const EventLog& log : events_) sum += log.dropped();
  return sum;
}

std::vector<ThreadPlacement> Pipeline::placements() const {
  std::vector<ThreadPlacement> all{collect_thread_.placement(), adjust_thread_.placement(), execute_thread_.placement(),
                                   publish_thread_.placement()};
  for (const auto& witness : witnesses_) all.push_back(witness->placement());
  return all;
}

}  // namespace armcmc::rt
