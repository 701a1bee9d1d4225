#include "armcmc/support/strict_toml.hpp"

#include <toml++/toml.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <sstream>
#include <tuple>
#include <utility>

#include "armcmc/support/printable.hpp"
#include "nearest.hpp"

namespace armcmc::support {

/// The document outlives every table handed out of it.
struct StrictTable::Document {
  std::string name;
  toml::table root;
};

namespace {

std::string ShortNumber(double value) {
  std::array<char, 32> text{};
  const auto result = std::to_chars(text.data(), text.data() + text.size(), value);
  return {text.data(), result.ptr};
}

std::string ANumber(double lo, double hi) {
  if (std::isinf(lo) && std::isinf(hi)) return "a finite number";
  if (std::isinf(hi) && lo == std::numeric_limits<double>::min()) return "a positive number";
  if (std::isinf(hi)) return "a number that is at least " + ShortNumber(lo);
  if (std::isinf(lo)) return "a number that is at most " + ShortNumber(hi);
  return "a number in [" + ShortNumber(lo) + ", " + ShortNumber(hi) + "]";
}

std::string AnInteger(std::int64_t lo, std::int64_t hi) {
  using Limits = std::numeric_limits<std::int64_t>;
  if (lo == Limits::min() && hi == Limits::max()) return "an integer";
  if (hi == Limits::max()) return "an integer that is at least " + std::to_string(lo);
  return "an integer in [" + std::to_string(lo) + ", " + std::to_string(hi) + "]";
}

/// The value as the file has it, cut to what fits a message.
std::string Shown(const toml::node& node) {
  if (node.is_table()) return "a table";
  std::ostringstream out;
  if (const auto* string = node.as_string()) {
    out << '"' << string->get() << '"';
  } else {
    out << toml::node_view<const toml::node>(node);
  }
  std::string text = out.str();
  std::replace(text.begin(), text.end(), '\n', ' ');
  return Printable(text);
}

std::string KeyText(std::string_view key) {
  const bool bare = !key.empty() && std::all_of(key.begin(), key.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
  });
  return bare ? Printable(key) : '"' + Printable(key) + '"';
}

std::string Listed(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

}  // namespace

struct StrictTable::Node {
  std::shared_ptr<const Document> document;
  const toml::table* table = nullptr;  ///< Null when the file does not have it.
  std::string path;                    ///< "timing", empty for the root.
  toml::source_position at{1, 1};      ///< Of the table itself; of one that is absent, of that around it.
  std::string hint;                    ///< Of one that is absent: the key that may have been meant for it.
  std::vector<std::string> asked;      ///< Keys that a getter asked for, in order.
  std::vector<std::pair<std::string, std::shared_ptr<Node>>> children;

