#include "case_builder.hpp"

#include <armcmc/support/shared_files.hpp>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <stdexcept>

#include "hidden.hpp"

namespace armcmc::gap_bench {
namespace {

/// FNV-1a: the same on every machine.
std::uint64_t Hash(const std::string& text) {
  std::uint64_t hash = 14695981039346656037ULL;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211ULL;
  return hash;
}

}  // namespace

std::uint64_t CaseBuilder::SeedOf(const Case& like, const std::string& cell, int k) const {
  return Hash(std::to_string(seed_) + "/" + stratum_ + "/" + like.group + "/" + cell + "/" + std::to_string(k));
}

std::string CaseBuilder::Write(const std::string& name, const std::string& text) const {
  std::filesystem::create_directories(folder_ / "scenarios");
  const std::filesystem::path file = std::filesystem::path("scenarios") / (name + ".toml");
  std::ofstream out(folder_ / file, std::ios::binary);
  out << text;
  if (!out.flush()) throw std::runtime_error((folder_ / file).string() + ": cannot be written");
  return file.string();
}

std::string ScenarioOfPlant(const std::string& name) {
  std::ifstream file(support::FindSharedFile("scenarios", name), std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

std::string GroupOf(double strength) { return "R " + Short(strength); }

std::pair<std::string, std::string> DrawPair(std::mt19937_64* random) {
  const std::size_t count = HiddenInContact().catalogue.size();
  const std::size_t first = (*random)() % count, second = (first + 1 + (*random)() % (count - 1)) % count;
  return {HiddenInContact().catalogue[first], HiddenInContact().catalogue[second]};
}

std::string HiddenTable(const std::string& effect, double strength) {
  const std::size_t colon = effect.find(':');
  std::string table = "\n[[hidden_effect]]\nname = \"" + effect.substr(0, colon) + "\"\n";
  if (colon != std::string::npos) table += "variant = \"" + effect.substr(colon + 1) + "\"\n";
  return table + "strength = " + Short(strength) + "\n";
}

std::string Short(double value) {
  char text[32];
  std::snprintf(text, sizeof(text), "%g", value);
  return text;
}

Case Like(const std::string& group, const std::string& scenario, const std::string& effect, double strength) {
  Case like;
  like.group = group;
  like.scenario = scenario;
  like.effect = effect;
  like.strength = strength;
  return like;
}

}  // namespace armcmc::gap_bench
