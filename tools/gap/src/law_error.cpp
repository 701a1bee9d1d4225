#include "armcmc/gap/law_error.hpp"

#include <memory>
#include <mutex>
#include <string>
#include <utility>

#include "armcmc/gap/features.hpp"
#include "armcmc/gap/form_tools.hpp"

namespace armcmc::gap {
namespace {

constexpr double kWidth = 1.2;                  // of a bump, in distances between places
constexpr double kTypical = 0.05, kMost = 0.5;  // share of the law of a bump; their sum is twice as large

/// Bumps over the range of a variable, [row][place].
Matrix Bumps(const Signals& signals, const LawVariable& variable, int places) {
  const Eigen::ArrayXd value = signals.at(variable.role).array();
  Eigen::ArrayXd place;  // 0 to 1
  if (variable.saturates)
    place = 0.5 + 0.5 * (value / variable.high).tanh();
  else
    place = (value - variable.low) / (variable.high - variable.low);
  Matrix bumps(signals.rows(), places);
  for (int k = 0; k < places; ++k) bumps.col(k) = Exp(-0.5 * (((places - 1) * place - k) / kWidth).square());
  return bumps;
}

/// One bump of both variables a column. They depend on nothing that is fitted, so that the last are kept. Threads may
/// share it.
class BumpsOfBoth {
 public:
  BumpsOfBoth(const LawVariable& a, const LawVariable& b, int places) : a_(a), b_(b), places_(places) {}

  std::shared_ptr<const Matrix> Of(const Signals& signals) {
    const std::lock_guard lock(mutex_);
    const Vector &first = signals.at(a_.role), &second = signals.at(b_.role);
    if (first.size() == first_.size() && first == first_ && second == second_) return bumps_;
    first_ = first;
    second_ = second;
    const Matrix left = Bumps(signals, a_, places_), right = Bumps(signals, b_, places_);
    Matrix bumps(signals.rows(), places_ * places_);
    for (int i = 0; i < places_; ++i) bumps.middleCols(i * places_, places_) = left.col(i).asDiagonal() * right;
    bumps_ = std::make_shared<const Matrix>(std::move(bumps));
    return bumps_;
  }

 private:
  LawVariable a_, b_;
  int places_;
  std::mutex mutex_;
  Vector first_, second_;
  std::shared_ptr<const Matrix> bumps_;
};

}  // namespace

EffectForm LawErrorForm(const LawVariable& a, const LawVariable& b, int places) {
  EffectForm form = UnlistedForm("an error in the formula of the law", "law error",
                                 "law (1 + a smooth function of what it depends on)", Slot::kParameter);
  form.regular = true;
  form.num_amplitudes = places * places;
  for (int k = 0; k < form.num_amplitudes; ++k) {
    form.coordinates.push_back(
        AmplitudeOf(("share_" + std::to_string(k + 1)).c_str(), "-", 1.0, false, kTypical, kMost));
    form.coordinates.back().nuisance = true;
  }
  form.features = [bumps = std::make_shared<BumpsOfBoth>(a, b, places)](const Signals& in, const double*) -> Matrix {
    return *bumps->Of(in);
  };
  SetStarts(&form, {});
  return form;
}

}  // namespace armcmc::gap