  [[nodiscard]] const toml::node* Lookup(std::string_view key) {
    if (std::find(asked.begin(), asked.end(), key) == asked.end()) asked.emplace_back(key);
    return Peek(key);
  }
  [[nodiscard]] const toml::node* Peek(std::string_view key) const {
    return table == nullptr ? nullptr : table->get(key);
  }
  [[nodiscard]] std::string PathOf(std::string_view key) const {
    return path.empty() ? KeyText(key) : path + "." + KeyText(key);
  }
  [[nodiscard]] std::string Place(toml::source_position position) const {
    return document->name + ":" + std::to_string(position.line) + ":" + std::to_string(position.column) + ": ";
  }
  [[nodiscard]] ConfigError Wrong(std::string_view key, const toml::node& node, const std::string& expected) const {
    return ConfigError(Place(node.source().begin) + PathOf(key) + " = " + Shown(node) + ": expected " + expected);
  }
  [[nodiscard]] ConfigError Missing(std::string_view key, const std::string& expected) const {
    const auto [typo, place] = MeantFor(key);
    return ConfigError(Place(place) + PathOf(key) + " is missing: expected " + expected + (typo.empty() ? hint : typo));
  }
  /// What is said of an unknown key that is nearly `key`, and where it stands; nothing, and where the table stands.
  [[nodiscard]] std::pair<std::string, toml::source_position> MeantFor(std::string_view key) const {
    for (const std::string& name : UnreadKeys())
      if (Nearest(name, {std::string(key)}) == key)
        return {" (" + PathOf(name) + " is set; is it a typo?)", table->get(name)->source().begin};
    return {"", at};
  }
  [[nodiscard]] std::vector<std::string> UnreadKeys() const {
    std::vector<std::string> names;
    if (table == nullptr) return names;
    for (const auto& [key, value] : *table)
      if (std::find(asked.begin(), asked.end(), key.str()) == asked.end()) names.emplace_back(key.str());
    return names;
  }
  /// @param index  Of an element of an array, "[0]"; else empty.
  [[nodiscard]] std::shared_ptr<Node> Child(std::string_view key, const std::string& index,
                                            const toml::table* child_table) {
    const std::string whole = std::string(key) + index;
    for (const auto& [name, node] : children)
      if (name == whole) return node;
    auto child = std::make_shared<Node>();
    child->document = document;
    child->table = child_table;
    child->path = PathOf(key) + index;
    if (child_table == nullptr)
      std::tie(child->hint, child->at) = MeantFor(key);
    else
      child->at = child_table->source().begin;
    children.emplace_back(whole, child);
    return child;
  }
  /// Unknown keys of this table and those below, with their places.
  void CollectUnknown(std::vector<std::pair<std::pair<std::uint32_t, std::uint32_t>, std::string>>* problems) const {
    for (const std::string& name : UnreadKeys()) {
      const toml::source_position place = table->get(name)->source().begin;
      std::string text = Place(place) + PathOf(name) + ": unknown key" + DidYouMean(name, asked);
      if (Nearest(name, asked).empty() && !asked.empty())
        text +=
            "; known " + (path.empty() ? std::string("at the top level") : "in [" + path + "]") + ": " + Listed(asked);
      problems->emplace_back(std::make_pair(place.line, place.column), std::move(text));
    }
    for (const auto& [name, child] : children) child->CollectUnknown(problems);
  }
  double CheckedNumber(std::string_view key, const toml::node& node, double lo, double hi) const {
    const auto value = node.value<double>();
    const bool is_number = node.is_floating_point() || node.is_integer();
    if (!is_number || !value || !std::isfinite(*value) || *value < lo || *value > hi)
      throw Wrong(key, node, ANumber(lo, hi));
    return *value;
  }
  std::int64_t CheckedInteger(std::string_view key, const toml::node& node, std::int64_t lo, std::int64_t hi) const {
    const std::optional<std::int64_t> value = node.is_integer() ? node.value<std::int64_t>() : std::nullopt;
    if (!value || *value < lo || *value > hi) throw Wrong(key, node, AnInteger(lo, hi));
    return *value;
  }
  std::string CheckedText(std::string_view key, const toml::node& node) const {
    if (!node.is_string()) throw Wrong(key, node, "a string in quotes");
    return *node.value<std::string>();
  }
  std::string CheckedChoice(std::string_view key, const toml::node& node,
                            const std::vector<std::string>& allowed) const {
    if (!node.is_string()) throw Wrong(key, node, "one of " + Listed(allowed) + ", in quotes");
    std::string value = *node.value<std::string>();
    if (std::find(allowed.begin(), allowed.end(), value) == allowed.end())
      throw Wrong(key, node, "one of " + Listed(allowed) + DidYouMean(value, allowed));
    return value;
  }
};

StrictTable::StrictTable(std::shared_ptr<Node> node) : node_(std::move(node)) {}

StrictTable StrictTable::FromFile(const std::filesystem::path& path) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error))
    throw ConfigError(path.string() + ": is a folder, expected a TOML file");
  std::ifstream file(path, std::ios::binary);
  if (!file) throw ConfigError(path.string() + ": cannot be read, expected a TOML file");
  const std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  return FromText(text, path.string());
}

StrictTable StrictTable::FromText(std::string_view text, std::string_view name) {
  auto document = std::make_shared<Document>();
  document->name = name;
  try {
    document->root = toml::parse(text, name);
  } catch (const toml::parse_error& error) {
    const toml::source_position at = error.source().begin;
    throw ConfigError(document->name + ":" + std::to_string(at.line) + ":" + std::to_string(at.column) + ": " +
                      Escaped(error.description()));
  }
  auto node = std::make_shared<Node>();
  node->table = &document->root;
  node->document = std::move(document);
  return StrictTable(std::move(node));
}

bool StrictTable::Has(std::string_view key) const { return node_->Peek(key) != nullptr; }

bool StrictTable::IsText(std::string_view key) const {
  const toml::node* node = node_->Peek(key);
  return node != nullptr && node->is_string();
}

bool StrictTable::IsTable(std::string_view key) const {
  const toml::node* node = node_->Peek(key);
  return node != nullptr && node->is_table();
}

