#include "support/json.hpp"

#include <cmath>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <ostream>
#include <stdexcept>
#include <utility>

namespace armcmc::test {

struct Json::Node {
  std::shared_ptr<const nlohmann::json> document;  // owns what `value` is a part of
  const nlohmann::json* value;
};

namespace {

const nlohmann::json kNull;

}  // namespace

Json Json::Parse(std::string_view text) {
  try {
    auto document = std::make_shared<const nlohmann::json>(nlohmann::json::parse(text));
    const nlohmann::json* value = document.get();
    return Json(std::make_shared<const Node>(Node{std::move(document), value}));
  } catch (const nlohmann::json::exception& error) {
    throw std::runtime_error(std::string(error.what()) + " in: " + std::string(text.substr(0, 200)));
  }
}

Json Json::Member(std::string_view key) const {
  if (!contains(key)) throw std::out_of_range("no \"" + std::string(key) + "\" in " + dump().substr(0, 200));
  return Json(std::make_shared<const Node>(Node{node_->document, &(*node_->value)[std::string(key)]}));
}

Json Json::Element(std::size_t index) const {
  if (!is_array() || index >= size()) {
    throw std::out_of_range("no element " + std::to_string(index) + " in " + dump().substr(0, 200));
  }
  return Value(index);
}

Json Json::Value(std::size_t index) const {
  const auto it = std::next(node_->value->begin(), static_cast<std::ptrdiff_t>(index));
  return Json(std::make_shared<const Node>(Node{node_->document, &*it}));
}

std::vector<std::string> Json::keys() const {
  std::vector<std::string> keys;
  if (is_object())
    for (const auto& [key, value] : node_->value->items()) keys.push_back(key);
  return keys;
}

Json Json::Without(std::initializer_list<std::string_view> keys) const {
  nlohmann::json rest = *node_->value;
  for (const std::string_view key : keys) rest.erase(std::string(key));
  return Parse(rest.dump());
}

bool Json::contains(std::string_view key) const { return node_ != nullptr && node_->value->contains(std::string(key)); }
std::size_t Json::size() const { return node_ == nullptr ? 0 : node_->value->size(); }
bool Json::is_null() const { return node_ == nullptr || node_->value->is_null(); }
bool Json::is_number() const { return node_ != nullptr && node_->value->is_number(); }
bool Json::is_string() const { return node_ != nullptr && node_->value->is_string(); }
bool Json::is_array() const { return node_ != nullptr && node_->value->is_array(); }
bool Json::is_object() const { return node_ != nullptr && node_->value->is_object(); }

bool Json::boolean() const {
  if (node_ == nullptr || !node_->value->is_boolean()) throw std::runtime_error(dump() + " is neither true nor false");
  return node_->value->get<bool>();
}

double Json::number() const {
  if (!is_number()) throw std::runtime_error(dump() + " is not a number");
  return node_->value->get<double>();
}

long long Json::integer() const {
  const double value = number();
  if (value != std::floor(value)) throw std::runtime_error(dump() + " is not an integer");
  return node_->value->get<long long>();
}

std::string Json::text() const {
  if (!is_string()) throw std::runtime_error(dump() + " is not a string");
  return node_->value->get<std::string>();
}

std::string Json::dump() const { return node_ == nullptr ? kNull.dump() : node_->value->dump(); }

std::ostream& operator<<(std::ostream& out, const Json& json) { return out << json.dump(); }

Json ReadJson(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw std::runtime_error("cannot read " + path.string());
  try {
    return Json::Parse(std::string{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()});
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(path.string() + ": " + error.what());
  }
}

}  // namespace armcmc::test
