#include "armcmc/gap_bench/case.hpp"

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <filesystem>

namespace armcmc::gap_bench {

std::string Case::Name() const {
  char strength_text[32];
  std::snprintf(strength_text, sizeof(strength_text), "%g", strength);
  std::string name = stratum + "_" + std::filesystem::path(scenario).stem().string() + "_" +
                     (effect.empty() ? "own" : effect) + "_" + strength_text + "_" + gate + "_" + std::to_string(seed);
  if (part != Part::kWhole) name += std::string("_") + PartName(part);
  std::replace_if(
      name.begin(), name.end(),
      [](unsigned char c) { return std::isalnum(c) == 0 && c != '_' && c != '.' && c != '-'; }, '-');
  return name;
}

const char* PartName(Part part) {
  switch (part) {
    case Part::kWhole: return "whole";
    case Part::kFirstHalf: return "first half";
    case Part::kSecondHalf: return "second half";
  }
  return "";
}

const char* GradeName(Grade grade) {
  switch (grade) {
    case Grade::kRight: return "right";
    case Grade::kTie: return "tie";
    case Grade::kFamily: return "family";
    case Grade::kPartial: return "partial";
    case Grade::kUnnamed: return "unnamed";
    case Grade::kNone: return "none";
    case Grade::kWrong: return "wrong";
    case Grade::kNotShown: return "not shown";
    case Grade::kNotMade: return "not made";
    case Grade::kFailed: return "failed";
  }
  return "";
}

}  // namespace armcmc::gap_bench
