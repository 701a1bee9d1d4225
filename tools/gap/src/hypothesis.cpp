#include "armcmc/gap/hypothesis.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>

namespace armcmc::gap {
namespace {

/// A term with its gate and the place of its coordinates.
struct Placed {
  const EffectForm* form;
  Vector gate;  ///< Empty: one everywhere.
  int first;
  const double* theta;
  [[nodiscard]] bool always() const { return gate.size() == 0; }
  [[nodiscard]] const double* shapes() const { return theta + form->num_amplitudes; }
};

// Of a coordinate of order one. Small enough for a frequency, whose phase turns by 2 pi f t times the step.
constexpr double kShapeStep = 1e-7;

std::vector<Placed> Place(const Signals& signals, const Hypothesis& hypothesis, int num_base, const Vector& theta) {
  std::vector<Placed> placed;
  int first = num_base;
  for (const Term& term : hypothesis.terms) {
    placed.push_back({term.form, term.when.kind == When::Kind::kAlways ? Vector() : GateOf(term.when, signals), first,
                      theta.data() + first});
    first += term.form->size();
  }
  return placed;
}

/// Features with the gate included.
Matrix GatedColumns(const Signals& signals, const Placed& term, const double* shapes) {
  Matrix columns = term.form->features(signals, shapes);
  if (!term.always()) columns.array().colwise() *= term.gate.array();
  return columns;
}

/// Features times amplitudes, gate included, with the derivative by every coordinate of the term that is wanted.
struct Sum {
  Vector value;
  Matrix columns;  ///< [row][amplitude]: the derivatives by the amplitudes.
  Matrix shapes;   ///< [row][shape]; no columns where none is wanted.
  /// Column of a coordinate of the term that is wanted.
  [[nodiscard]] auto Slope(Eigen::Index c, int num_amplitudes) const {
    return c < num_amplitudes ? columns.col(c) : shapes.col(c - num_amplitudes);
  }
};

Sum Evaluate(const Signals& signals, const Placed& term, Slopes wanted) {
  const EffectForm& form = *term.form;
  const Vector amplitudes = form.num_amplitudes == 0
                                ? Vector(Vector::Ones(1))
                                : Vector(Eigen::Map<const Vector>(term.theta, form.num_amplitudes));
  Sum sum;
  sum.columns = GatedColumns(signals, term, term.shapes());
  sum.value = sum.columns * amplitudes;
  std::vector<double> shape(term.shapes(), term.theta + form.size());
  for (std::size_t s = 0; s < shape.size(); ++s) {
    if (!wanted.Has(term.first + form.num_amplitudes + static_cast<int>(s))) continue;
    if (sum.shapes.cols() == 0) sum.shapes = Matrix::Zero(signals.rows(), static_cast<Eigen::Index>(shape.size()));
    const double at = shape[s];
    shape[s] = at + kShapeStep;
    const Vector moved = GatedColumns(signals, term, shape.data()) * amplitudes;
    sum.shapes.col(static_cast<Eigen::Index>(s)) = (moved - sum.value) / kShapeStep;
    shape[s] = at;
  }
  return sum;
}

/// The signals with the position as the law is given it.
Signals Moved(const Signals& signals, const Vector& shift) {
  Signals moved = signals;
  moved.at(Role::kPosition) -= shift;
  return moved;
}

void AddFeatures(const Signals& signals, const Placed& term, const LawInput& input, Prediction* out) {
  const bool moves = term.form->from_surface && input.shift.size() > 0;
  const Signals seen = moves ? Moved(signals, input.shift) : Signals();
  const Sum sum = Evaluate(moves ? seen : signals, term, out->wanted);
  out->y += sum.value;
  for (int c = 0; c < term.form->size(); ++c)
    if (out->wanted.Has(term.first + c)) out->jacobian.col(term.first + c) += sum.Slope(c, term.form->num_amplitudes);
  if (!moves || out->jacobian.cols() == 0) return;
  for (const LawInput::Slope& slope : input.shift_slopes) {
    const Signals moved = Moved(seen, kShapeStep * slope.rows);
    out->jacobian.col(slope.coordinate) += (Evaluate(moved, term, Slopes::None()).value - sum.value) / kShapeStep;
  }
}

void AddToInput(const Sum& sum, const Placed& term, Slopes wanted, Vector* value,
                std::vector<LawInput::Slope>* slopes) {
  if (value->size() == 0) *value = Vector::Zero(sum.value.size());
  *value += sum.value;
  for (int c = 0; c < term.form->size(); ++c)
    if (wanted.Has(term.first + c)) slopes->push_back({term.first + c, sum.Slope(c, term.form->num_amplitudes)});
}

void AddMemory(const Signals& signals, const Placed& term, Prediction* out) {
  const EffectForm& form = *term.form;
  std::vector<double> shape(term.shapes(), term.theta + form.size());
  for (int a = 0; a < form.num_amplitudes; ++a) {
    const double amplitude = term.theta[a];
    const auto filtered = [&](const Vector& series) {
      Vector branch = form.filter(signals, series, a, shape.data());
      if (!term.always()) branch = term.gate.cwiseProduct(branch);
      return branch;
    };
    const Vector branch = filtered(out->elastic);
    out->y += amplitude * branch;
    if (out->wanted.Has(term.first + a)) out->jacobian.col(term.first + a) += branch;
    for (Eigen::Index c = 0; c < out->elastic_jacobian.cols(); ++c)
      if (out->wanted.Has(static_cast<int>(c)) && !out->elastic_jacobian.col(c).isZero(0.0))
        out->jacobian.col(c) += amplitude * filtered(out->elastic_jacobian.col(c));
    for (std::size_t s = 0; s < shape.size(); ++s) {
      if (!out->wanted.Has(term.first + form.num_amplitudes + static_cast<int>(s))) continue;
      const double at = shape[s];
      shape[s] = at + kShapeStep;
      out->jacobian.col(term.first + form.num_amplitudes + static_cast<Eigen::Index>(s)) +=
          amplitude / kShapeStep * (filtered(out->elastic) - branch);
      shape[s] = at;
    }
  }
}

void Sense(const Signals& signals, const Placed& term, Prediction* out) {
  if (term.always()) {
    term.form->sense(signals, term.theta, term.first, out);
    return;
  }
  const Prediction before = *out;
  term.form->sense(signals, term.theta, term.first, out);
  const Vector closed = 1.0 - term.gate.array();
  out->y = term.gate.cwiseProduct(out->y) + closed.cwiseProduct(before.y);
  out->jacobian = term.gate.asDiagonal() * out->jacobian;
  out->jacobian += closed.asDiagonal() * before.jacobian;
}

/// The law that no effect reaches into.
/// @param remembers  Whether an effect remembers its elastic part.
void PlainLaw(const Equation& equation, const Signals& signals, const Vector& theta, int num_base, bool remembers,
              LawMemo* memo, Prediction* out) {
  const Slopes wanted = out->wanted;
  const bool all = wanted.first == 0 && wanted.end >= num_base;
  if (memo == nullptr || !(all || wanted.NoneBelow(num_base))) {
    equation.Law(signals, theta.data(), {}, out);
    return;
  }
  Prediction& law = memo->law;
  if (memo->theta.size() != num_base || memo->theta != theta.head(num_base) || memo->with_slopes != all ||
      (remembers && law.elastic_jacobian.cols() == 0)) {
    law.wanted = all ? Slopes{0, num_base} : Slopes::None();
    law.jacobian = Matrix::Zero(signals.rows(), num_base);
    law.elastic_jacobian = Matrix::Zero(signals.rows(), remembers ? num_base : 0);
    equation.Law(signals, theta.data(), {}, &law);
    memo->theta = theta.head(num_base);
    memo->with_slopes = all;
  }
  out->y = law.y;
  if (remembers) out->elastic = law.elastic;
  if (!all) return;
  out->jacobian.leftCols(num_base) = law.jacobian;
  if (remembers) out->elastic_jacobian.leftCols(num_base) = law.elastic_jacobian;
}

bool AnyIn(const std::vector<Placed>& terms, Slot slot) {
  return std::any_of(terms.begin(), terms.end(), [&](const Placed& term) { return term.form->slot == slot; });
}

}  // namespace

Vector GateOf(const When& when, const Signals& signals) {
  switch (when.kind) {
    case When::Kind::kContact: return signals.active;
    case When::Kind::kFree: return 1.0 - signals.active.array();
    case When::Kind::kFrom: return (signals.t.array() >= when.time_s).cast<double>();
    case When::Kind::kUntil: return (signals.t.array() < when.time_s).cast<double>();
    case When::Kind::kAlways: break;
  }
  return Vector::Ones(signals.rows());
}

std::string TermText(const Term& term) {
  char time[32];
  std::snprintf(time, sizeof(time), "%.4g s", term.when.time_s);
  switch (term.when.kind) {
    case When::Kind::kContact: return term.form->effect + " in contact";
    case When::Kind::kFree: return term.form->effect + " in free motion";
    case When::Kind::kFrom: return term.form->effect + " from " + time;
    case When::Kind::kUntil: return term.form->effect + " until " + time;
    case When::Kind::kAlways: break;
  }
  return term.form->effect;
}

std::vector<Coordinate> CoordinatesOf(const Equation& equation, const Signals& signals, const Hypothesis& hypothesis) {
  std::vector<Coordinate> coordinates = equation.base(signals);
  for (const Term& term : hypothesis.terms)
    coordinates.insert(coordinates.end(), term.form->coordinates.begin(), term.form->coordinates.end());
  return coordinates;
}

bool LastOnlyAdds(const Hypothesis& hypothesis) {
  const EffectForm& last = *hypothesis.terms.back().form;
  return last.slot == Slot::kAdditive &&
         std::none_of(hypothesis.terms.begin(), hypothesis.terms.end(), [&](const Term& term) {
           return term.form->slot > Slot::kAdditive || (last.from_surface && term.form->slot == Slot::kInputMap);
         });
}

Matrix Features(const Signals& signals, const Term& term, const double* shapes) {
  Matrix columns = term.form->features(signals, shapes);
  if (term.when.kind != When::Kind::kAlways) columns.array().colwise() *= GateOf(term.when, signals).array();
  return columns;
}

Prediction Evaluate(const Equation& equation, const Signals& signals, const Hypothesis& hypothesis, const Vector& theta,
                    Slopes wanted, LawMemo* memo) {
  int num_base = static_cast<int>(theta.size());
  for (const Term& term : hypothesis.terms) num_base -= term.form->size();
  const std::vector<Placed> terms = Place(signals, hypothesis, num_base, theta);
  LawInput input;
  for (const Placed& term : terms) {
    const auto sum = [&] { return Evaluate(signals, term, wanted); };
    if (term.form->slot == Slot::kInputMap) AddToInput(sum(), term, wanted, &input.shift, &input.shift_slopes);
    if (term.form->slot == Slot::kParameter) AddToInput(sum(), term, wanted, &input.gain, &input.gain_slopes);
    if (term.form->slot == Slot::kDrive) AddToInput(sum(), term, wanted, &input.drive, &input.drive_slopes);
    if (term.form->slot == Slot::kForce)
      input.forces.push_back(
          {term.form, term.theta, term.first, term.always() ? Vector(Vector::Ones(signals.rows())) : term.gate});
  }
  if (input.gain.size() > 0) input.gain.array() += 1.0;
  const bool plain =
      input.shift.size() == 0 && input.gain.size() == 0 && input.drive.size() == 0 && input.forces.empty();
  const bool remembers = AnyIn(terms, Slot::kMemory);
  // Outputs that are not requested are not computed.
  const bool law_alone = plain && memo != nullptr;
  const bool no_slopes = law_alone && wanted.NoneBelow(static_cast<int>(theta.size())) && !AnyIn(terms, Slot::kStatics);
  const bool no_elastic_slopes = !remembers || (law_alone && wanted.NoneBelow(num_base));
  Prediction out;
  out.wanted = wanted;
  out.jacobian = Matrix::Zero(signals.rows(), no_slopes ? 0 : theta.size());
  out.elastic_jacobian = Matrix::Zero(signals.rows(), no_elastic_slopes ? 0 : theta.size());
  if (plain)
    PlainLaw(equation, signals, theta, num_base, remembers, memo, &out);
  else
    equation.Law(signals, theta.data(), input, &out);
  for (const Placed& term : terms) {
    if (term.form->slot == Slot::kMemory) AddMemory(signals, term, &out);
    if (term.form->slot == Slot::kAdditive) AddFeatures(signals, term, input, &out);
  }
  for (const Slot slot : {Slot::kDelay, Slot::kLag, Slot::kStatics})
    for (const Placed& term : terms)
      if (term.form->slot == slot) Sense(signals, term, &out);
  return out;
}

}  // namespace armcmc::gap
