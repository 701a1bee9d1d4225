#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "armcmc/plant_sim/series.hpp"

namespace armcmc::plant_sim {

/// A setting that a plant family offers to a scenario file: which table and key, what is allowed, what it means.
struct OptionSpec {
  enum class Kind : std::uint8_t { kNumber, kList, kChoice, kSeries };

  static OptionSpec Number(std::string table, std::string key, double fallback, double lo, double hi);
  static OptionSpec List(std::string table, std::string key, std::vector<double> fallback, double lo, double hi);
  /// The first choice is the fallback.
  static OptionSpec Choice(std::string table, std::string key, std::vector<std::string> choices);
  /// A column of a CSV file; the fallback is none.
  static OptionSpec Series(std::string table, std::string key, std::string column);

  std::string table, key;
  Kind kind = Kind::kNumber;
  double number = 0.0;               ///< Fallback of a number.
  std::vector<double> list;          ///< Fallback of a list.
  std::vector<std::string> choices;  ///< Allowed words.
  std::string column;                ///< Of a series.
  double lo = 0.0, hi = 0.0;         ///< Allowed range of a number or of every element.
};

/// Longest list an option can hold.
inline constexpr int kMaxOptionList = 64;

/// Values of a family's options. Set-up only: reading allocates nothing, but looks names up.
class Options {
 public:
  using Value = std::variant<double, std::vector<double>, std::string, std::shared_ptr<const Series>>;

  /// Every option at its fallback.
  explicit Options(const std::vector<OptionSpec>& specs);

  /// @throws std::invalid_argument when the family has no such option, or it is of another kind.
  void Set(const std::string& key, Value value);
  [[nodiscard]] double Number(const std::string& key) const;
  [[nodiscard]] const std::vector<double>& List(const std::string& key) const;
  [[nodiscard]] const std::string& Choice(const std::string& key) const;
  /// Null: none was given.
  [[nodiscard]] const std::shared_ptr<const Series>& Recorded(const std::string& key) const;

 private:
  std::map<std::string, Value> values_;
};

}  // namespace armcmc::plant_sim
