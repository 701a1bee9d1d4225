#pragma once

#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "armcmc/gap/blocks.hpp"
#include "armcmc/gap/equation.hpp"
#include "armcmc/gap/hypothesis.hpp"
#include "armcmc/gap/whitener.hpp"

namespace armcmc::gap {

/// Orthonormal basis of the columns, with as many columns as the rank.
[[nodiscard]] Matrix OrthonormalBasis(const Matrix& columns);

/// A hypothesis fitted to a recording.
struct Fitted {
  Hypothesis hypothesis;
  std::vector<Coordinate> coordinates;
  Vector theta;
  Vector predicted;            ///< [row]
  Vector whitened_residual;    ///< [row]
  Matrix whitened_jacobian;    ///< [row][coordinate], raw units.
  std::vector<bool> at_bound;  ///< Coordinates at a bound, and times of events: their columns are not validated.
  double squares = 0.0;        ///< Sum of the squared whitened residual.
  Vector heldout;              ///< Log score of each block under the fit to all other blocks, nats.
  double log_evidence = 0.0;   ///< Laplace, with the catalogue's priors, nats.

  [[nodiscard]] double score() const { return heldout.sum(); }
  /// Whether a coordinate is at a bound beyond which the effect would be a different one.
  [[nodiscard]] bool on_edge() const;
  /// Loss of log likelihood, in nats, if a coordinate is set to its prior mean and the others are refitted
  /// (linearised).
  [[nodiscard]] double CostOfLeavingOut(Eigen::Index coordinate) const;
  /// Orthonormal basis of whitened_jacobian; computed once, by one thread before others ask for it, since every
  /// extension of the fit projects it out.
  [[nodiscard]] const Matrix& basis() const;
  /// variance H^-1 of the whitened fit, zero for coordinates at a bound. Events are included.
  [[nodiscard]] Matrix Covariance(double variance) const;

 private:
  mutable std::shared_ptr<const Matrix> basis_;
};

/// Prior of the coordinates from another recording: Gaussian, log p = -(theta - mean)' precision (theta - mean) / 2.
struct CoordinatePrior {
  Vector mean;
  Matrix precision;
};

/// Fits hypotheses to one recording with one noise model. Threads may share it.
class Fitter {
 public:
  static constexpr int kMaxSteps = 12;

  Fitter(const Equation& equation, const Signals& signals, Whitener whitener);

  [[nodiscard]] const Equation& equation() const { return *equation_; }
  [[nodiscard]] const Signals& signals() const { return *signals_; }
  [[nodiscard]] const Whitener& whitener() const { return whitener_; }

  [[nodiscard]] Prediction Predict(const Hypothesis& hypothesis, const Vector& theta, Slopes wanted = {}) const;
  /// Bounded Levenberg-Marquardt from `start`, then Score.
  /// @param prior  Prior of all coordinates; may be null.
  [[nodiscard]] Fitted Fit(const Hypothesis& hypothesis, const Vector& start, int max_steps = kMaxSteps,
                           const CoordinatePrior* prior = nullptr) const;
  /// The best fit of `parent` with one more term: grid over the term's starts by projected score, then Fit.
  [[nodiscard]] Fitted Add(const Fitted& parent, const Term& term) const;
  /// Decrease of the sum of squares of `parent` at the best of the starts of Add: a lower bound of the decrease by Add,
  /// at a fraction of its cost.
  [[nodiscard]] double LeastDecrease(const Fitted& parent, const Term& term) const;

 private:
  struct Descent;
  /// @param rival  A fit of the same hypothesis from elsewhere; may be null. The descent stops if it reaches the
  ///               same minimum, or cannot improve on it.
  [[nodiscard]] Descent Descend(const Hypothesis& hypothesis, const Vector& start, int max_steps,
                                const CoordinatePrior* prior, const Fitted* rival) const;
  [[nodiscard]] Fitted Finish(const Hypothesis& hypothesis, Descent at) const;
  /// Sum of squares and coordinates at each of the term's starts, amplitudes fitted, in increasing order of squares.
  [[nodiscard]] std::vector<std::pair<double, Vector>> Starts(const Fitted& parent, const Term& term) const;
  /// Halves amplitudes [first, first + count) until the simulation of the plant does not diverge.
  void ShrinkUntilFinite(const Hypothesis& hypothesis, Eigen::Index first, int count, Vector* theta) const;
  /// Fills at_bound, heldout and log_evidence.
  void Score(Fitted* fitted) const;

  /// One for each thread that fits.
  class Memos {
   public:
    [[nodiscard]] std::unique_ptr<LawMemo> Take();
    void Give(std::unique_ptr<LawMemo> memo);

   private:
    std::mutex mutex_;
    std::vector<std::unique_ptr<LawMemo>> idle_;
  };

  const Equation* equation_;
  const Signals* signals_;
  Whitener whitener_;
  mutable Memos memos_;
};

}  // namespace armcmc::gap
