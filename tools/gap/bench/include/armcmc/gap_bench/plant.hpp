#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "armcmc/gap/recording.hpp"
#include "armcmc/gap_bench/case.hpp"

namespace armcmc::gap_bench {

/// Runs armcmc-plant as a process of its own, so that nothing of what it hides is in this one.
class PlantProcess {
 public:
  /// @param program  armcmc-plant.
  /// @param folder   Where it runs and writes.
  PlantProcess(const std::filesystem::path& program, const std::filesystem::path& folder);

  /// Makes NAME.csv, with the columns of a real recording only, and NAME.sealed.json.
  /// @return false when the effect cannot reach its strength in this motion.
  /// @throws std::runtime_error when the plant fails.
  [[nodiscard]] bool Make(const Case& what) const;
  /// What a scenario of `what`'s seed records; what it hides is what the scenario file says.
  [[nodiscard]] gap::Recording Rerun(const Case& what, const std::string& scenario_text) const;
  /// The measured outputs of a scenario of `what`'s seed, [output][row]; what it hides is what the scenario file says.
  [[nodiscard]] std::vector<std::vector<double>> Outputs(const Case& what, const std::string& scenario_text) const;

  [[nodiscard]] std::filesystem::path Recording(const Case& what) const;
  [[nodiscard]] std::filesystem::path Sealed(const Case& what) const;
  /// Removes both files.
  void Remove(const Case& what) const;
  /// The command line that makes a case.
  [[nodiscard]] static std::vector<std::string> Arguments(const Case& what);
  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }

 private:
  std::filesystem::path program_, folder_;
};

/// Columns of a recording in which the equations of a model predict something: one for each equation.
[[nodiscard]] std::vector<std::string> OutputsOf(const std::string& model);

/// Reads a sealed file of a plant that `model` describes.
/// @throws std::runtime_error when it cannot be read.
[[nodiscard]] Truth ReadSealed(const std::filesystem::path& path, const std::string& model);

/// The hidden effects of a truth as tables of a scenario file, every parameter fixed.
/// @param gates  Whether effects keep their gates; otherwise they act always.
[[nodiscard]] std::string EffectTables(const Truth& truth, bool gates);

}  // namespace armcmc::gap_bench
