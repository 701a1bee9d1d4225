#include "package/include_rules.hpp"

#include <algorithm>
#include <regex>
#include <set>
#include <sstream>

namespace armcmc::test {
namespace {

using Names = std::set<std::string, std::less<>>;

/// Parts of ours that a part may include, and kinds of foreign headers.
struct Rule {
  Names parts;
  Names foreign;
};

const Names kProgramLibraries = {"CLI", "nlohmann", "fmt", "spdlog", "toml++"};

// What core must not have: a clock, a thread, I/O.
const Names kNotInCore = {"chrono",  "ctime",  "thread",     "mutex",      "shared_mutex", "condition_variable",
                          "future",  "latch",  "barrier",    "semaphore",  "stop_token",   "iostream",
                          "fstream", "cstdio", "filesystem", "syncstream", "random"};

// Headers of support that know the estimator.
const Names kCoreInSupport = {"armcmc/support/effect_file.hpp",      "armcmc/support/effect_library.hpp",
                              "armcmc/support/effect_request.hpp",   "armcmc/support/model_file.hpp",
                              "armcmc/support/estimator_config.hpp", "armcmc/support/plant_effects.hpp",
                              "armcmc/support/plant_file.hpp",       "armcmc/support/plant_writer.hpp"};

std::string PartOf(const std::filesystem::path& file) {
  auto it = file.begin();
  if (it == file.end()) return "";
  const std::string top = it->string();
  const std::string second = ++it == file.end() ? "" : it->string();
  if (top == "tools") return second == "support" || second == "python" ? "tools/" + second : "tools";
  if (second == "app") return top + "/app";
  return top;
}

Rule RuleOf(const std::string& part) {
  const Names foreign_of_programs = [] {
    Names names = kProgramLibraries;
    names.insert({"std", "posix", "lcm"});
    return names;
  }();
  if (part == "core") return {{"core"}, {"std", "Eigen", "simd"}};
  if (part == "rt") return {{"core", "rt", "lcm_types"}, {"std", "posix", "lcm"}};
  if (part == "rt/app") return {{"core", "rt", "lcm_types", "support"}, foreign_of_programs};
  if (part == "plant_sim") return {{"plant_sim", "lcm_types"}, {"std", "posix", "lcm", "Eigen"}};
  if (part == "plant_sim/app") return {{"plant_sim", "lcm_types", "support"}, foreign_of_programs};
  if (part == "tools/support") {
    Names foreign = foreign_of_programs;
    foreign.insert("Eigen");
    return {{"core", "lcm_types", "support"}, foreign};
  }
  Names all = foreign_of_programs;
  // The module stands on what is no program: core, and what reads files.
  if (part == "tools/python") return {{"core", "support"}, {"std", "pybind11"}};
  all.insert({"Eigen", "benchmark"});
  return {{"core", "rt", "lcm_types", "support", "tools"}, all};
}

/// The part that a header <armcmc/...> belongs to.
std::string OwnerOf(const std::string& header) {
  std::smatch match;
  if (std::regex_match(header, std::regex("armcmc/[a-z0-9_]+_t\\.hpp"))) return "lcm_types";
  if (!std::regex_match(header, match, std::regex("armcmc/([a-z_]+)/.*"))) return "core";
  const std::string folder = match[1];
  for (const std::string_view own : {"models", "effects", "expression", "gap_watch", "baselines", "plant"})
    if (folder == own) return "core";
  if (folder == "rt" || folder == "plant_sim" || folder == "support") return folder;
  return "tools";
}

std::string KindOfForeign(const std::string& header) {
  if (header == "arm_neon.h" || header == "immintrin.h") return "simd";
  const std::size_t slash = header.find('/');
  const std::string top = slash == std::string::npos ? header : header.substr(0, slash);
  if (top == "Eigen" || top == "lcm" || top == "benchmark" || top == "pybind11" || kProgramLibraries.contains(top))
    return top;
  // The standard library has no ".h" and no folder; what is left is the C library and the operating system.
  return slash == std::string::npos && header.find('.') == std::string::npos ? "std" : "posix";
}

std::string Complaint(const std::string& part, const Rule& rule, const std::string& header, bool quoted) {
  if (header.find("..") != std::string::npos) return "includes through a parent folder";
  if (header.starts_with("support/") || header.starts_with("tests/") || header.starts_with("gtest/") ||
      header.starts_with("gmock/") || header.starts_with("rapidcheck"))
    return "belongs to the tests";
  if (header.starts_with("armcmc/")) {
    const std::string owner = OwnerOf(header);
    if (!rule.parts.contains(owner)) return "belongs to " + owner + ", which " + part + " may not use";
    if (part == "plant_sim/app" && kCoreInSupport.contains(header)) return "brings core to the plant";
    return "";
  }
  if (quoted) return "";  // private to its folder
  const std::string kind = KindOfForeign(header);
  if (!rule.foreign.contains(kind)) return "is of kind " + kind + ", which " + part + " may not use";
  if (part == "core" && kNotInCore.contains(header)) return "gives core a clock, a thread or I/O";
  return "";
}

}  // namespace

std::vector<std::string> ForbiddenIncludes(const std::filesystem::path& file, std::string_view text) {
  std::vector<std::string> found;
  const std::string part = PartOf(file);
  if (part.empty() || part == "tests") return found;
  const Rule rule = RuleOf(part);
  const std::regex include(R"(^\s*#\s*include\s*([<"])([^>"]+)[>"].*)");
  std::istringstream lines{std::string(text)};
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) {
    std::smatch match;
    if (!std::regex_match(line, match, include)) continue;
    const std::string complaint = Complaint(part, rule, match[2], match[1] == "\"");
    if (!complaint.empty())
      found.push_back(file.string() + ":" + std::to_string(number) + ": " + match[2].str() + " " + complaint);
  }
  return found;
}

}  // namespace armcmc::test
