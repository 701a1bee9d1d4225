#include "armcmc/rt/rt_thread.hpp"

#include <sched.h>
#include <sys/prctl.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <stdexcept>

#include "armcmc/rt/clock.hpp"
#include "armcmc/rt/cpu_time_meter.hpp"
#include "armcmc/rt/process_setup.hpp"

namespace armcmc::rt {
namespace {

/// Attributes that are destroyed with the scope.
class Attributes {
 public:
  Attributes() { pthread_attr_init(&attributes_); }
  ~Attributes() { pthread_attr_destroy(&attributes_); }
  Attributes(const Attributes&) = delete;
  Attributes& operator=(const Attributes&) = delete;
  [[nodiscard]] pthread_attr_t* get() noexcept { return &attributes_; }

 private:
  pthread_attr_t attributes_{};
};

std::string NoSuchCpu(const ThreadRequest& request) {
  return std::string("thread \"") + request.name + "\" cannot run on CPU " + std::to_string(request.cpu) +
         ": it does not exist or is not allowed for this process. Set [rt." + request.name +
         "] cpu in the configuration, or widen the CPU set of the process (taskset, cpuset).";
}

std::string NoFifo(const ThreadRequest& request) {
  return std::string("thread \"") + request.name + "\" is refused SCHED_FIFO priority " +
         std::to_string(request.priority) + ".\n" + PrivilegeRemedy();
}

}  // namespace

int RtThread::Create(bool fifo, bool pin) noexcept {
  Attributes attributes;
  int error = pthread_attr_setstacksize(attributes.get(), request_.stack_bytes);
  if (error == 0 && fifo) {
    sched_param param{};
    param.sched_priority = request_.priority;
    error = pthread_attr_setinheritsched(attributes.get(), PTHREAD_EXPLICIT_SCHED);
    if (error == 0) error = pthread_attr_setschedpolicy(attributes.get(), SCHED_FIFO);
    if (error == 0) error = pthread_attr_setschedparam(attributes.get(), &param);
  }
  if (error == 0 && pin) {
    cpu_set_t set;
    CPU_ZERO(&set);
    CPU_SET(static_cast<unsigned>(request_.cpu), &set);
    error = pthread_attr_setaffinity_np(attributes.get(), sizeof set, &set);
  }
  return error != 0 ? error : pthread_create(&thread_, attributes.get(), &RtThread::Main, this);
}

const ThreadPlacement& RtThread::Start(const ThreadRequest& request, RtMode mode, Entry entry, void* context) {
  request_ = request;
  entry_ = entry;
  context_ = context;
  placement_ = {};
  placement_.name = request.name;
  // pthread calls return the error. EPERM is the policy, EINVAL the affinity: each may be given up alone.
  bool fifo = request.priority > 0;
  bool pin = request.cpu >= 0;
  int error = Create(fifo, pin);
  for (int given_up = 0; given_up < 2 && error != 0; ++given_up) {
    if (error == EINVAL && pin) {
      if (mode == RtMode::kEnforce) throw PrivilegeError(NoSuchCpu(request));
      pin = false;
    } else if (error == EPERM && fifo) {
      if (mode == RtMode::kEnforce) throw PrivilegeError(NoFifo(request));
      fifo = false;
    } else {
      break;
    }
    error = Create(fifo, pin);
  }
  if (error != 0) {
    throw std::runtime_error(std::string("cannot create thread \"") + request.name + "\": " + std::strerror(error));
  }
  running_ = true;
  while (!ready_.WaitUntil(MonotonicNow() + kNanosPerSecond)) {
  }
  if (mode == RtMode::kEnforce && (!placement_.fifo || !placement_.pinned)) {
    // The request was granted and the kernel says otherwise: never run on in that state.
    refused_ = true;
    go_.Post();
    Join();
    throw PrivilegeError(std::string("thread \"") + request.name +
                         "\" does not run as requested (read back: priority " + std::to_string(placement_.priority) +
                         ", CPU " + std::to_string(placement_.cpu) + ").\n" + PrivilegeRemedy());
  }
  go_.Post();
  return placement_;
}

void RtThread::Join() noexcept {
  if (!running_) return;
  pthread_join(thread_, nullptr);
  running_ = false;
}

void* RtThread::Main(void* self) {
  auto* thread = static_cast<RtThread*>(self);
  PrefaultStack();
  pthread_setname_np(pthread_self(), thread->request_.name);
  prctl(PR_SET_TIMERSLACK, 1UL);  // without real-time priority a sleep may last 50 us longer
  thread->ReadBack();
  const Entry entry = thread->entry_;
  void* context = thread->context_;
  thread->ready_.Post();
  while (!thread->go_.WaitUntil(MonotonicNow() + kNanosPerSecond)) {
  }
  if (!thread->refused_) entry(context);
  return nullptr;
}

void RtThread::NoteCpuTime(Nanos most_ns) noexcept ARMCMC_NONBLOCKING {
  const Nanos charged_ns = ThreadCpuTime();
  const Nanos turn_ns = std::min(charged_ns - charged_ns_, most_ns);
  charged_ns_ = charged_ns;
  cpu_time_ns_.store(cpu_time_ns_.load(std::memory_order_relaxed) + turn_ns, std::memory_order_relaxed);
}

void RtThread::ReadBack() {
  int policy = 0;
  sched_param param{};
  if (pthread_getschedparam(pthread_self(), &policy, &param) == 0 && policy == SCHED_FIFO) {
    placement_.priority = param.sched_priority;
    placement_.fifo = param.sched_priority == request_.priority;
  }
  cpu_set_t set;
  CPU_ZERO(&set);
  if (pthread_getaffinity_np(pthread_self(), sizeof set, &set) == 0 && CPU_COUNT(&set) == 1) {
    for (int cpu = 0; cpu < CPU_SETSIZE; ++cpu) {
      if (CPU_ISSET(static_cast<unsigned>(cpu), &set)) placement_.cpu = cpu;
    }
    placement_.pinned = placement_.cpu == request_.cpu;
  }
}

}  // namespace armcmc::rt
