#include "armcmc/plant_sim/input_program.hpp"

#include <cmath>
#include <numbers>

#include "armcmc/plant_sim/rng.hpp"

namespace armcmc::plant_sim {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr int kMultisineLines = 12;

/// A sin(phase(t)) with the derivatives of the phase.
expression::Jet SineOf(double amplitude, const expression::Jet& phase) {
  const double s = amplitude * std::sin(phase[0]), c = amplitude * std::cos(phase[0]);
  return expression::Compose({s, c, -s, -c}, phase);
}

}  // namespace

InputSignal::InputSignal(const InputProgram& program, const DescribedPlant& plant, const std::string& key,
                         double duration_s, std::uint64_t seed, std::uint64_t stream)
    : program_(program), seed_(seed), stream_(stream) {
  using Kind = InputProgram::Kind;
  if (program.kind == Kind::kMultisine) {
    // One line in each twelfth of the band, so that no period is common to all.
    Rng rng(seed, stream);
    const double line = program.amplitude / 2.0 * std::sqrt(2.0 / kMultisineLines);
    for (int k = 0; k < kMultisineLines; ++k) {
      const double place = (k + 1 - 0.5 * rng.Uniform()) / kMultisineLines;
      lines_.push_back({line, kTurn * program.bandwidth_hz * place, kTurn * rng.Uniform()});
    }
  } else if (program.kind == Kind::kSine || program.kind == Kind::kChirp) {
    lines_.push_back({program.amplitude, kTurn * program.frequency_hz, 0.0});
  }
  if (program.kind == Kind::kChirp) sweep_ = kTurn * (program.bandwidth_hz - program.frequency_hz) / duration_s;
  if (program.kind != Kind::kExpression) return;
  expression::Names names;
  for (const DescribedPlant::Constant& constant : plant.constants) {
    names.push_back(constant.name);
    values_.push_back(constant.value);
  }
  names.emplace_back("t");
  values_.push_back(0.0);
  try {
    expression_ = expression::Expression(program.text, names);
    static_cast<void>(At(0.0));
  } catch (const expression::Error& error) {
    throw DescribedError(key, error.column(), error.what());
  }
}

double InputSignal::Level(double t) const {
  // The level of a step follows from its number alone, so that samples may be asked for in any order.
  const auto step = static_cast<std::uint64_t>(std::floor(t * program_.frequency_hz + 1e-9));
  Rng rng(seed_, stream_ * 1'000'003 + step);
  return program_.amplitude * (2.0 * rng.Uniform() - 1.0);
}

expression::Jet InputSignal::At(double t) {
  using Kind = InputProgram::Kind;
  if (program_.kind == Kind::kExpression) {
    values_.back() = t;
    return expression::Differentiate(expression_.tree(), values_, static_cast<int>(values_.size()) - 1);
  }
  expression::Jet sum{program_.offset, 0.0, 0.0, 0.0};
  if (program_.kind == Kind::kSteps) sum[0] += Level(t);
  for (const Line& line : lines_) {
    const expression::Jet sine = SineOf(
        line.amplitude, {line.phase + line.omega * t + 0.5 * sweep_ * t * t, line.omega + sweep_ * t, sweep_, 0.0});
    for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += sine[k];
  }
  return sum;
}

}  // namespace armcmc::plant_sim
