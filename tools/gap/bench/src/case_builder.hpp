#pragma once

#include <cstdint>
#include <filesystem>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "armcmc/gap_bench/case.hpp"

namespace armcmc::gap_bench {

/// Writes the scenarios of a stratum and gives every case the random numbers of its cell.
class CaseBuilder {
 public:
  CaseBuilder(std::string stratum, int logs, std::uint64_t seed, std::filesystem::path folder)
      : stratum_(std::move(stratum)), logs_(logs), seed_(seed), folder_(std::move(folder)) {}

  /// Adds the logs of a cell; `finish` may change a case, with random numbers of its own.
  template <typename Finish>
  void Cell(const Case& like, const std::string& cell, const Finish& finish) {
    for (int k = 0; k < logs_; ++k) {
      std::mt19937_64 random(SeedOf(like, cell, k));
      Case one = like;
      one.stratum = stratum_;
      one.seed = 1 + random() % 999'999'999;
      finish(&one, &random);
      cases_.push_back(std::move(one));
    }
  }
  void Cell(const Case& like, const std::string& cell) {
    Cell(like, cell, [](Case*, std::mt19937_64*) {});
  }
  void Add(Case one) { cases_.push_back(std::move(one)); }

  /// Writes a scenario. @return its path from the folder of the run.
  [[nodiscard]] std::string Write(const std::string& name, const std::string& text) const;
  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }
  [[nodiscard]] std::vector<Case> Take() { return std::move(cases_); }

 private:
  [[nodiscard]] std::uint64_t SeedOf(const Case& like, const std::string& cell, int k) const;

  std::string stratum_;
  int logs_;
  std::uint64_t seed_;
  std::filesystem::path folder_;
  std::vector<Case> cases_;
};

/// Text of a scenario that comes with the plant.
[[nodiscard]] std::string ScenarioOfPlant(const std::string& name);
[[nodiscard]] Case Like(const std::string& group, const std::string& scenario, const std::string& effect,
                        double strength);
/// "R 0.3"
[[nodiscard]] std::string GroupOf(double strength);
/// Two different effects of the catalogue, drawn.
[[nodiscard]] std::pair<std::string, std::string> DrawPair(std::mt19937_64* random);
/// A [[hidden_effect]] table. The first of a file may go on with its seed, which draws for all.
/// @param effect  "NAME:VARIANT", or a name with one formula.
[[nodiscard]] std::string HiddenTable(const std::string& effect, double strength);
/// "0.3"
[[nodiscard]] std::string Short(double value);

}  // namespace armcmc::gap_bench
