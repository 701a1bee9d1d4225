#include "armcmc/gap_bench/strata.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>

#include "armcmc/gap_bench/scenario_text.hpp"
#include "case_builder.hpp"
#include "hidden.hpp"
#include "imperfect_strata.hpp"
#include "recorded.hpp"

namespace armcmc::gap_bench {
namespace {

const std::vector<std::string> kActingInOneMode = {"coulomb_friction:tanh", "presliding_friction:dahl",
                                                   "viscous_friction:linear", "inertia:rigid",
                                                   "periodic_disturbance:sine"};
constexpr int kPairCells = 10, kUnequalPairCells = 3, kActuatorNullCells = 5;

struct NoiseVariant {
  const char* name;
  const char* table;
};
const std::vector<NoiseVariant> kNoises = {
    {"white", "kind = \"gaussian\"\nstd_share = 0.01\n"},
    {"coloured", "kind = \"gaussian\"\nstd_share = 0.01\ncorrelation = 0.0\ncorrelation_to = 0.8\n"},
    {"red", "kind = \"gaussian\"\nstd_share = 0.01\ncorrelation = 0.95\n"},
    {"student", "kind = \"student_t\"\nstd_share = 0.01\ndof = 4.0\n"},
    {"growing", "kind = \"gaussian\"\nstd_share = 0.01\ngrowth = 1.0\n"}};

void Null(CaseBuilder* b) {
  for (const char* scenario : {"contact_rich", "contact_rich_mm", "contact_sine", "contact_slow_triangle"})
    for (const NoiseVariant& noise : kNoises) {
      const std::string file = b->Write(std::string(scenario) + "_" + noise.name,
                                        WithTable(ScenarioOfPlant(scenario), "noise.f", noise.table));
      b->Cell(Like(scenario, file, "none", 1.0), noise.name);
    }
}

void Each(CaseBuilder* b, const std::vector<std::string>& effects, const std::vector<double>& strengths) {
  for (const double strength : strengths)
    for (const std::string& effect : effects)
      b->Cell(Like(GroupOf(strength), HiddenInContact().rich, effect, strength), effect);
}

void Pairs(CaseBuilder* b) {
  for (int cell = 0; cell < kPairCells; ++cell)
    b->Cell(Like("R 1 + 1", HiddenInContact().rich, "", 1.0), std::to_string(cell),
            [](Case* one, std::mt19937_64* random) {
              const auto pair = DrawPair(random);
              one->effect = pair.first + "," + pair.second;
            });
  for (int cell = 0; cell < kUnequalPairCells; ++cell)
    b->Cell(Like("R 0.3 + 3", HiddenInContact().rich, "", 1.0), std::to_string(cell),
            [b](Case* one, std::mt19937_64* random) {
              const auto [weak, strong] = DrawPair(random);
              // The first table seeds the draws of both.
              const std::string first = HiddenTable(weak, 0.3) + "seed = " + std::to_string(one->seed) + "\n";
              one->scenario = b->Write("pair_" + std::to_string(one->seed),
                                       ScenarioOfPlant(HiddenInContact().rich) + first + HiddenTable(strong, 3.0));
            });
}

void Onset(CaseBuilder* b) {
  for (const std::string& effect : HiddenInContact().catalogue)
    b->Cell(Like("R 1", HiddenInContact().rich, effect, 1.0), effect, [](Case* one, std::mt19937_64* random) {
      // Inside the part of the recording that is diagnosed, with two seconds before and 1.5 s after it.
      one->gate = "from:" + Short(2.0 + 0.01 * static_cast<double>((*random)() % 350));
    });
}

void Modes(CaseBuilder* b) {
  for (const char* gate : {"contact", "free"})
    for (const std::string& effect : kActingInOneMode)
      b->Cell(Like(gate, HiddenInContact().rich, effect, 1.0), effect,
              [gate](Case* one, std::mt19937_64*) { one->gate = gate; });
}

void Ablation(CaseBuilder* b) {
  for (const double strength : {0.3, 1.0, 3.0})
    for (const std::string& effect : HiddenInContact().catalogue) {
      Case like = Like(GroupOf(strength), HiddenInContact().rich, effect, strength);
      like.without = {effect.substr(0, effect.find(':'))};
      b->Cell(like, effect);
    }
}

void Poor(CaseBuilder* b) {
  for (const char* scenario : {"contact_sine", "contact_slow_triangle"})
    for (const std::string& effect : HiddenInContact().catalogue)
      b->Cell(Like(scenario, scenario, effect, 1.0), effect);
}

/// The actuator, excited: nothing hidden, one effect of either equation, and what its catalogue lacks.
void Actuator(CaseBuilder* b) {
  const auto like = [](const std::string& group, const std::string& effect, double strength) {
    Case one = Like(group, HiddenInActuator().rich, effect, strength);
    one.model = HiddenInActuator().rich;
    return one;
  };
  for (int cell = 0; cell < kActuatorNullCells; ++cell) b->Cell(like("nothing", "none", 1.0), std::to_string(cell));
  for (const double strength : {0.3, 1.0, 3.0})
    for (const std::string& effect : HiddenInActuator().catalogue)
      b->Cell(like(GroupOf(strength), effect, strength), effect);
  for (const double strength : {1.0, 3.0})
    for (const std::string& effect : HiddenInActuator().outside)
      b->Cell(like("outside, " + GroupOf(strength), effect, strength), effect);
}

void OneScenario(CaseBuilder* b, const std::string& scenario) {
  for (const std::string& effect : HiddenInContact().catalogue) b->Cell(Like("R 1", scenario, effect, 1.0), effect);
}

const std::vector<std::pair<std::string, Fill>>& Strata() {
  static const std::vector<std::pair<std::string, Fill>> strata = {
      {"null", Null},
      {"singles",
       [](CaseBuilder* b) {
         Each(b, HiddenInContact().catalogue, {0.1, 0.3, 1.0, 3.0});
       }},
      {"scale", [](CaseBuilder* b) { OneScenario(b, "contact_rich_mm"); }},
      {"pairs", Pairs},
      {"onset", Onset},
      {"modes", Modes},
      {"outside",
       [](CaseBuilder* b) {
         Each(b, HiddenInContact().outside, {0.3, 1.0, 3.0});
       }},
      {"ablation", Ablation},
      {"variants",
       [](CaseBuilder* b) {
         Each(b, HiddenInContact().variants, {0.3, 1.0, 3.0});
       }},
      {"poor", Poor},
      {"actuator", Actuator},
      {"paper", [](CaseBuilder* b) { OneScenario(b, HiddenInContact().paper); }}};
  return strata;
}

}  // namespace

const std::vector<std::string>& StratumNames() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const auto& strata : {Strata(), ImperfectStrata()})
      for (const auto& stratum : strata) all.push_back(stratum.first);
    all.emplace_back(kRecorded);
    return all;
  }();
  return names;
}

bool Imperfect(const std::string& stratum) {
  const auto& strata = ImperfectStrata();
  return std::any_of(strata.begin(), strata.end(), [&](const auto& one) { return one.first == stratum; });
}

std::vector<Case> CasesOf(const std::string& stratum, int logs_per_cell, std::uint64_t seed,
                          const std::filesystem::path& folder, const std::filesystem::path& recordings) {
  if (stratum == kRecorded) {
    CaseBuilder builder(stratum, logs_per_cell, seed, folder);
    AddRecorded(recordings, HiddenInContact().catalogue, &builder);
    return builder.Take();
  }
  for (const auto& strata : {Strata(), ImperfectStrata()})
    for (const auto& [name, fill] : strata)
      if (name == stratum) {
        CaseBuilder builder(stratum, logs_per_cell, seed, folder);
        fill(&builder);
        return builder.Take();
      }
  throw std::invalid_argument("there is no stratum \"" + stratum + "\"");
}

}  // namespace armcmc::gap_bench
