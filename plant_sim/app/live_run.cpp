#include "live_run.hpp"

#include <unistd.h>

#include <algorithm>
#include <armcmc/support/printable.hpp>
#include <armcmc/support/progress.hpp>
#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>
#include <stdexcept>
#include <vector>

#include "armcmc/plant_sim/csv_writer.hpp"
#include "armcmc/plant_sim/estimator_watch.hpp"
#include "armcmc/plant_sim/lcm_link.hpp"
#include "armcmc/plant_sim/lcm_log_writer.hpp"
#include "armcmc/plant_sim/log_ring.hpp"
#include "armcmc/plant_sim/monotonic_clock.hpp"
#include "armcmc/plant_sim/publisher.hpp"
#include "armcmc/plant_sim/scorer.hpp"
#include "estimate_reader.hpp"
#include "interruption.hpp"
#include "report.hpp"
#include "run_id.hpp"

namespace armcmc::plant_sim {
namespace {

// Two messages a pack and a drain every 10 ms: at 1 kHz a disk may stall for 0.1 s before a message is lost.
constexpr int kLogSlots = 256;
constexpr std::int64_t kPoll = 10'000'000;  // ns, between two polls of the bus: no silence is detected sooner

/// A line on stderr, with a progress line wiped first.
void Say(const std::string& text) {
  std::fprintf(stderr, "%sarmcmc-plant: %s\n", isatty(STDERR_FILENO) != 0 ? "\r\033[K" : "",
               support::ErrorLine(text).c_str());
}

std::string Seconds(std::int64_t ns) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.1f s", static_cast<double>(ns) * 1e-9);
  return text;
}

/// Everything of a live run that happens beside the publishing: listening, scoring, files, messages.
class Observer final : public EstimateListener::Handler {
 public:
  Observer(const Scenario& scenario, const PlantOptions& options, LogRing* ring)
      : scenario_(scenario),
        scorer_(scenario, options.seed),
        watch_(std::max<std::int64_t>(std::llround(scenario.pack_period_s() * 1e9), kPoll)),
        ring_(ring) {
    result_.run_id = MakeRunId();
    result_.packs_planned = scenario.num_packs();
    answered_.resize(static_cast<std::size_t>(scenario.num_packs()) + 1);
    if (!options.csv_path.empty()) csv_.emplace(scenario, options.seed, options.csv_path);
    if (!options.log_path.empty()) log_.emplace(options.log_path);
  }

  void OnEstimate(const estimate_t& estimate) override {
    const std::int64_t now = MonotonicNow();
    if (estimate.run_id != result_.run_id || estimate.plant_kind != scenario_.family->kind || estimate.seq < 1 ||
        estimate.seq > result_.packs_planned) {
      ++result_.estimates_foreign;
      return;
    }
    if (watch_.OnEstimate(now)) {
      ++result_.returns;
      Say("the estimator answers again, at pack " + std::to_string(estimate.seq));
    }
    newest_ = std::max(newest_, estimate.seq);
    std::vector<bool>::reference answered = answered_[static_cast<std::size_t>(estimate.seq)];
    if (answered) return;
    answered = true;
    ++result_.packs_answered;
    result_.estimate_latency.Add(now - (start_ns_ + scenario_.end_of_pack_ns(estimate.seq)));
    scorer_.Add(ReadEstimate(*scenario_.family, estimate, static_cast<double>(now - start_ns_) * 1e-9));
  }

  void OnStatus(const estimator_status_t& status) override {
    result_.status_seen = true;
    result_.status = status;
  }

  /// What has to be done now and then. @param drained_ns every message that came before this time was handled.
  void Work(std::int64_t drained_ns, std::int64_t packs_sent, bool publishing) {
    const long long sent = scenario_.last_sample(packs_sent);
    const auto passed =
        static_cast<long long>(static_cast<double>(drained_ns - start_ns_) * 1e-9 / scenario_.sample_interval_s);
    scorer_.ScoreThrough(std::min(sent, passed));
    if (csv_) csv_->WriteThrough(sent);
    DrainLog();
    if (publishing && watch_.NoticeSilence(drained_ns))
      Say("no estimate for " + Seconds(drained_ns - watch_.last_ns()) +
          ": the estimator is silent; the plant continues");
  }

