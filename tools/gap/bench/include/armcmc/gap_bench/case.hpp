#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "armcmc/gap/result.hpp"
#include "armcmc/models/registry.hpp"

namespace armcmc::gap_bench {

/// What of a recording the tool is given.
enum class Part { kWhole, kFirstHalf, kSecondHalf };
[[nodiscard]] const char* PartName(Part part);

/// One recording that is to be made and diagnosed. What it says about the hidden effect goes to the plant alone.
struct Case {
  std::string stratum;                 ///< "singles"
  std::string group;                   ///< Row of the table within the stratum: "R 0.3".
  std::string scenario;                ///< Of the plant: a name, or a file relative to the folder of the run.
  std::string model = DefaultModel();  ///< That the tool is given.
  std::string effect;                  ///< --hide-effect; empty: the scenario hides effects of its own.
  std::string gate;                    ///< --effect-gate; empty: none.
  double strength = 1.0;
  std::uint64_t seed = 1;
  Part part = Part::kWhole;
  /// Effects that a real recording is known to hold by itself: naming them in addition to what is hidden is not judged.
  std::vector<std::string> own;
  std::vector<std::string> without;  ///< Effects that are taken out of the catalogue of the tool.
  /// The case whose tie this one is to resolve, the tool is given both recordings. Null: none.
  std::shared_ptr<const Case> earlier{};

  /// Unique within a run, good as a file name.
  [[nodiscard]] std::string Name() const;
};

/// An effect as the sealed file tells it.
struct TrueEffect {
  std::string name, variant, kind;  ///< kind: catalogue, variant, outside.
  std::string gate;                 ///< "always", "contact", "free", "from:S", "until:S"
  std::optional<double> onset_s;
  std::vector<std::pair<std::string, double>> parameters;
};

/// The sealed file.
struct Truth {
  std::vector<TrueEffect> effects;
  std::vector<std::pair<std::string, double>> base_parameters;
  std::string noise_tables;      ///< As tables of a scenario file.
  std::vector<double> noise_sd;  ///< Of each output (OutputsOf the model), in its unit.
};

/// The answer of the tool, its curves left out.
struct Answer {
  gap::Result result;
  double cpu_s = 0.0;  ///< Processor time of the diagnosis and its proof, without that of the ladder's second thread.
  std::string error;   ///< Why there is no result; empty when there is one.
};

/// How an answer stands to the truth.
enum class Grade {
  kRight,     ///< The truth and nothing else. Of data without an effect: nothing beyond the noise. Of an effect outside
              ///< the catalogue: unnamed.
  kTie,       ///< Several sets, the truth among them.
  kFamily,    ///< Another effect of the same family; where the plant is not the catalogue, also two of it for one.
  kPartial,   ///< One of two effects, and nothing false.
  kUnnamed,   ///< Something without a name, where there is an effect with one, or nothing.
  kNone,      ///< Nothing beyond the noise, where there is something.
  kWrong,     ///< A false name.
  kNotShown,  ///< What was not found leaves no trace in the part that is diagnosed.
  kNotMade,   ///< The plant cannot hide this effect at this strength in this motion.
  kFailed,    ///< No answer: the tool failed, or the plant did.
};
inline constexpr int kNumGrades = 10;
[[nodiscard]] const char* GradeName(Grade grade);

/// Rms over noise below which an effect leaves no trace: its square is the share of the noise variance that the
/// workflow never names.
inline constexpr double kTrace = 0.07;

/// A finished case.
struct Outcome {
  Case what;
  Truth truth;
  Answer answer;
  Grade grade = Grade::kNotMade;
  std::string label;             ///< What the tool holds most probable, see TopLabel.
  double label_probability = 0;  ///< Printed with it.
  bool label_right = false;
  std::optional<double> onset_error_s;  ///< Beyond the times at which the data cannot tell the onset apart.
  std::optional<double> onset_off_s;    ///< From the true onset itself, at which the effect need not leave a trace.
  std::optional<bool> when_right;       ///< Contact-only and free-only effects: so named.
  /// Of a plant with several equations, where a gap was found: it was found in one that the effect changes.
  std::optional<bool> equation_right;
  /// Of effects that were not found: rms of what they add to the output in the diagnosed part of the recording, over
  /// the noise. A bound of R there, since the base parameters absorb some of it.
  std::optional<double> diagnosed_strength;
  /// Where nothing is hidden, but the plant is not its model: rms of what the refitted model cannot follow, over the
  /// noise, in the output that shows most of it.
  std::optional<double> model_error;
  /// Where the plant is not the catalogue: of what the true effect would close of the gap if all else stayed as it is,
  /// the share that the first rung closes (of two effects: that all rungs close).
  std::optional<double> first_rung;
};

}  // namespace armcmc::gap_bench
