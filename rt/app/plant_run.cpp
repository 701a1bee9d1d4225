#include "plant_run.hpp"

#include <iostream>
#include <utility>

#include "armcmc/estimator.hpp"
#include "armcmc/estimator_status_t.hpp"
#include "armcmc/rt/clock.hpp"
#include "armcmc/snapshot.hpp"
#include "summary.hpp"

namespace armcmc::app {

PlantRun::PlantRun(const PlantConfiguration& configuration, bool several)
    : configuration_(configuration), name_(several ? configuration.prefix : ""), engine_(configuration.estimator) {}

rt::LanePlant PlantRun::ForPipeline(rt::StepEngine* engine) const {
  return {engine, configuration_.prefix, engine_.estimator().watches_gap()};
}

void PlantRun::Resume(rt::Lane* lane, const Say& say) {
  lane_ = lane;
  if (configuration_.resume.empty()) return;
  Snapshot start = LoadSnapshot(
      configuration_.resume, SnapshotIdentity(engine_.estimator().settings()), rt::RealtimeMicros(),
      [this](const Snapshot& s) { return engine_.Resume(s.adjusted, s.executed); }, say);
  snapshots_ = std::make_unique<rt::SnapshotHandOver>(Estimator::kSnapshotBytes, configuration_.estimator.overlap);
  engine_.SetSnapshots(snapshots_.get());
  saver_ = std::make_unique<SnapshotSaver>(configuration_.resume, std::move(start), snapshots_.get(), say,
                                           [lane] { lane->RaiseFault(estimator_status_t::FAULT_SNAPSHOT); });
}

void PlantRun::Start(Nanos start_ns, bool verbose, const Say& say) {
  printer_ = std::make_unique<EventPrinter>(
      std::cerr, start_ns, verbose,
      [this](int check) { return std::string(engine_.estimator().gap_check_name(check)); }, name_);
  if (lane_->record() != nullptr) {
    gap_log_ = std::make_unique<GapLog>(configuration_.gap_log, ColumnsOf(configuration_.estimator), lane_->record(),
                                        &lane_->gap_alarm(), say);
    gap_log_->Start();
  }
  if (saver_) saver_->Start();
}

void PlantRun::PrintEvents(Nanos now_ns, bool each_second) {
  rt::Event event;
  while (lane_->TakeEvent(&event)) printer_->Print(event);
  if (each_second) printer_->PrintHeldBack(now_ns);
}

void PlantRun::Stop() {
  if (gap_log_) {
    gap_log_->Stop();
    gap_window_ = gap_log_->path();
    gap_log_.reset();
  }
  if (saver_) {
    saver_->Stop();
    snapshot_ = rt::SnapshotCounts{saver_->path(), saver_->resumed_from(), saver_->written(), saver_->failed()};
    saver_.reset();
  }
}

void PlantRun::Conclude(const rt::Pipeline& pipeline) const {
  if (!name_.empty()) std::cout << "---- " << name_ << " ----\n";
  std::cout << SummaryText(pipeline, *lane_, engine_.estimator(), gap_window_);
  if (!configuration_.report.empty()) {
    rt::WriteReport(pipeline, *lane_, configuration_.report, gap_window_, snapshot_);
    std::cout << "\nreport: " << configuration_.report << '\n';
  }
  if (!name_.empty()) std::cout << '\n';
}

}  // namespace armcmc::app
