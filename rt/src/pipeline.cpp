#include "armcmc/rt/pipeline.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <set>
#include <stdexcept>
#include <utility>

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

namespace {

std::vector<std::unique_ptr<Lane>> MakeLanes(const RtSettings& settings, const std::vector<LanePlant>& plants,
                                             Injection* injection) {
  if (plants.empty() || plants.size() > Pipeline::kMaxLanes)
    throw std::invalid_argument("a pipeline takes 1 to " + std::to_string(Pipeline::kMaxLanes) + " plants, not " +
                                std::to_string(plants.size()));
  if (injection != nullptr && plants.size() > 1)
    throw std::invalid_argument("fault injection needs exactly one plant, found " + std::to_string(plants.size()));
  std::set<std::string> prefixes;
  std::vector<std::unique_ptr<Lane>> lanes;
  for (const LanePlant& plant : plants) {
    if (!prefixes.insert(plant.prefix).second)
      throw std::invalid_argument("two plants have the prefix \"" + plant.prefix +
                                  "\": their messages could not be distinguished");
    if (plant.prefix.size() > kMaxPrefixLength)
      throw std::invalid_argument("the prefix \"" + plant.prefix + "\" is longer than " +
                                  std::to_string(kMaxPrefixLength) + " characters");
    lanes.push_back(std::make_unique<Lane>(settings, plant, injection));
  }
  return lanes;
}

std::vector<std::string> ChannelsOf(const std::vector<std::unique_ptr<Lane>>& lanes) {
  std::vector<std::string> channels;
  channels.reserve(lanes.size());
  for (const auto& lane : lanes) channels.push_back(lane->channel());
  return channels;
}

std::vector<std::string> PublishedChannelsOf(const std::vector<std::unique_ptr<Lane>>& lanes) {
  std::vector<std::string> channels;
  for (const auto& lane : lanes)
    for (std::string& channel : LcmPublisher::Channels(lane->prefix())) channels.push_back(std::move(channel));
  return channels;
}

}  // namespace

Pipeline::Pipeline(const RtSettings& settings, const std::vector<LanePlant>& plants, const PipelineOptions& options)
    : settings_((settings.Validate(), settings)),
      options_(options),
      lanes_(MakeLanes(settings_, plants, options.injection)),
      receiver_(ParseLcmUrl(settings_.lcm_url), ChannelsOf(lanes_), PublishedChannelsOf(lanes_)),
      watchdog_(settings_, &watchdog_events_) {
  if (options_.injection != nullptr) degraded_flags_ |= estimator_status_t::DEGRADED_INJECTED;
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
  for (const auto& lane : lanes_) lane->publish_.SetDegraded(degraded_flags_);
  return placement;
}

void Pipeline::StartWitnesses() {
  const std::array<int, kNumStages> cpu{settings_.collect.cpu, settings_.adjust.cpu, settings_.execute.cpu};
  for (std::size_t i = 0; i < kNumStages; ++i) {
    auto found = std::find_if(witnesses_.begin(), witnesses_.end(), [&](const auto& w) { return w->cpu() == cpu[i]; });
    if (found == witnesses_.end()) {
      witnesses_.push_back(std::make_unique<Witness>(cpu[i], Witness::PeriodFor(settings_.deadline_ns)));
      witnesses_.back()->Start(settings_.witness_priority, settings_.mode);
      found = witnesses_.end() - 1;
    }
    if ((*found)->trustworthy()) {
      for (const auto& lane : lanes_) lane->monitor_.SetWitness(static_cast<Stage>(i), &(*found)->wake_ups());
    } else {
      degraded_flags_ |= estimator_status_t::DEGRADED_NO_WITNESS;
    }
  }
}

