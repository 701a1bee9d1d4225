#include "armcmc/gap/gate_scan.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace armcmc::gap {
namespace {

constexpr double kEdgeShare = 0.08;       // of the recording, at each end, where an onset means nothing
constexpr double kActiveShare = 0.02;     // of the busiest block's energy, from which a block counts as active
constexpr double kMinIndependent = 1e-6;  // of a template's energy that the parent's columns must leave

int ActiveBlocks(const Vector& block_energy) {
  return static_cast<int>((block_energy.array() > kActiveShare * block_energy.maxCoeff()).count());
}

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// c'r, |c|^2 and |Q'c|^2 of a template.
struct Sums {
  double cross = 0.0, energy = 0.0, dependent = 0.0;
};

/// Decrease of the squares by the best amplitude; 0 where the sign is wrong or nothing is left of the template.
double GainOf(const Sums& s, bool positive) {
  const double independent = s.energy - s.dependent;
  if (independent < kMinIndependent * s.energy || !(s.energy > 0.0)) return 0.0;
  if (positive && s.cross <= 0.0) return 0.0;
  return s.cross * s.cross / independent;
}

class Scan {
 public:
  Scan(const Fitter& fitter, const Fitted& parent, const EffectForm& form, int min_active)
      : signals_(fitter.signals()),
        residual_(parent.whitened_residual),
        basis_(parent.basis()),
        positive_(form.linear ? form.num_amplitudes == 1 && form.coordinates[0].lower >= 0.0 : true),
        min_active_(min_active) {}

  void Consider(const EffectForm& form, const Vector& c, std::vector<GateCandidate>* best) const {
    const Eigen::Index n = c.size();
    const Sums total = Sum(c);
    const double always = GainOf(total, positive_);
    if (form.gates_by_mode) {
      for (const When::Kind kind : {When::Kind::kContact, When::Kind::kFree}) {
        const Vector gate = GateOf({kind, 0.0}, signals_);
        const Vector gated = c.cwiseProduct(gate);
        if (ActiveBlocks(BlockSquares(gated)) >= min_active_)
          Keep({{&form, {kind, 0.0}}, GainOf(Sum(gated), positive_), always}, best);
      }
    }
    if (!form.gates_by_time) return;
    const auto edges = BlockEdges(n);
    const Vector energy = BlockSquares(c);
    const auto edge = static_cast<Eigen::Index>(kEdgeShare * static_cast<double>(n));
    const Vector all = basis_.transpose() * c;
    Sums until, from;
    Vector so_far = Vector::Zero(basis_.cols());
    GateCandidate from_best{{&form, {When::Kind::kFrom, 0.0}}, 0.0, always};
    GateCandidate until_best{{&form, {When::Kind::kUntil, 0.0}}, 0.0, always};
    for (Eigen::Index i = 0; i < n; ++i) {
      if (i >= edge && i < n - edge) {
        from.cross = total.cross - until.cross;
        from.energy = total.energy - until.energy;
        from.dependent = (all - so_far).squaredNorm();
        until.dependent = so_far.squaredNorm();
        const double from_gain = GainOf(from, positive_), until_gain = GainOf(until, positive_);
        if (from_gain > from_best.gain) from_best = {{&form, {When::Kind::kFrom, signals_.t[i]}}, from_gain, always};
        if (until_gain > until_best.gain)
          until_best = {{&form, {When::Kind::kUntil, signals_.t[i]}}, until_gain, always};
      }
      until.cross += c[i] * residual_[i];
      until.energy += c[i] * c[i];
      so_far += c[i] * basis_.row(i).transpose();
    }
    for (const GateCandidate& candidate : {from_best, until_best}) {
      const bool starts = candidate.term.when.kind == When::Kind::kFrom;
      Vector active = energy;
      for (int b = 0; b < kNumBlocks; ++b) {
        const double start = signals_.t[edges[static_cast<std::size_t>(b)]];
        if (starts != (start >= candidate.term.when.time_s)) active[b] = 0.0;
      }
      if (candidate.gain > 0.0 && ActiveBlocks(active) >= min_active_) Keep(candidate, best);
    }
  }

 private:
  [[nodiscard]] Sums Sum(const Vector& c) const {
    return {c.dot(residual_), c.squaredNorm(), (basis_.transpose() * c).squaredNorm()};
  }
  static void Keep(const GateCandidate& candidate, std::vector<GateCandidate>* best) {
    for (GateCandidate& kept : *best) {
      if (kept.term.when.kind != candidate.term.when.kind) continue;
      kept.always_gain = std::max(kept.always_gain, candidate.always_gain);
      if (candidate.gain > kept.gain) {
        kept.gain = candidate.gain;
        kept.term = candidate.term;
      }
      return;
    }
    best->push_back(candidate);
  }

  const Signals& signals_;
  const Vector& residual_;
  RowMajor basis_;  // a row is read at a time
  bool positive_;
  int min_active_;
};

}  // namespace

std::vector<GateCandidate> ScanGates(const Fitter& fitter, const Fitted& parent, const EffectForm& form,
                                     const std::vector<Vector>& templates, int min_active_blocks) {
  const Scan scan(fitter, parent, form, min_active_blocks);
  std::vector<GateCandidate> best;
  for (const Vector& c : templates) scan.Consider(form, c, &best);
  std::sort(best.begin(), best.end(), [](const auto& a, const auto& b) { return a.gain > b.gain; });
  return best;
}

std::vector<Vector> Templates(const Fitter& fitter, const Fitted& parent, const EffectForm& form,
                              const Fitted* fitted) {
  constexpr double kUnit = 0.05;  // amplitude of a template, of a coordinate of order one
  Hypothesis hypothesis = parent.hypothesis;
  hypothesis.terms.push_back({&form, {}});
  std::vector<std::vector<double>> starts = form.starts;
  if (form.find_starts)
    for (std::vector<double>& start : form.find_starts(fitter.signals(), parent.whitened_residual))
      starts.push_back(std::move(start));
  const Eigen::Index first = parent.theta.size();
  if (fitted != nullptr) {
    const Vector own = fitted->theta.tail(form.size());
    starts.emplace_back(own.data(), own.data() + own.size());
  }
  std::vector<Vector> templates;
  const bool only_adds = form.linear && LastOnlyAdds(hypothesis);
  for (const std::vector<double>& start : starts) {
    if (only_adds) {
      const Matrix columns = Features(fitter.signals(), {&form, {}}, start.data() + form.num_amplitudes);
      for (int a = 0; a < form.num_amplitudes; ++a)
        templates.push_back(fitter.whitener().Apply(Vector(kUnit * columns.col(a))));
      continue;
    }
    Vector theta(first + form.size());
    theta << parent.theta, Eigen::Map<const Vector>(start.data(), form.size());
    for (int a = 0; form.linear && a < form.num_amplitudes; ++a) {
      // Each amplitude alone, so that a phase is not frozen.
      Vector alone = theta;
      alone.segment(first, form.num_amplitudes).setZero();
      alone[first + a] = kUnit;
      const Prediction p = fitter.Predict(hypothesis, alone, Slopes::None());
      templates.push_back(fitter.whitener().Apply(Vector(p.y - parent.predicted)));
    }
    if (!form.linear) {
      const Prediction p = fitter.Predict(hypothesis, theta, Slopes::None());
      templates.push_back(fitter.whitener().Apply(Vector(p.y - parent.predicted)));
    }
  }
  return templates;
}

}  // namespace armcmc::gap
