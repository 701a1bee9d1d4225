#pragma once

#include <compare>
#include <concepts>
#include <cstddef>
#include <filesystem>
#include <initializer_list>
#include <iosfwd>
#include <memory>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace armcmc::test {

/// A JSON value that a test looks at. The library that parses it is compiled once, in json.cpp, and not in every test.
///
///     const Json report = ReadJson(dir / "report.json");
///     EXPECT_EQ(report["misses"]["own"], 0);
///     const double rate = report["rate_hz"];
///
/// What is not there, or of another type, throws std::out_of_range or std::runtime_error, whose text GoogleTest prints.
/// Copies share one document, which is never changed.
class Json {
 public:
  Json() = default;  ///< null

  /// @throws std::runtime_error with the place of the first error.
  [[nodiscard]] static Json Parse(std::string_view text);

  /// A member of an object; throws std::out_of_range naming a key that is not there.
  template <std::convertible_to<std::string_view> Key>
  [[nodiscard]] Json operator[](const Key& key) const {
    return Member(key);
  }
  /// An element of an array; throws std::out_of_range past its end.
  template <std::integral Index>
  [[nodiscard]] Json operator[](Index index) const {
    return Element(static_cast<std::size_t>(index));
  }
  template <class Place>
  [[nodiscard]] Json at(const Place& place) const {
    return (*this)[place];
  }
  [[nodiscard]] bool contains(std::string_view key) const;
  /// Elements of an array or members of an object.
  [[nodiscard]] std::size_t size() const;
  [[nodiscard]] std::vector<std::string> keys() const;
  /// The object without some of its members.
  [[nodiscard]] Json Without(std::initializer_list<std::string_view> keys) const;
  [[nodiscard]] bool empty() const { return size() == 0; }
  [[nodiscard]] bool is_null() const;
  [[nodiscard]] bool is_number() const;
  [[nodiscard]] bool is_string() const;
  [[nodiscard]] bool is_array() const;
  [[nodiscard]] bool is_object() const;

  [[nodiscard]] bool boolean() const;
  [[nodiscard]] double number() const;
  [[nodiscard]] long long integer() const;  ///< Throws where the number has a fraction.
  [[nodiscard]] std::string text() const;
  /// The value as JSON on one line.
  [[nodiscard]] std::string dump() const;

  template <class T>
  [[nodiscard]] T get() const {
    if constexpr (std::same_as<T, bool>) {
      return boolean();
    } else if constexpr (std::integral<T>) {
      return static_cast<T>(integer());
    } else if constexpr (std::floating_point<T>) {
      return static_cast<T>(number());
    } else {
      return text();
    }
  }
  template <class T>
  requires std::is_arithmetic_v<T> || std::same_as<T, std::string>
  operator T() const {  // NOLINT(google-explicit-constructor): reads like the value that it is
    return get<T>();
  }

  /// Goes over the elements of an array or the values of an object.
  class Iterator {
   public:
    Iterator(const Json* whole, std::size_t index) : whole_(whole), index_(index) {}
    [[nodiscard]] Json operator*() const { return whole_->Value(index_); }
    Iterator& operator++() {
      ++index_;
      return *this;
    }
    [[nodiscard]] bool operator==(const Iterator& other) const { return index_ == other.index_; }

   private:
    const Json* whole_;
    std::size_t index_;
  };
  [[nodiscard]] Iterator begin() const { return {this, 0}; }
  [[nodiscard]] Iterator end() const { return {this, size()}; }
  [[nodiscard]] Json back() const { return Element(size() - 1); }

  friend bool operator==(const Json& a, const Json& b) { return a.dump() == b.dump(); }
  template <class T>
  requires std::is_arithmetic_v<T>
  friend bool operator==(const Json& a, T b) {
    if constexpr (std::same_as<T, bool>) {
      return a.boolean() == b;
    } else {
      return a.number() == static_cast<double>(b);
    }
  }
  friend bool operator==(const Json& a, std::string_view b) { return a.is_string() && a.text() == b; }
  template <class T>
  requires std::is_arithmetic_v<T>
  friend std::partial_ordering operator<=>(const Json& a, T b) { return a.number() <=> static_cast<double>(b); }
  friend std::partial_ordering operator<=>(const Json& a, const Json& b) { return a.number() <=> b.number(); }
  friend std::ostream& operator<<(std::ostream& out, const Json& json);

 private:
  struct Node;
  explicit Json(std::shared_ptr<const Node> node) : node_(std::move(node)) {}
  [[nodiscard]] Json Member(std::string_view key) const;
  [[nodiscard]] Json Element(std::size_t index) const;
  [[nodiscard]] Json Value(std::size_t index) const;

  std::shared_ptr<const Node> node_;
};

/// @throws std::runtime_error naming a file that is not there or is no JSON.
[[nodiscard]] Json ReadJson(const std::filesystem::path& path);

}  // namespace armcmc::test
