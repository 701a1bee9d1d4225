#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "armcmc/identify/lane_program.hpp"
#include "armcmc/plant/between.hpp"
#include "armcmc/plant/plant.hpp"

namespace armcmc::identify {

/// Measured data as a law sees it.
struct Series {
  double dt = 1.0;                           ///< s
  std::vector<double> t;                     ///< [row] s
  std::vector<std::vector<double>> signals;  ///< [signal, in the order of the plant's file][row]
  std::vector<std::size_t> runs;             ///< First row of every run: nothing is remembered across.
  [[nodiscard]] std::size_t num_rows() const { return t.size(); }
};

/// The law of a plant file over whole runs, as a function of its parameters, for identification after the fact.
///
/// States are integrated by the classical Runge-Kutta method from their `start` at the first sample of every run
/// (`measured_by` is for packs); inputs are linear between samples. Functions with memory may have arguments and times
/// that depend on parameters. What depends on no parameter is computed once.
class TrajectoryModel {
 public:
  /// @throws PlantError where the plant needs more than there is room for.
  TrajectoryModel(std::shared_ptr<const Plant> plant, std::shared_ptr<const Series> series);

  /// As they are sampled: a lognormal one as its logarithm; one that each mode has of its own once a mode, NAME_MODE.
  [[nodiscard]] const std::vector<ParameterDescription>& parameters() const noexcept { return parameters_; }
  [[nodiscard]] Eigen::Index num_parameters() const noexcept { return static_cast<Eigen::Index>(parameters_.size()); }
  [[nodiscard]] std::size_t num_rows() const noexcept { return series_->num_rows(); }
  [[nodiscard]] const Plant& plant() const noexcept { return *plant_; }
  [[nodiscard]] const Series& series() const noexcept { return *series_; }

  /// Where the prior is: mean, or logarithm of the median.
  [[nodiscard]] Eigen::VectorXd Start() const;
  /// Bounds and prior standard deviations in the sampled coordinates; of a uniform prior that of the interval.
  [[nodiscard]] Eigen::VectorXd Lower() const;
  [[nodiscard]] Eigen::VectorXd Upper() const;
  [[nodiscard]] Eigen::VectorXd Spread() const;
  /// The value of a sampled parameter for people: exp of a lognormal one.
  [[nodiscard]] double Shown(Eigen::Index d, double sampled) const;

  /// [row] What the law explains; 0 where nothing is.
  [[nodiscard]] const Eigen::VectorXd& target() const noexcept { return target_; }
  /// [row] 1: a mode that is not passive acts.
  [[nodiscard]] const std::vector<std::uint8_t>& active() const noexcept { return active_; }

  /// The law at every row for several parameter vectors.
  /// @param thetas  [parameter][candidate], sampled coordinates.
  /// @param[out] predictions  [row][candidate]; 0 where no mode acts. Of a candidate that is not finite somewhere, the
  ///   first row is not.
  /// @param only  Rows that are wanted, where the law needs no others; may be null. The rest are 0 then.
  void Predict(const Eigen::MatrixXd& thetas, Eigen::MatrixXd* predictions,
               const std::vector<Eigen::Index>* only = nullptr) const;
  /// Of one; false where something is not finite.
  [[nodiscard]] bool PredictOne(const Eigen::VectorXd& theta, Eigen::VectorXd* prediction) const;
  /// PredictOne, and its derivatives by central differences of 1e-5 prior standard deviations.
  /// @param only  As of Predict.
  [[nodiscard]] bool Linearise(const Eigen::VectorXd& theta, Eigen::VectorXd* prediction, Eigen::MatrixXd* jacobian,
                               const std::vector<Eigen::Index>* only = nullptr) const;
  /// What Linearise predicts: the point itself, then a step up and one down along every parameter.
  [[nodiscard]] Eigen::MatrixXd Around(const Eigen::VectorXd& theta) const;
  /// Linearise from the predictions of Around(): several points may be predicted together.
  [[nodiscard]] static bool LineariseFrom(const Eigen::MatrixXd& around,
                                          const Eigen::Ref<const Eigen::MatrixXd>& predictions,
                                          Eigen::VectorXd* prediction, Eigen::MatrixXd* jacobian);
  /// Rows behind the beginning of a run after which a wrong start of the states that begin with a mere number has at
  /// most `share` of its largest effect on the law; a start that is off by the state's rms. Where several states begin
  /// with the measured output, which is one of them at most, also of those. 0: there are no such states. The length of
  /// the first run: never.
  [[nodiscard]] Eigen::Index RowsToForget(const Eigen::VectorXd& theta, double share) const;
  /// [row][state] of a parameter vector; not finite where it diverges.
  [[nodiscard]] Eigen::MatrixXd States(const Eigen::VectorXd& theta) const;

 private:
  void ChooseParameters();
  [[nodiscard]] int InMode(expression::Graph* graph, int node, std::size_t mode) const;
  /// The value of the mode that acts; `otherwise` where none does.
  template <class NodeOfMode>
  [[nodiscard]] int OfActingMode(expression::Graph* graph, int otherwise, NodeOfMode node_of) const;
  /// Replaces what depends on no parameter by columns that are computed here.
  [[nodiscard]] int WithColumns(expression::Graph* graph, int node);
  /// Functions with memory in rates, which are evaluated at the rows and are linear in between: replaced by inputs.
  /// @return The nodes that were replaced. @throws PlantError where one depends on a state.
  [[nodiscard]] std::vector<int> SplitMemory(expression::Graph* graph, std::vector<int>* nodes) const;
  void EvaluateOnce(const expression::Graph& graph, const std::vector<int>& nodes,
                    std::vector<std::vector<double>>* columns) const;
  template <std::size_t kHalves>
  class Walk;
  /// Up to kHalves kLanes candidates from the first row to the last; `see` gets every row, the half, the law of its
  /// candidates and their states.
  /// @param offset  [state] Added to the starts; may be null.
  /// @param only    As of Predict.
  template <std::size_t kHalves, class See>
  void Run(const Eigen::MatrixXd& thetas, Eigen::Index first, Eigen::Index count, const std::vector<Lanes>* offset,
           const std::vector<Eigen::Index>* only, See see) const;

  std::shared_ptr<const Plant> plant_;
  std::shared_ptr<const Series> series_;
  std::vector<ParameterDescription> parameters_;
  std::vector<std::vector<int>> index_;  ///< [mode][parameter of the plant]
  std::size_t num_signals_, num_states_;
  int substeps_ = 1;
  std::vector<Between> between_;  ///< Of a signal.
  LaneProgram law_, rate_, past_, start_;
  std::size_t num_past_ = 0;     ///< Outputs of past_.
  std::vector<bool> past_held_;  ///< Between samples.
  /// Inputs of the programs: signals, parameters, states, columns, what rates remember.
  std::size_t first_state_ = 0, num_inputs_ = 0;
  std::vector<std::size_t> law_reads_, rate_reads_;  ///< Signals.
  std::vector<std::vector<double>> columns_;         ///< That the law reads instead of signals.
  Eigen::VectorXd target_;
  std::vector<std::uint8_t> active_;
};

}  // namespace armcmc::identify
