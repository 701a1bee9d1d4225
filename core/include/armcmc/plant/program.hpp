#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "armcmc/data_pack.hpp"
#include "armcmc/expression/features.hpp"
#include "armcmc/expression/tape.hpp"
#include "armcmc/mode_data.hpp"
#include "armcmc/model.hpp"
#include "armcmc/nonblocking.hpp"
#include "armcmc/plant/plant.hpp"
#include "armcmc/plant/states.hpp"

namespace armcmc {

class Remembered;

/// The parts of a pack of a described plant that depend on no parameter.
struct PlantPack {
  expression::TapeScalars scalars;  ///< Scalars of every sample, in any mode.
  std::array<std::int8_t, kMaxPackSamples>
      mode{};  ///< Sampled mode that acts; the number of sampled modes where none does.
  std::array<std::uint8_t, kMaxPackSamples> law{};          ///< Index among the laws of that mode.
  std::array<double, kMaxPackSamples> target{};             ///< What the law of that mode explains.
  std::array<double, kMaxPackSamples> passive{};            ///< What is shown where no sampled mode acts.
  std::array<bool, kMaxPackSamples> passive_given{};        ///< A passive mode acts, and its law is given.
  StateRun states;                                          ///< Inputs and start of the integration.
  expression::PastLines past;                               ///< What candidates look up.
  std::array<PlantPoint::Values, kMaxPackSamples> point{};  ///< What rates read of each sample as signals.
};

/// A described plant as the estimator runs it: tapes for its laws, one program for everything that no parameter
/// changes.
///
/// Modes whose parameters are all their own are sampled apart. Where a parameter is shared, all modes are sampled as
/// one, which has a law for each; parameters of a mode then carry its name. The same applies where a law needs states,
/// which continue from mode to mode.
class PlantProgram {
 public:
  /// kLaws: what is sampled. kPrediction: what is shown as prediction of the output where the modes explain a target,
  /// as a law of all parameters and states.
  enum class Part : std::uint8_t { kLaws, kPrediction };

  /// @throws PlantError where the plant exceeds a limit of the estimator.
  explicit PlantProgram(std::shared_ptr<const Plant> plant, Part part = Part::kLaws);
  PlantProgram(const PlantProgram&) = delete;  // info() points into it
  PlantProgram& operator=(const PlantProgram&) = delete;

  /// The plant that was compiled.
  [[nodiscard]] const Plant& plant() const noexcept { return *plant_; }
  /// Whether a pack continues the previous one: functions with memory, or lines of kept samples.
  [[nodiscard]] bool has_memory() const noexcept { return features_.has_memory() || num_lines_ > 0; }
  /// Integration of the states; empty if there are none.
  [[nodiscard]] const PlantStates& states() const noexcept { return states_; }
  /// What the estimator needs to know; points into this object.
  [[nodiscard]] const ModelInfo& info() const noexcept { return info_; }
  /// Tapes of the laws of a sampled mode.
  [[nodiscard]] const std::vector<expression::Tape>& laws(int mode) const {
    return modes_[static_cast<std::size_t>(mode)].laws;
  }
  /// Number of values of each sample that the laws read.
  [[nodiscard]] int num_scalars() const noexcept { return num_scalars_; }
  /// Priors as sampled: of a lognormal parameter, that of the logarithm.
  [[nodiscard]] const std::vector<ParameterDescription>& sampled() const noexcept { return sampled_; }

  /// Goes through the samples of a pack.
  /// @param pack    Its inputs are the plant's signals without the output.
  /// @param memory  Of functions with memory: read, and updated for the next pack.
  /// @param before  States at the end of the previous pack if this one continues it; else null.
  /// @param out     What the laws need of each sample.
  /// @return false where something that is needed is not finite.
  /// @pre pack.Validate() == kOk, pack.num_inputs >= info().num_inputs.
  /// @rt No heap, no lock, no throw. O(samples).
  [[nodiscard]] bool Prepare(const DataPack& pack, expression::FeatureMemory* memory, const StateMemory* before,
                             PlantPack* out) const noexcept ARMCMC_NONBLOCKING;

  /// Stores what the next pack needs of the states at the last sample of this one.
  /// @pre Prepare() returned true for `pack`. @rt No heap, no lock, no throw.
  void Leave(const PlantPack& pack, int num_samples, StateMemory* memory) const noexcept ARMCMC_NONBLOCKING;