void StrictTable::LeaveToOthers(std::string_view key) {
  static_cast<void>(node_->Lookup(key));
  std::erase_if(node_->children, [key](const auto& child) { return child.first == key; });
}

double StrictTable::Number(std::string_view key, double fallback, double lo, double hi) {
  const toml::node* node = node_->Lookup(key);
  return node == nullptr ? fallback : node_->CheckedNumber(key, *node, lo, hi);
}

std::int64_t StrictTable::Integer(std::string_view key, std::int64_t fallback, std::int64_t lo, std::int64_t hi) {
  const toml::node* node = node_->Lookup(key);
  return node == nullptr ? fallback : node_->CheckedInteger(key, *node, lo, hi);
}

bool StrictTable::Boolean(std::string_view key, bool fallback) {
  const toml::node* node = node_->Lookup(key);
  if (node == nullptr) return fallback;
  if (!node->is_boolean()) throw node_->Wrong(key, *node, "true or false");
  return *node->value<bool>();
}

std::string StrictTable::Text(std::string_view key, std::string_view fallback) {
  const toml::node* node = node_->Lookup(key);
  return node == nullptr ? std::string(fallback) : node_->CheckedText(key, *node);
}

std::string StrictTable::Choice(std::string_view key, std::string_view fallback,
                                const std::vector<std::string>& allowed) {
  const toml::node* node = node_->Lookup(key);
  return node == nullptr ? std::string(fallback) : node_->CheckedChoice(key, *node, allowed);
}

std::vector<double> StrictTable::Numbers(std::string_view key, const std::vector<double>& fallback,
                                         std::size_t min_size, std::size_t max_size, double lo, double hi) {
  const toml::node* node = node_->Lookup(key);
  if (node == nullptr) return fallback;
  const toml::array* array = node->as_array();
  if (array == nullptr || array->size() < min_size || array->size() > max_size) {
    const std::string count =
        min_size == max_size ? std::to_string(min_size) : std::to_string(min_size) + " to " + std::to_string(max_size);
    throw node_->Wrong(key, *node, "an array of " + count + " numbers");
  }
  std::vector<double> values;
  values.reserve(array->size());
  for (const toml::node& element : *array) values.push_back(node_->CheckedNumber(key, element, lo, hi));
  return values;
}

std::vector<std::vector<double>> StrictTable::NumberLists(std::string_view key, std::size_t size, double lo,
                                                          double hi) {
  const toml::node* node = node_->Lookup(key);
  if (node == nullptr) return {};
  const std::string expected = "lists of " + std::to_string(size) + " numbers, as in [[0, 15]]";
  const toml::array* array = node->as_array();
  if (array == nullptr) throw node_->Wrong(key, *node, expected);
  std::vector<std::vector<double>> lists;
  for (const toml::node& element : *array) {
    const toml::array* numbers = element.as_array();
    if (numbers == nullptr || numbers->size() != size) throw node_->Wrong(key, element, expected);
    std::vector<double>& list = lists.emplace_back();
    for (const toml::node& number : *numbers) list.push_back(node_->CheckedNumber(key, number, lo, hi));
  }
  return lists;
}

double StrictTable::RequiredNumber(std::string_view key, double lo, double hi) {
  const toml::node* node = node_->Lookup(key);
  if (node == nullptr) throw node_->Missing(key, ANumber(lo, hi));
  return node_->CheckedNumber(key, *node, lo, hi);
}

std::int64_t StrictTable::RequiredInteger(std::string_view key, std::int64_t lo, std::int64_t hi) {
  const toml::node* node = node_->Lookup(key);
  if (node == nullptr) throw node_->Missing(key, AnInteger(lo, hi));
  return node_->CheckedInteger(key, *node, lo, hi);
}

void StrictTable::RequireSchema() {
  constexpr std::int64_t kSchema = 1;
  const toml::node* node = node_->Lookup("schema");
  if (node != nullptr && node->value<std::int64_t>().value_or(0) > kSchema)
    throw node_->Wrong("schema", *node, std::to_string(kSchema) + "; the file is of a newer version of the program");
  (void)RequiredInteger("schema", kSchema, kSchema);
}

std::string StrictTable::RequiredText(std::string_view key) {
  const toml::node* node = node_->Lookup(key);
  if (node == nullptr) throw node_->Missing(key, "a string in quotes");
  return node_->CheckedText(key, *node);
}

