// Random-walk Metropolis with the random numbers and the linear algebra of the GNU Scientific Library.

#include <gsl/gsl_linalg.h>
#include <gsl/gsl_matrix.h>
#include <gsl/gsl_randist.h>
#include <gsl/gsl_rng.h>
#include <gsl/gsl_vector.h>
#include <gsl/gsl_version.h>

#include <cmath>

#include "problem.hpp"

namespace {

constexpr double kGoal = 0.3;          // of the acceptance while the scale is tuned
constexpr double kTuning = 1.0 / 5.0;  // of the evaluations
constexpr int kEvery = 100;            // steps between two looks at the covariance

/// Mean and covariance of the draws so far.
struct Moments {
  double count = 0.0;
  peers::Theta mean{};
  peers::Matrix squares{};
  void Add(const peers::Theta& x) {
    count += 1.0;
    peers::Theta before{};
    for (std::size_t i = 0; i < 3; ++i) before[i] = x[i] - mean[i];
    for (std::size_t i = 0; i < 3; ++i) mean[i] += before[i] / count;
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j) squares[i][j] += before[i] * (x[j] - mean[j]);
  }
};

/// Its lower Cholesky factor, of a matrix over a divisor.
void Factor(const peers::Matrix& matrix, double divisor, gsl_matrix* factor) {
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) gsl_matrix_set(factor, i, j, matrix[i][j] / divisor);
  gsl_linalg_cholesky_decomp1(factor);
}

peers::Replicate Walk(const peers::Problem& problem, int replicate, int evaluations) {
  gsl_rng* random = gsl_rng_alloc(gsl_rng_mt19937);
  gsl_rng_set(random, 1000UL + static_cast<unsigned long>(replicate));
  gsl_matrix* factor = gsl_matrix_alloc(3, 3);
  gsl_vector* zero = gsl_vector_calloc(3);
  gsl_vector* step = gsl_vector_alloc(3);

  const peers::Laplace fit = peers::Fit(problem);
  Factor(fit.covariance, 1.0, factor);
  double scale = 2.38 / std::sqrt(3.0);

  peers::Theta theta = fit.mean, sum{};
  double value = peers::LogPosterior(problem, theta);
  const int tuning = static_cast<int>(kTuning * evaluations);
  int accepted = 0;
  Moments seen;
  for (int k = 0; k < evaluations; ++k) {
    gsl_ran_multivariate_gaussian(random, zero, factor, step);
    peers::Theta next = theta;
    for (std::size_t d = 0; d < 3; ++d) next[d] += scale * gsl_vector_get(step, d);
    const double there = peers::LogPosterior(problem, next);
    const bool take = std::log(gsl_rng_uniform_pos(random)) < there - value;
    if (take) {
      theta = next;
      value = there;
    }
    if (k < tuning) {
      scale *= std::exp(((take ? 1.0 : 0.0) - kGoal) / std::sqrt(k % (tuning / 2) + 1.0));
      seen.Add(theta);
      if (k >= tuning / 4 && k % kEvery == 0) Factor(seen.squares, seen.count - 1.0, factor);
      continue;
    }
    accepted += take ? 1 : 0;
    for (std::size_t d = 0; d < 3; ++d) sum[d] += theta[d] - fit.mean[d];
  }
  gsl_vector_free(step);
  gsl_vector_free(zero);
  gsl_matrix_free(factor);
  gsl_rng_free(random);
  peers::Replicate got;
  const double kept = evaluations - tuning;
  got.acceptance = accepted / kept;
  for (std::size_t d = 0; d < 3; ++d) got.mean[d] = fit.mean[d] + sum[d] / kept;
  return got;
}

}  // namespace

int main(int argc, char** argv) {
  return peers::Main(argc, argv, "GSL " GSL_VERSION " random-walk Metropolis",
                     "starts at a least squares fit, steps with its covariance and then with that of the draws; scale "
                     "tuned to an acceptance of 30 %; the first fifth is used for tuning and discarded",
                     Walk);
}
