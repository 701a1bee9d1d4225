#pragma once

#include <stdexcept>
#include <string>
#include <vector>

namespace armcmc {

/// A plant that cannot be: which key of its file, where in the value, and what is wrong.
class PlantError : public std::runtime_error {
 public:
  /// @param key     "law", "parameters.M.sd", "mode[1].when", ...: the path of the value in a plant file.
  /// @param column  Of a text: the character in it, from 1. 0: the value as a whole.
  /// @param what    What is wrong, in words.
  /// @param unknown, known  As below.
  PlantError(std::string key, int column, const std::string& what, std::string unknown = "",
             std::vector<std::string> known = {})
      : std::runtime_error(what),
        key_(std::move(key)),
        column_(column),
        unknown_(std::move(unknown)),
        known_(std::move(known)) {}

  [[nodiscard]] const std::string& key() const noexcept { return key_; }
  [[nodiscard]] int column() const noexcept { return column_; }
  /// A name that nothing has, and those that could have been meant; empty where that is not what is wrong.
  [[nodiscard]] const std::string& unknown() const noexcept { return unknown_; }
  [[nodiscard]] const std::vector<std::string>& known() const noexcept { return known_; }

 private:
  std::string key_;
  int column_;
  std::string unknown_;
  std::vector<std::string> known_;
};

}  // namespace armcmc