std::string StrictTable::RequiredChoice(std::string_view key, const std::vector<std::string>& allowed) {
  const toml::node* node = node_->Lookup(key);
  if (node == nullptr) throw node_->Missing(key, "one of " + Listed(allowed));
  return node_->CheckedChoice(key, *node, allowed);
}

StrictTable StrictTable::Table(std::string_view key) {
  const toml::node* node = node_->Lookup(key);
  if (node != nullptr && !node->is_table()) throw node_->Wrong(key, *node, "a table, [" + node_->PathOf(key) + "]");
  return StrictTable(node_->Child(key, "", node == nullptr ? nullptr : node->as_table()));
}

std::vector<StrictTable> StrictTable::Tables(std::string_view key) {
  const toml::node* node = node_->Lookup(key);
  std::vector<StrictTable> tables;
  if (node == nullptr) return tables;
  const toml::array* array = node->as_array();
  if (array == nullptr) throw node_->Wrong(key, *node, "an array of tables, [[" + node_->PathOf(key) + "]]");
  for (const toml::node& element : *array) {
    if (!element.is_table()) throw node_->Wrong(key, element, "an array of tables, [[" + node_->PathOf(key) + "]]");
    const std::string index = "[" + std::to_string(tables.size()) + "]";
    tables.push_back(StrictTable(node_->Child(key, index, element.as_table())));
  }
  return tables;
}

std::vector<std::string> StrictTable::Texts(std::string_view key) {
  const toml::node* node = node_->Lookup(key);
  if (node == nullptr) return {};
  if (node->is_string()) return {*node->value<std::string>()};
  const toml::array* array = node->as_array();
  if (array == nullptr) throw node_->Wrong(key, *node, "texts in quotes, in [ ]");
  std::vector<std::string> texts;
  for (const toml::node& element : *array) texts.push_back(node_->CheckedText(key, element));
  return texts;
}

std::vector<StrictTable::TextOrTable> StrictTable::TextsOrTables(std::string_view key) {
  const toml::node* node = node_->Lookup(key);
  if (node == nullptr) return {};
  const toml::array* array = node->as_array();
  if (array == nullptr) throw node_->Wrong(key, *node, "names in quotes, or tables, in [ ]");
  std::vector<TextOrTable> items;
  for (const toml::node& element : *array) {
    const std::string index = "[" + std::to_string(items.size()) + "]";
    const StrictTable table(node_->Child(key, index, element.as_table()));
    if (!element.is_table() && !element.is_string())
      throw node_->Wrong(key, element, "a name in quotes, or a table { name = \"..\", .. }");
    items.push_back({element.is_string() ? *element.value<std::string>() : "", table});
  }
  return items;
}

std::vector<std::string> StrictTable::Keys() const {
  std::vector<std::pair<std::pair<std::uint32_t, std::uint32_t>, std::string>> placed;
  if (node_->table == nullptr) return {};
  for (const auto& [key, value] : *node_->table) {
    const toml::source_position at = value.source().begin;
    placed.emplace_back(std::make_pair(at.line, at.column), std::string(key.str()));
  }
  // The parser keeps keys by name; people expect the order that they wrote.
  std::sort(placed.begin(), placed.end());
  std::vector<std::string> names;
  names.reserve(placed.size());
  for (auto& [at, name] : placed) names.push_back(std::move(name));
  return names;
}

std::string StrictTable::Name() const { return node_->document->name; }

void StrictTable::Finish() const {
  std::vector<std::pair<std::pair<std::uint32_t, std::uint32_t>, std::string>> problems;
  node_->CollectUnknown(&problems);
  if (problems.empty()) return;
  throw ConfigError(std::min_element(problems.begin(), problems.end())->second);
}

ConfigError StrictTable::Error(std::string_view key, std::string_view problem) const {
  return ErrorInText(key, 0, problem);
}

ConfigError StrictTable::ErrorInText(std::string_view key, int character, std::string_view problem) const {
  const toml::node* node = node_->Peek(key);
  const std::string shown = node == nullptr || node->is_table() ? "" : " = " + Shown(*node);
  toml::source_position place = node == nullptr ? node_->at : node->source().begin;
  // Behind the quote; a text over several lines is found by its first.
  if (node != nullptr && character > 0 && place.line == node->source().end.line)
    place.column += static_cast<toml::source_index>(character);
  return ConfigError(node_->Place(place) + node_->PathOf(key) + shown + ": " + std::string(problem));
}

}  // namespace armcmc::support