  void Finish(const Publisher& publisher) {
    scorer_.ScoreThrough(scenario_.last_sample(publisher.packs_sent()));
    DrainLog();
    if (csv_) csv_->Close();
    if (log_ && log_->errors() > 0)
      throw std::runtime_error("the log could not be written completely: is the disk full?");
    result_.packs_sent = publisher.packs_sent();
    result_.packs_late = publisher.late_packs();
    result_.send_errors = publisher.send_errors();
    result_.log_lost = log_ ? ring_->lost() : 0;
    result_.lateness = publisher.lateness();
    result_.silences = watch_.silences();
  }

  void set_start(std::int64_t start_ns) { start_ns_ = start_ns; }
  [[nodiscard]] std::int64_t newest() const { return newest_; }
  [[nodiscard]] bool silent() const { return watch_.silent() || newest_ == 0; }
  [[nodiscard]] std::int64_t PeriodNs() const { return std::llround(scenario_.pack_period_s() * 1e9); }
  [[nodiscard]] LiveResult& result() { return result_; }
  [[nodiscard]] const Scorer& scorer() const { return scorer_; }

 private:
  void DrainLog() {
    if (!log_) return;
    while (const LogRing::Slot* slot = ring_->Front()) {
      log_->Send(slot->channel.data(), slot->bytes.data(), slot->size, slot->utime);
      ring_->Pop();
    }
  }

  const Scenario& scenario_;
  LiveResult result_;
  Scorer scorer_;
  EstimatorWatch watch_;
  LogRing* ring_;
  std::optional<CsvWriter> csv_;
  std::optional<LcmLogWriter> log_;
  std::int64_t start_ns_ = 0, newest_ = 0;
  std::vector<bool> answered_;  ///< By pack number.
};

}  // namespace

int RunLive(const Scenario& scenario, const PlantOptions& options) {
  CatchSignals();
  std::unique_ptr<LogRing> ring = options.log_path.empty() ? nullptr : std::make_unique<LogRing>(kLogSlots);
  LcmSink bus(options.lcm_url);
  Observer observer(scenario, options, ring.get());
  EstimateListener listener(options.lcm_url, options.prefix, &observer);
  Publisher publisher(scenario, options.seed, observer.result().run_id, options.prefix, options.faults, &bus,
                      ring.get());

  std::printf("%s: %lld packs of %d samples every %g ms on %s, seed %llu\n", support::Printable(scenario.name).c_str(),
              scenario.num_packs(), scenario.pack_samples, scenario.pack_period_s() * 1e3, options.lcm_url.c_str(),
              static_cast<unsigned long long>(options.seed));
  std::fflush(stdout);
  const std::int64_t start_ns = MonotonicNow() + kStartDelay;
  observer.set_start(start_ns);
  publisher.Start(start_ns);
  {
    support::Progress progress(scenario.name);
    while (!publisher.finished() && !Interrupted()) {
      const std::int64_t drained_ns = MonotonicNow();
      listener.Poll(10);
      observer.Work(drained_ns, publisher.packs_sent(), true);
      progress.Update(static_cast<double>(publisher.packs_sent()) / static_cast<double>(scenario.num_packs()));
    }
    observer.result().interrupted = Interrupted();
    publisher.RequestStop();
    publisher.Join();
    // The estimates of the last packs are still on their way through the estimator's stages.
    const std::int64_t give_up_ns =
        MonotonicNow() + std::max<std::int64_t>(5 * observer.PeriodNs(), kNanosPerSecond / 2);
    while (!observer.silent() && observer.newest() < publisher.packs_sent() && MonotonicNow() < give_up_ns) {
      const std::int64_t drained_ns = MonotonicNow();
      listener.Poll(10);
      observer.Work(drained_ns, publisher.packs_sent(), false);
    }
  }
  observer.Finish(publisher);
  observer.result().estimates_undecodable = listener.undecodable();
  std::fputs(FormatTable(scenario, observer.result(), observer.scorer()).c_str(), stdout);
  if (!options.report_path.empty()) WriteReport(scenario, options, observer.result(), observer.scorer());
  if (publisher.diverged())
    throw std::runtime_error("the plant left the finite range: check the scenario's parameters");
  if (publisher.send_errors() > 0)
    throw std::runtime_error(std::to_string(publisher.send_errors()) +
                             " messages could not be sent: is the multicast route gone?");
  return 0;
}

}  // namespace armcmc::plant_sim