  /// The samples of one sampled mode.
  /// @param pack  From Prepare(); must outlive `data`, which points into it.
  /// @param num_samples  Of the pack.
  /// @param mode  In [0, info().num_modes).
  /// @param[out] data  The samples in which that mode acts.
  /// @rt No heap, no lock, no throw. O(samples).
  void Fill(const PlantPack& pack, int num_samples, int mode, ModeData* data) const noexcept ARMCMC_NONBLOCKING;

  /// Whether the law of a sampled mode predicts the plant's output, and not a target.
  [[nodiscard]] bool LawIsOutput(int mode) const noexcept ARMCMC_NONBLOCKING {
    return modes_[static_cast<std::size_t>(mode)].law_is_output;
  }

  /// The program of the prediction; null where the laws predict the output themselves.
  [[nodiscard]] const PlantProgram* prediction() const noexcept { return prediction_.get(); }
  /// Index, among the parameters of the prediction, of parameter d of a sampled mode.
  [[nodiscard]] int InPrediction(int mode, int d) const noexcept ARMCMC_NONBLOCKING {
    return in_prediction_[static_cast<std::size_t>(mode)][static_cast<std::size_t>(d)];
  }

  /// Reported quantity r for sampled parameters theta. @rt No heap, no lock, no throw.
  [[nodiscard]] double Report(int r, const double* theta) const noexcept ARMCMC_NONBLOCKING;
  /// True where it is the sampled parameter r.
  [[nodiscard]] bool IsReportedAsSampled(int r) const noexcept ARMCMC_NONBLOCKING;
  /// The sampled parameter d from its reported value; of a lognormal one, the logarithm.
  /// @rt No heap, no lock, no throw.
  [[nodiscard]] double Sampled(int d, double reported) const noexcept ARMCMC_NONBLOCKING;

 private:
  /// Tapes of the laws of one sampled mode; several where modes are sampled as one.
  struct SampledMode {
    std::string name;
    std::vector<expression::Tape> laws{};
    std::vector<expression::Tape> errors{};  ///< law - target.
    bool law_is_output = true;
    LinearPart linear{};
  };
  /// For every mode of the plant, in the order of its file: the positions of its parts among the features.
  struct Outputs {
    int when = -1;  ///< -1: always.
    int target = 0;
    int passive = -1;
    int sampled = -1;            ///< Sampled mode, -1: passive.
    int law = 0;                 ///< Index among its laws.
    bool passive_given = false;  ///< The law of a passive mode is given.
  };

  void ChooseParameters();
  /// The law of the mode that acts, the last one's where none does.
  template <class NodeOfMode>
  [[nodiscard]] int OfActingMode(NodeOfMode node_of);
  [[nodiscard]] bool LawsNeedStates() const;
  void CompileModes();
  /// Adds a law to the newest sampled mode.
  void CompileLaw(int law, int target, const std::string& key, std::vector<int>* scalars);
  void CompileFeatures(const std::vector<int>& scalars, const Remembered& remembered);
  void MakePrediction();
  void CompileStates(Remembered* remembered, std::vector<int>* scalars);
  /// Copies the samples before a pack to where candidates look them up.
  void CopyPastSamples(const expression::PastSamples& kept, int line, double first,
                       expression::PastLines* out) const noexcept ARMCMC_NONBLOCKING;
  void FillInfo();
  /// The node with the plant's parameters replaced by those that are sampled in one of its modes.
  [[nodiscard]] int InMode(int node, std::size_t active);

  std::shared_ptr<const Plant> plant_;
  Part part_;
  expression::Graph graph_;
  std::vector<std::size_t> active_;  ///< Modes of the plant that are not passive.
  bool merged_ = false;
  std::vector<ParameterDescription> sampled_;
  std::vector<std::vector<int>> index_;  ///< [active mode][parameter of the plant]: sampled parameter.
  std::vector<SampledMode> modes_;
  std::vector<Outputs> outputs_;
  PlantStates states_;
  int num_scalars_ = 0;
  int num_remembered_ = 0, first_remembered_ = 0;    ///< Among the features: what rates read of functions with memory.
  int num_lines_ = 0, first_line_ = 0;               ///< Likewise: what is kept to be looked up.
  expression::FeatureProgram features_;              ///< Scalars of the tapes, then what outputs_ refers to.
  std::vector<expression::FeatureProgram> reports_;  ///< Each reads parameters as signals.
  std::vector<std::string> names_, units_;
  std::string target_unit_;
  ModelInfo info_{};
  std::unique_ptr<const PlantProgram> prediction_;
  std::array<std::array<int, kMaxParams>, kMaxModes> in_prediction_{};
};

}  // namespace armcmc
