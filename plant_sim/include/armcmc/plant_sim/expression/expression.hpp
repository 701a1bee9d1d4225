#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "armcmc/plant_sim/expression/tree.hpp"

namespace armcmc::plant_sim::expression {

/// What names mean: each is the place of a value in a list.
using Names = std::vector<std::string>;

/// An expression over a list of values, evaluated by walking its tree.
///
/// Every part is computed at every sample, also that of an `if` which is not taken, so that functions with memory
/// follow the time. They are exact for arguments that are linear between samples, from a to b in dt:
///
///   lowpass   y <- y E + a (G - E) + b (1 - G),  E = exp(-dt/tau),  G = (1 - E) tau / dt;  y = e at the first sample
///   integral  y <- y + dt (a + b) / 2,  0 at the first sample
///   delay     linear between the samples at t - tau; e of the first sample before it; tau < 0 counts as 0
///   previous  a, at the first sample e;  elapsed  s since the first sample
///
/// and for arguments that are held between samples:
///
///   lowpass   y <- y E + a (1 - E);  integral  y <- y + dt a
///   delay     what was held at t - tau; for a low pass, an integral or a rate its mean until the next sample
class Expression {
 public:
  Expression() = default;
  /// @param held     By place: what is, between samples; may be shorter. @param is_rate  It is integrated.
  /// @throws Error naming a column.
  Expression(std::string_view text, const Names& names, const std::vector<bool>& held = {}, bool is_rate = false);

  /// @param values  By place. @param dt  s, since the sample before; 0 at the first one.
  [[nodiscard]] double Evaluate(const std::vector<double>& values, double dt);
  /// The same without a step of time. @pre !has_memory().
  [[nodiscard]] double EvaluateNow(const std::vector<double>& values) { return Evaluate(values, 0.0); }

  /// Between the last two samples that Evaluate() went to, `part` of the way: functions with memory have values on the
  /// line between theirs.
  [[nodiscard]] double EvaluateBetween(const std::vector<double>& values, double part);

  [[nodiscard]] bool has_memory() const { return !memories_.empty(); }
  [[nodiscard]] bool Reads(int place) const;
  [[nodiscard]] bool is_held() const { return tree_.held; }
  /// Whether something that is remembered does.
  [[nodiscard]] bool RemembersPlace(int place) const;
  [[nodiscard]] const Tree& tree() const { return tree_; }

 private:
  struct Memory {
    double y = 0.0, before = 0.0, elapsed = 0.0;
    std::vector<double> t, e;  ///< Of a delay.
    bool started = false;
    double result = 0.0, last_result = 0.0;  ///< At the last two samples.
  };

  void Bind(Tree* node, const Names& names, const std::vector<bool>& held, bool integrated);
  [[nodiscard]] double Walk(const Tree& node, const std::vector<double>& values, double dt);
  [[nodiscard]] double WalkBetween(const Tree& node, const std::vector<double>& values, double part) const;
  [[nodiscard]] double Remember(const Tree& node, double e, double tau, double dt);

  Tree tree_;
  std::vector<Memory> memories_;
};

/// Value of an operator or a function without memory. Conditions are 1 or 0, and hold where they are not 0.
/// A negative base with a power that is not an integer, a root or a logarithm of what has none: NaN.
[[nodiscard]] double Apply(const std::string& what, double a, double b, double c);

}  // namespace armcmc::plant_sim::expression
