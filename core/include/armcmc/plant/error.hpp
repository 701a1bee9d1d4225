#pragma once

#include <stdexcept>
#include <string>
#include <vector>

namespace armcmc {

/// A plant description that is invalid: the key of the value in its file, the position in the value, and what is wrong.
/// Thrown when a Plant or an effect is set up. The reader of a file adds its name and line, and a suggestion from
/// known().
/// @code
/// try {
///   auto plant = std::make_shared<const Plant>(description);
/// } catch (const PlantError& e) {
///   std::cerr << e.key() << ": " << e.what() << '\n';  // law: unknown name "kk"
/// }
/// @endcode
class PlantError : public std::runtime_error {
 public:
  /// @param key      Path of the value in a plant file: "law", "parameters.M.sd", "mode[1].when".
  /// @param column   Position in a text, in characters from 1; 0: the value as a whole.
  /// @param what     What is wrong and what was expected, in one line.
  /// @param unknown  An undefined name, if that is the error.
  /// @param known    The names that are defined there.
  PlantError(std::string key, int column, const std::string& what, std::string unknown = "",
             std::vector<std::string> known = {})
      : std::runtime_error(what),
        key_(std::move(key)),
        column_(column),
        unknown_(std::move(unknown)),
        known_(std::move(known)) {}

  /// Path of the value in a plant file.
  [[nodiscard]] const std::string& key() const noexcept { return key_; }
  /// Position in the value, in characters from 1; 0: the value as a whole.
  [[nodiscard]] int column() const noexcept { return column_; }
  /// The undefined name; empty if that is not the error.
  [[nodiscard]] const std::string& unknown() const noexcept { return unknown_; }
  /// The names that could have been meant; empty if that is not the error.
  [[nodiscard]] const std::vector<std::string>& known() const noexcept { return known_; }

 private:
  std::string key_;
  int column_;
  std::string unknown_;
  std::vector<std::string> known_;
};

}  // namespace armcmc