void Pipeline::ShareCpuTimes() {
  struct StageThread {
    const RtThread* thread;
    const ThreadSettings* settings;
  };
  const std::array<StageThread, kNumStages> stages{{{&collect_thread_, &settings_.collect},
                                                    {&adjust_thread_, &settings_.adjust},
                                                    {&execute_thread_, &settings_.execute}}};
  for (const auto& lane : lanes_) {
    const std::array<CpuTimeMeter*, kNumStages> meters{lane->collect_.cpu_time(), lane->adjust_.cpu_time(),
                                                       lane->execute_.cpu_time()};
    for (std::size_t i = 0; i < kNumStages; ++i) {
      const StageThread& stage = stages[i];
      const auto share = [&](const RtThread& thread, int cpu, bool goes_first) {
        if (cpu == stage.settings->cpu) meters[i]->AddOther(&thread.cpu_time_ns(), goes_first);
      };
      for (const StageThread& other : stages)
        if (other.thread != stage.thread)
          share(*other.thread, other.settings->cpu, other.settings->priority >= stage.settings->priority);
      share(publish_thread_, settings_.publish.cpu, false);
      share(watchdog_.thread(), watchdog_.cpu(), false);
      for (const auto& witness : witnesses_) share(witness->thread(), witness->cpu(), false);
    }
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
  const auto trust = [this](auto meter_of, const ThreadPlacement& placement) {
    for (const auto& lane : lanes_) meter_of(*lane)->SetTrusted(placement.fifo && placement.pinned);
  };
  trust([](Lane& lane) { return lane.adjust_.cpu_time(); },
        StartThread(&adjust_thread_, "adjust", settings_.adjust, [](void* self) noexcept {
          static_cast<Pipeline*>(self)->WarmUpEngines();
          static_cast<Pipeline*>(self)->AdjustLoop();
        }));
  while (!warm_waiter_.WaitUntil(MonotonicNow() + kNanosPerSecond)) {
  }
  StartWitnesses();
  ShareCpuTimes();
  trust([](Lane& lane) { return lane.execute_.cpu_time(); },
        StartThread(&execute_thread_, "execute", settings_.execute,
                    [](void* self) noexcept { static_cast<Pipeline*>(self)->ExecuteLoop(); }));
  StartThread(&publish_thread_, "publish", settings_.publish,
              [](void* self) noexcept { static_cast<Pipeline*>(self)->PublishLoop(); });
  trust([](Lane& lane) { return lane.collect_.cpu_time(); },
        StartThread(&collect_thread_, "collect", settings_.collect,
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
  // Of the thread, which serves all plants.
  const auto calls = static_cast<std::int64_t>(HeapCalls() - baseline);
  for (const auto& lane : lanes_) lane->counters_.heap_calls[IndexOf(stage)].Set(calls);
}

void Pipeline::CollectLoop() noexcept {
  constexpr int kMaxPacksPerWait = 64;
  constexpr Nanos kDatagramNs = 20'000;  // to take one from the socket and to look at it, several times over
  std::int64_t passed_over = 0;
  receiver_.Drain();  // packs that came during the warm-up are older than any deadline
  const Nanos begin_ns = MonotonicNow();
  for (const auto& lane : lanes_) lane->collect_.Begin(begin_ns);
  const std::uint64_t baseline = HeapCalls();
  while (!stopping()) {
    Datagram datagram;
    std::int64_t heard = 0;
    Nanos next_tick_ns = lanes_[0]->collect_.next_tick_ns();
    for (const auto& lane : lanes_) next_tick_ns = std::min(next_tick_ns, lane->collect_.next_tick_ns());
    const Nanos wait_ns = std::max<Nanos>(0, next_tick_ns - MonotonicNow());
    watchdog_.Announce(Watched::kCollect, MonotonicNow(), wait_ns);
    if (receiver_.WaitUntil(next_tick_ns)) {
      watchdog_.Announce(Watched::kCollect, MonotonicNow(), settings_.period_ns / 2);
      for (int i = 0; i < kMaxPacksPerWait && receiver_.TryReceive(&datagram); ++i) {
        ++heard;
        if (lanes_[datagram.channel]->collect_.Step(datagram)) adjust_waiter_.Post();
      }
    }
    // Also when others keep the bus busy: only the time decides.
    const LcmReceiver::Counts& bus = receiver_.counts();
    const Nanos now_ns = MonotonicNow();
    for (const auto& lane : lanes_) {
      Counters::Collect& count = lane->counters_.collect;
      count.foreign.Set(bus.foreign);
      count.fragments.Set(bus.fragments);
      count.malformed.Set(bus.malformed);
      lane->collect_.NoteForeign(bus.foreign, now_ns);
      if (now_ns < lane->collect_.next_tick_ns()) continue;
      lane->collect_.Tick(now_ns);
      lane->status_due_.store(true, std::memory_order_release);
      publish_waiter_.Post();
    }
    CountHeapCalls(Stage::kCollect, baseline);
    // A stall that the hypervisor does not report is charged to whoever ran. What injects faults may use any time.
    heard += bus.passed_over() - passed_over;
    passed_over = bus.passed_over();
    collect_thread_.NoteCpuTime(options_.injection != nullptr ? RtThread::kNoLimit
                                                              : RtThread::kShortTurnNs + heard * kDatagramNs);
  }
  watchdog_.Dismiss(Watched::kCollect);
}

void Pipeline::WarmUpEngines() noexcept {
  for (const auto& lane : lanes_) WarmUp(lane->engine_);
  warm_waiter_.Post();
}

void Pipeline::AdjustLoop() noexcept {
  const std::uint64_t baseline = HeapCalls();
  while (!stopping()) {
    watchdog_.Announce(Watched::kAdjust, MonotonicNow(), settings_.period_ns);
    (void)adjust_waiter_.WaitUntil(MonotonicNow() + settings_.period_ns);
    const Nanos woken_ns = adjust_waiter_.TakePostTime();
    for (const auto& lane : lanes_) lane->adjust_.cpu_time()->NoteWoken(woken_ns);
    watchdog_.Announce(Watched::kAdjust, MonotonicNow(), settings_.adjust_budget_ns);
    AdjustWaiting();
    CountHeapCalls(Stage::kAdjust, baseline);
    adjust_thread_.NoteCpuTime();
  }
  watchdog_.Dismiss(Watched::kAdjust);
}

Lane* Pipeline::NextToAdjust(int* waiting) noexcept {
  const Nanos now_ns = MonotonicNow();
  Lane* next = nullptr;
  bool next_keeps = false;
  *waiting = 0;
  for (const auto& lane : lanes_) {
    const PackSlot* const pack = lane->packs_.Front();
    if (pack == nullptr || lane->refused_) continue;
    ++*waiting;
    const Nanos deadline_ns = pack->times.deadline_ns;
    const bool keeps = now_ns < deadline_ns;
    const bool sooner = next == nullptr || deadline_ns < next->packs_.Front()->times.deadline_ns;
    if (next != nullptr && (keeps != next_keeps ? next_keeps : !sooner)) continue;
    next = lane.get();
    next_keeps = keeps;
  }
  return next;
}

void Pipeline::RememberIn(Lane* lane) noexcept {
  if (!lane->not_remembered_) return;
  lane->not_remembered_ = false;
  watchdog_.Announce(Watched::kAdjust, MonotonicNow(), settings_.adjust_budget_ns);
  lane->adjust_.Remember();
}

void Pipeline::AdjustWaiting() noexcept {
  for (const auto& lane : lanes_) lane->refused_ = false;
  int waiting = 0;
  for (Lane* lane = NextToAdjust(&waiting); lane != nullptr && !stopping(); lane = NextToAdjust(&waiting)) {
    RememberIn(lane);  // of its pack before; that of the others can wait until no pack does
    watchdog_.Announce(Watched::kAdjust, MonotonicNow(), settings_.adjust_budget_ns);
    lane->not_remembered_ = lane->adjust_.Step(waiting);
    lane->refused_ = !lane->not_remembered_;
    if (lane->not_remembered_) execute_waiter_.Post();
  }
  for (const auto& lane : lanes_) RememberIn(lane.get());
  watchdog_.Announce(Watched::kAdjust, MonotonicNow(), settings_.adjust_budget_ns);
}

bool Pipeline::AllStepsDone() const noexcept {
  return options_.max_steps > 0 && std::all_of(lanes_.begin(), lanes_.end(), [this](const auto& lane) noexcept {
           return lane->counters_.execute.steps.Get() >= options_.max_steps;
         });
}

void Pipeline::ExecuteLoop() noexcept {
  const std::uint64_t baseline = HeapCalls();
  while (!stopping()) {
    watchdog_.Announce(Watched::kExecute, MonotonicNow(), settings_.period_ns);
    (void)execute_waiter_.WaitUntil(MonotonicNow() + settings_.period_ns);
    const Nanos woken_ns = execute_waiter_.TakePostTime();
    for (const auto& lane : lanes_) lane->execute_.cpu_time()->NoteWoken(woken_ns);
    for (const auto& lane : lanes_) {
      watchdog_.Announce(Watched::kExecute, MonotonicNow(), settings_.period_ns / 2);
      while (!stopping() && lane->execute_.Step()) {
        watchdog_.Announce(Watched::kExecute, MonotonicNow(), settings_.period_ns / 2);
        publish_waiter_.Post();
        if (lane->packs_.size() > 0) adjust_waiter_.Post();  // it may have waited for us
        if (AllStepsDone()) RequestStop();
      }
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
    watchdog_.Announce(Watched::kPublish, MonotonicNow(), 2 * settings_.period_ns);
    const bool posted = publish_waiter_.WaitUntil(MonotonicNow() + 2 * settings_.period_ns);
    const bool ended = execute_ended_.load(std::memory_order_acquire);
    Nanos worst_ns = 0;
    for (const auto& witness : witnesses_) worst_ns = std::max(worst_ns, witness->TakeWorst());
    const bool hung = watchdog_.TakeHung();
    for (const auto& lane : lanes_) {
      watchdog_.Announce(Watched::kPublish, MonotonicNow(), settings_.period_ns);
      lane->publish_.Note(worst_ns, hung);
      const int published = lane->publish_.PublishSteps();
      const bool due = lane->status_due_.exchange(false, std::memory_order_acq_rel);
      if (published == 0 && (due || !posted)) lane->publish_.PublishIdleStatus();
    }
    publish_thread_.NoteCpuTime();
    if (ended) break;
  }
  watchdog_.Dismiss(Watched::kPublish);
}

std::vector<ThreadPlacement> Pipeline::placements() const {
  std::vector<ThreadPlacement> all{collect_thread_.placement(), adjust_thread_.placement(), execute_thread_.placement(),
                                   publish_thread_.placement()};
  for (const auto& witness : witnesses_) all.push_back(witness->placement());
  return all;
}

}  // namespace armcmc::rt
