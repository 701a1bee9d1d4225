#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "armcmc/adjust_result.hpp"
#include "armcmc/effects/composition.hpp"
#include "armcmc/estimate.hpp"
#include "armcmc/estimator.hpp"
#include "armcmc/parameter_space.hpp"
#include "armcmc/settings.hpp"

namespace armcmc::python {

/// The samples of one pack, as they lie in arrays of rows.
struct Samples {
  const double* u = nullptr;  ///< num_samples x num_inputs, row by row.
  const double* y = nullptr;  ///< num_samples.
  int num_samples = 0;
  int num_inputs = 0;
};

/// A column of u, or the output.
struct Signal {
  std::string name, unit;
};

/// What a column of DrawTable::values is.
struct DrawColumn {
  std::string name, unit;
};

/// Draws of one mode after one pack: those with a weight.
struct DrawTable {
  int num_columns = 0;
  std::vector<double> values;   ///< Row by row, in the units of the columns.
  std::vector<double> weights;  ///< Sum 1.
};

/// An estimator with what a caller without a bus leaves out: pack numbers, times, the check of what comes in.
///
/// Threads may call it at once; one step is done after the other. Not real-time: a step allocates and throws.
class PythonEstimator {
 public:
  /// @throws std::invalid_argument from settings.Validate().
  explicit PythonEstimator(const EstimatorSettings& settings);

  /// Draw, Execute and Remember of one pack, without a deadline.
  /// @param dt      s, sample interval, > 0.
  /// @param t_last  s, time of the last sample; NaN: the pack follows the one before. Where whole packs are missing
  ///                before it, their numbers are left out, as on a bus.
  /// @throws std::invalid_argument saying what to do; the estimator is as before.
  Estimate Step(const Samples& samples, double dt, double t_last);

  /// Of the newest step, in physical values: the reported values of the sampled parameters, and of the noise scale
  /// where that is sampled. @throws std::invalid_argument where there are none.
  [[nodiscard]] DrawTable Draws(int mode);
  [[nodiscard]] std::vector<DrawColumn> DrawColumns(int mode) const;

  /// Forgets everything learnt; the next pack is number 1, and begins at time 0.
  void Reset();

  [[nodiscard]] const Estimator& estimator() const noexcept { return estimator_; }
  /// With the amplitudes of effects among the parameters.
  [[nodiscard]] const EstimatorSettings& sampled() const noexcept { return composition_.sampled(); }
  [[nodiscard]] const EstimatorSettings& settings() const noexcept { return estimator_.settings(); }
  /// Columns of u, in order.
  [[nodiscard]] std::vector<Signal> Inputs() const;
  [[nodiscard]] Signal Output() const;

 private:
  void Check(const Samples& samples, double dt, double t_last) const;
  [[nodiscard]] const ParameterSpace& SpaceOf(int mode) const { return spaces_[static_cast<std::size_t>(mode)]; }
  void CheckMode(int mode) const;

  std::mutex mutex_;
  Estimator estimator_;
  Composition composition_;  // names and units of what is sampled
  std::vector<ParameterSpace> spaces_;
  std::unique_ptr<AdjustResult> result_;
  std::unique_ptr<DataPack> pack_;
  std::int64_t seq_ = 0;
  double t_last_ = 0.0;
};

}  // namespace armcmc::python
