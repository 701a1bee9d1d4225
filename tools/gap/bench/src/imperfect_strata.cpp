#include "imperfect_strata.hpp"

#include <armcmc/support/csv.hpp>
#include <cstddef>
#include <random>

#include "armcmc/gap_bench/scenario_text.hpp"
#include "hidden.hpp"

namespace armcmc::gap_bench {
namespace {

constexpr int kStrongPairCells = 10;
const std::vector<double> kErrors = {0.01, 0.03, 0.1};  // of a law, rms

std::string Percent(double share) { return Short(100.0 * share) + " %"; }

/// A scenario of the plant whose law differs from its formula. @return its path.
std::string WithLawError(CaseBuilder* b, const std::string& scenario, double share) {
  return b->Write(scenario + "_law_" + Short(share),
                  WithTable(ScenarioOfPlant(scenario), "law", "error = " + Short(share) + "\n"));
}

void LawErrors(CaseBuilder* b) {
  for (const double error : kErrors) {
    const std::string scenario = WithLawError(b, HiddenInContact().rich, error);
    for (const double strength : {3.0, 10.0})
      for (const std::string& effect : HiddenInContact().catalogue)
        b->Cell(Like(Percent(error) + ", " + GroupOf(strength), scenario, effect, strength), effect);
  }
}

/// The flow is what errs: its gains are estimated, so that it can be fitted as well as any law of nature.
void ActuatorLawErrors(CaseBuilder* b) {
  for (const double error : kErrors) {
    const std::string scenario = WithLawError(b, HiddenInActuator().rich, error);
    for (const std::string& effect : HiddenInActuator().catalogue) {
      Case like = Like(Percent(error) + ", " + GroupOf(3.0), scenario, effect, 3.0);
      like.model = HiddenInActuator().rich;
      b->Cell(like, effect);
    }
  }
}

void Unlisted(CaseBuilder* b) {
  for (const double strength : {3.0, 10.0})
    for (const std::string& effect : HiddenInContact().catalogue)
      b->Cell(Like(GroupOf(strength), HiddenInContact().rich, "", strength), effect,
              [b, strength, &effect](Case* one, std::mt19937_64* random) {
                const std::string& other = HiddenInContact().outside[(*random)() % HiddenInContact().outside.size()];
                one->scenario =
                    b->Write("unlisted_" + std::to_string(one->seed),
                             ScenarioOfPlant(HiddenInContact().rich) + HiddenTable(effect, strength) +
                                 "seed = " + std::to_string(one->seed) + "\n" + HiddenTable(other, strength / 3.0));
              });
}

void Formulas(CaseBuilder* b) {
  for (const double strength : {3.0, 10.0, 30.0})
    for (const std::string& effect : HiddenInContact().variants)
      b->Cell(Like(GroupOf(strength), HiddenInContact().rich, effect, strength), effect);
}

void Strokes(CaseBuilder* b) {
  for (const double strength : {3.0, 10.0})
    for (const std::string& effect : HiddenInContact().catalogue)
      b->Cell(Like(GroupOf(strength), "contact_strokes", effect, strength), effect);
}

void StrongPairs(CaseBuilder* b) {
  for (int cell = 0; cell < kStrongPairCells; ++cell)
    b->Cell(Like("R 10 + 10", HiddenInContact().rich, "", 10.0), std::to_string(cell),
            [](Case* one, std::mt19937_64* random) {
              const auto pair = DrawPair(random);
              one->effect = pair.first + "," + pair.second;
            });
}

/// Nothing is hidden, and yet the formula is not the plant: it differs by less than a percent, or a constant that the
/// tool takes for granted is another one.
void NearNull(CaseBuilder* b) {
  for (const double error : {0.001, 0.003, 0.01})
    for (const std::string& scenario :
         {HiddenInContact().rich, std::string("contact_sine"), std::string("contact_strokes")})
      b->Cell(Like("law, " + Percent(error), WithLawError(b, scenario, error), "none", 1.0), scenario);
  for (const std::string& line : HiddenInActuator().taken_for_granted)
    for (const double off : {0.001, 0.01}) {
      const std::size_t value = line.rfind(' ') + 1;
      std::string text = ScenarioOfPlant(HiddenInActuator().rich);
      text.replace(text.find(line), line.size(),
                   line.substr(0, value) + support::ExactNumber(std::stod(line.substr(value)) * (1.0 + off)));
      const std::string key = line.substr(0, line.find(' '));
      Case like = Like("constants, " + Percent(off),
                       b->Write(HiddenInActuator().rich + "_" + key + "_" + Short(off), text), "none", 1.0);
      like.model = HiddenInActuator().rich;
      b->Cell(like, key);
    }
}

}  // namespace

const std::vector<std::pair<std::string, Fill>>& ImperfectStrata() {
  static const std::vector<std::pair<std::string, Fill>> strata = {
      {"law_error", LawErrors}, {"actuator_law_error", ActuatorLawErrors},
      {"unlisted", Unlisted},   {"formulas", Formulas},
      {"strokes", Strokes},     {"strong_pairs", StrongPairs},
      {"near_null", NearNull}};
  return strata;
}

}  // namespace armcmc::gap_bench
