#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "armcmc/rt/pipeline.hpp"
#include "armcmc/rt/snapshot_hand_over.hpp"
#include "armcmc/rt/step_engine.hpp"
#include "event_printer.hpp"
#include "gap_log.hpp"
#include "options.hpp"
#include "report.hpp"
#include "snapshot_saver.hpp"

namespace armcmc::app {

/// What the process does for one of its plants outside the real-time threads: it owns the estimator, keeps the file of
/// --resume and the data around a gap, prints events, and writes summary and report.
class PlantRun {
 public:
  using Say = std::function<void(const std::string&)>;

  /// @param several  The plant is not alone: what is printed says which it is.
  PlantRun(const PlantConfiguration& configuration, bool several);
  PlantRun(const PlantRun&) = delete;
  PlantRun& operator=(const PlantRun&) = delete;

  [[nodiscard]] rt::EstimatorEngine& engine() noexcept { return engine_; }
  /// The plant as a pipeline takes it, with this engine or one around it.
  [[nodiscard]] rt::LanePlant ForPipeline(rt::StepEngine* engine) const;
  [[nodiscard]] const PlantConfiguration& configuration() const noexcept { return configuration_; }

  /// Reads the file of --resume. Before the pipeline starts. @param lane  Of this plant; outlives this.
  void Resume(rt::Lane* lane, const Say& say);
  /// The threads other than the pipeline's. After that has started.
  void Start(Nanos start_ns, bool verbose, const Say& say);
  /// Prints what has happened. @param each_second  A second has passed since it was true the last time.
  void PrintEvents(Nanos now_ns, bool each_second);
  /// Ends the threads and writes what is due. After the pipeline has been joined and before it is gone; a second call
  /// does nothing.
  void Stop();

  /// Summary on standard output, report to its file. After Stop(). @throws std::runtime_error naming the file.
  void Conclude(const rt::Pipeline& pipeline) const;

 private:
  PlantConfiguration configuration_;
  std::string name_;  ///< For people; empty: the plant is alone.
  std::unique_ptr<rt::SnapshotHandOver> snapshots_;
  rt::EstimatorEngine engine_;
  rt::Lane* lane_ = nullptr;
  std::unique_ptr<SnapshotSaver> saver_;
  std::unique_ptr<GapLog> gap_log_;
  std::unique_ptr<EventPrinter> printer_;
  std::string gap_window_;
  std::optional<rt::SnapshotCounts> snapshot_;
};

}  // namespace armcmc::app
