#include "armcmc/rtcheck/system_root.hpp"

#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <fstream>
#include <iterator>
#include <sstream>

namespace armcmc::rtcheck {

std::optional<std::string> SystemRoot::Text(const std::string& path) const {
  std::ifstream file(root_ / path, std::ios::binary);
  if (!file) return std::nullopt;
  std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  if (file.bad()) return std::nullopt;
  text.erase(text.find_last_not_of(" \n") + 1);
  return text;
}

std::optional<long> SystemRoot::Number(const std::string& path) const {
  const auto text = Text(path);
  if (!text) return std::nullopt;
  long value = 0;
  if (std::from_chars(text->data(), text->data() + text->size(), value).ec != std::errc()) return std::nullopt;
  return value;
}

std::optional<std::string> SystemRoot::Line(const std::string& path, std::string_view begin) const {
  std::istringstream lines(Text(path).value_or(""));
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with(begin)) continue;
    const std::size_t from = line.find_first_not_of(" \t", begin.size());
    return from == std::string::npos ? "" : line.substr(from);
  }
  return std::nullopt;
}

bool SystemRoot::MayWrite(const std::string& path) const { return access((root_ / path).c_str(), W_OK) == 0; }

std::set<int> ParseCpuList(std::string_view text) {
  std::set<int> cpus;
  std::istringstream items{std::string(text)};
  for (std::string item; std::getline(items, item, ',');) {
    int first = 0;
    const char* end = item.data() + item.size();
    const auto [rest, error] = std::from_chars(item.data(), end, first);
    if (error != std::errc()) continue;
    int last = first;
    if (rest != end && (*rest != '-' || std::from_chars(rest + 1, end, last).ec != std::errc())) continue;
    for (int cpu = first; cpu <= std::min(last, first + 4095); ++cpu) cpus.insert(cpu);
  }
  return cpus;
}

}  // namespace armcmc::rtcheck
