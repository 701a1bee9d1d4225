#include "armcmc/gap/aliases.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "armcmc/gap/gate_scan.hpp"
#include "armcmc/support/parallel.hpp"

namespace armcmc::gap {
namespace {

constexpr double kAbsorbed = 0.999;
constexpr double kAlike = 0.98;
constexpr double kNothing = 1e-12;  // of the prediction's square

/// Signatures of one effect, one for each shape that fits start from; whitened.
struct Signatures {
  std::string effect;
  std::vector<Vector> of;
};

/// What of a signature no parameter absorbs.
struct Outside {
  explicit Outside(Vector part) : g(std::move(part)), norm(g.norm()) {}
  Vector g;
  double norm;
};

class Tangent {
 public:
  explicit Tangent(const Fitted& base)
      : basis_(OrthonormalBasis(base.whitened_jacobian)), jacobian_(&base.whitened_jacobian) {}

  [[nodiscard]] Vector Outside(const Vector& g) const { return g - basis_ * (basis_.transpose() * g); }
  [[nodiscard]] double ShareInTangent(const Vector& g) const {
    return (basis_.transpose() * g).squaredNorm() / g.squaredNorm();
  }
  /// The change of the coordinates that looks like an effect.
  [[nodiscard]] Vector Bias(const Vector& g) const { return jacobian_->colPivHouseholderQr().solve(g); }

 private:
  Matrix basis_;
  const Matrix* jacobian_;
};

/// "K +1.2 %, B -0.4 %": parameters that move by more than a thousandth.
std::string BiasText(const Equation& equation, const Analysis& analysis, const Vector& change) {
  const Fitted& base = analysis.finding.base->fit;
  const Matrix none = Matrix::Zero(base.theta.size(), base.theta.size());
  const auto before = equation.Report(analysis.signals, base.theta, none);
  const auto after = equation.Report(analysis.signals, Vector(base.theta + change), none);
  std::string text;
  for (std::size_t i = 0; i < before.size(); ++i) {
    const double percent = 100.0 * (after[i].mean / before[i].mean - 1.0);
    if (!(std::abs(percent) >= 0.05)) continue;
    char one[80];
    std::snprintf(one, sizeof(one), "%s%s %+.2g %%", text.empty() ? "" : ", ", before[i].name.c_str(), percent);
    text += one;
  }
  return text.empty() ? "no parameter by a thousandth" : text;
}

std::vector<Signatures> SignaturesOf(const Analysis& analysis) {
  const Fitted& base = analysis.finding.base->fit;
  std::vector<const EffectForm*> forms;
  for (const EffectForm& form : analysis.catalogue) {
    const bool known = std::any_of(base.hypothesis.terms.begin(), base.hypothesis.terms.end(),
                                   [&](const Term& term) { return term.form->effect == form.effect; });
    if (form.exact() && !known) forms.push_back(&form);
  }
  std::vector<Signatures> all(forms.size());
  support::InParallel(forms.size(), [&](std::size_t i) {
    all[i] = {forms[i]->effect, Templates(*analysis.fitter, base, *forms[i], nullptr)};
  });
  return all;
}

}  // namespace

std::vector<std::string> Aliases(const Equation& equation, const Analysis& analysis) {
  const Fitted& base = analysis.finding.base->fit;
  const Tangent tangent(base);
  const Vector predicted = analysis.fitter->whitener().Apply(base.predicted);
  const double noise = std::sqrt(analysis.fitter->whitener().variance * static_cast<double>(predicted.size()));
  std::vector<std::string> texts;
  if (predicted.squaredNorm() > 0.0 && tangent.ShareInTangent(predicted) > kAbsorbed)
    texts.push_back("a wrong gain or unit of the " + equation.output_name() +
                    ": the parameters absorb it. One percent too much looks like " +
                    BiasText(equation, analysis, Vector(0.01 * tangent.Bias(predicted))));
  std::vector<std::pair<std::string, std::vector<Outside>>> visible;
  for (const Signatures& signatures : SignaturesOf(analysis)) {
    std::vector<Outside> outside;
    const Vector* strongest = nullptr;
    bool absorbed = true;
    for (const Vector& g : signatures.of) {
      if (!(g.squaredNorm() > kNothing * predicted.squaredNorm())) continue;
      if (strongest == nullptr || g.squaredNorm() > strongest->squaredNorm()) strongest = &g;
      absorbed = absorbed && tangent.ShareInTangent(g) > kAbsorbed;
      outside.emplace_back(tangent.Outside(g));
    }
    if (strongest == nullptr)
      texts.push_back(signatures.effect + ": never acts in this motion");
    else if (absorbed)
      texts.push_back(signatures.effect + ": the parameters absorb it. As strong as the noise it looks like " +
                      BiasText(equation, analysis, Vector(tangent.Bias(*strongest) * (noise / strongest->norm()))));
    else
      visible.emplace_back(signatures.effect, std::move(outside));
  }
  for (std::size_t i = 0; i < visible.size(); ++i)
    for (std::size_t j = i + 1; j < visible.size(); ++j) {
      double alike = 0.0;
      for (const Outside& one : visible[i].second)
        for (const Outside& other : visible[j].second)
          alike = std::max(alike, std::abs(one.g.dot(other.g)) / (one.norm * other.norm + 1e-300));
      if (!(alike > kAlike)) continue;
      char text[200];
      std::snprintf(text, sizeof(text),
                    "%s and %s look alike in this motion (correlation up to %.3f): it takes another to tell them apart",
                    visible[i].first.c_str(), visible[j].first.c_str(), alike);
      texts.emplace_back(text);
    }
  return texts;
}

}  // namespace armcmc::gap
