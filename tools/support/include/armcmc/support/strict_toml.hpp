#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace armcmc::support {

/// A configuration error a person can act on: "file.toml:12:13: timing.period_ms = -3: expected a number in [1,
/// 10000]".
class ConfigError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// One table of a strictly read TOML file.
///
/// Every getter names the key, its line and column and the allowed range when the type or value is wrong. Finish() then
/// rejects every key that no getter requested and names the nearest known key, so that a typo never passes.
class StrictTable {
 public:
  /// Reads a whole file. @throws ConfigError when it cannot be read or parsed (with line and column).
  static StrictTable FromFile(const std::filesystem::path& path);
  /// Reads text; `name` stands for the file in messages.
  static StrictTable FromText(std::string_view text, std::string_view name);

  [[nodiscard]] bool Has(std::string_view key) const;
  /// True when the key holds a text: for keys that take either a word or a number.
  [[nodiscard]] bool IsText(std::string_view key) const;
  /// True when the key holds a table: for keys that take either a number or a table.
  [[nodiscard]] bool IsTable(std::string_view key) const;
  /// Leaves a key, with everything below it, to another program that reads the same file.
  void LeaveToOthers(std::string_view key);

  // Optional keys: the fallback is used when the key is absent.
  double Number(std::string_view key, double fallback, double lo, double hi);
  std::int64_t Integer(std::string_view key, std::int64_t fallback, std::int64_t lo, std::int64_t hi);
  bool Boolean(std::string_view key, bool fallback);
  std::string Text(std::string_view key, std::string_view fallback);
  /// One of `allowed`; the message lists them.
  std::string Choice(std::string_view key, std::string_view fallback, const std::vector<std::string>& allowed);
  std::vector<double> Numbers(std::string_view key, const std::vector<double>& fallback, std::size_t min_size,
                              std::size_t max_size, double lo, double hi);

  /// Array of arrays of `size` numbers each, in [lo, hi]; absent reads as none.
  std::vector<std::vector<double>> NumberLists(std::string_view key, std::size_t size, double lo, double hi);

  /// `schema`, the version of the file's format: 1 so far. To be asked for before anything else, so that a file of a
  /// newer version is said to be one. @throws ConfigError for another number, or none.
  void RequireSchema();

  // Required keys.
  double RequiredNumber(std::string_view key, double lo, double hi);
  std::int64_t RequiredInteger(std::string_view key, std::int64_t lo, std::int64_t hi);
  std::string RequiredText(std::string_view key);
  std::string RequiredChoice(std::string_view key, const std::vector<std::string>& allowed);

  /// Sub-table; an absent one reads as empty. @throws ConfigError when the key holds something else.
  StrictTable Table(std::string_view key);
  /// Array of tables ([[key]]); absent reads as none.
  std::vector<StrictTable> Tables(std::string_view key);
  /// Array of texts; a text alone counts as one. Absent reads as none.
  std::vector<std::string> Texts(std::string_view key);
  struct TextOrTable;
  /// Array whose elements are texts or tables; absent reads as none.
  std::vector<TextOrTable> TextsOrTables(std::string_view key);
  /// Names of the keys of this table, in file order.
  [[nodiscard]] std::vector<std::string> Keys() const;

  /// Name of the file in messages.
  [[nodiscard]] std::string Name() const;

  /// Rejects unknown keys of this table and of every sub-table that was handed out. Call once, at the end, on the root.
  void Finish() const;

  /// A ConfigError at the place of `key`, for checks that span several keys.
  [[nodiscard]] ConfigError Error(std::string_view key, std::string_view problem) const;
  /// The same at a character of a text, from 1: for what is wrong inside it.
  [[nodiscard]] ConfigError ErrorInText(std::string_view key, int character, std::string_view problem) const;

 private:
  struct Document;
  struct Node;
  explicit StrictTable(std::shared_ptr<Node> node);
  std::shared_ptr<Node> node_;
};

/// An element of an array that holds words, and tables where there is more to say.
struct StrictTable::TextOrTable {
  std::string text;   ///< Empty: a table.
  StrictTable table;  ///< Empty: a text.
};

}  // namespace armcmc::support
