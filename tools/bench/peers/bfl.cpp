// The particle filter of the Orocos Bayesian Filtering Library: one update with all samples of the pack.

#include <filter/bootstrapfilter.h>
#include <model/measurementmodel.h>
#include <pdf/conditionalpdf.h>
#include <pdf/gaussian.h>
#include <pdf/mcpdf.h>

#include <cmath>
#include <cstdlib>
#include <vector>

#include "problem.hpp"

namespace {

using MatrixWrapper::ColumnVector;
using MatrixWrapper::SymmetricMatrix;

peers::Theta ThetaOf(const ColumnVector& x) { return {x(1), x(2), x(3)}; }

double LogPrior(const peers::Problem& problem, const peers::Theta& theta) {
  double sum = 0.0;
  for (std::size_t d = 0; d < 3; ++d) {
    const double z = (theta[d] - problem.prior[d].mean) / problem.prior[d].sd;
    sum -= 0.5 * z * z;
  }
  return sum;
}

/// p(y | theta), relative to that of the best fit so that it does not underflow.
class PackLikelihood : public BFL::ConditionalPdf<ColumnVector, ColumnVector> {
 public:
  PackLikelihood(const peers::Problem& problem, const peers::Theta& best)
      : BFL::ConditionalPdf<ColumnVector, ColumnVector>(static_cast<unsigned>(problem.f.size()), 1),
        problem_(problem),
        top_(LogLikelihood(best)) {}

  BFL::Probability ProbabilityGet(const ColumnVector& /*y*/) const override {
    return std::exp(LogLikelihood(ThetaOf(ConditionalArgumentGet(0))) - top_);
  }

 private:
  [[nodiscard]] double LogLikelihood(const peers::Theta& theta) const {
    const double log_posterior = peers::LogPosterior(problem_, theta);
    return std::isfinite(log_posterior) ? log_posterior - LogPrior(problem_, theta) : -HUGE_VAL;
  }

  const peers::Problem& problem_;
  double top_;
};

peers::Replicate Filter(const peers::Problem& problem, int replicate, int evaluations) {
  (void)replicate;  // the library has one stream of random numbers, which goes on
  constexpr double kWider = 1.2;
  const peers::Laplace fit = peers::Fit(problem);
  ColumnVector mean(3);
  SymmetricMatrix covariance(3);
  for (std::size_t i = 0; i < 3; ++i) {
    mean(static_cast<unsigned>(i + 1)) = fit.mean[i];
    for (std::size_t j = 0; j <= i; ++j)
      covariance(static_cast<unsigned>(i + 1), static_cast<unsigned>(j + 1)) = kWider * kWider * fit.covariance[i][j];
  }
  const BFL::Gaussian proposal(mean, covariance);
  std::vector<BFL::Sample<ColumnVector>> drawn(static_cast<std::size_t>(evaluations), BFL::Sample<ColumnVector>(3));
  proposal.SampleFrom(drawn, static_cast<unsigned>(evaluations), CHOLESKY, nullptr);

  // The particles stand for the prior: each has the weight prior / proposal.
  const peers::Matrix factor = peers::Cholesky(fit.covariance);
  const double at_fit = LogPrior(problem, fit.mean);
  std::vector<BFL::WeightedSample<ColumnVector>> particles(drawn.size(), BFL::WeightedSample<ColumnVector>(3));
  for (std::size_t k = 0; k < drawn.size(); ++k) {
    const peers::Theta theta = ThetaOf(drawn[k].ValueGet());
    double squares = 0.0;
    peers::Theta z{};
    for (std::size_t i = 0; i < 3; ++i) {
      z[i] = theta[i] - fit.mean[i];
      for (std::size_t j = 0; j < i; ++j) z[i] -= factor[i][j] * z[j];
      z[i] /= factor[i][i];
      squares += z[i] * z[i] / (kWider * kWider);
    }
    particles[k].ValueSet(drawn[k].ValueGet());
    particles[k].WeightSet(std::exp(LogPrior(problem, theta) - at_fit + 0.5 * squares));
  }
  BFL::MCPdf<ColumnVector> prior(static_cast<unsigned>(evaluations), 3);
  prior.ListOfSamplesSet(particles);

  PackLikelihood likelihood(problem, fit.mean);
  BFL::MeasurementModel<ColumnVector, ColumnVector> model(&likelihood);
  ColumnVector y(static_cast<unsigned>(problem.f.size()));
  for (std::size_t n = 0; n < problem.f.size(); ++n) y(static_cast<unsigned>(n + 1)) = problem.f[n];
  // A threshold of less than one particle: the mean is that of the weighted particles, before any resampling.
  BFL::BootstrapFilter<ColumnVector, ColumnVector> filter(&prior, 0, 0.5);
  filter.Update(&model, y);

  const auto* posterior = static_cast<BFL::MCPdf<ColumnVector>*>(filter.PostGet());
  peers::Replicate got;
  got.mean = ThetaOf(posterior->ExpectedValueGet());
  double sum = 0.0, squares = 0.0;
  for (const auto& particle : posterior->ListOfSamplesGet()) {
    sum += particle.WeightGet();
    squares += particle.WeightGet() * particle.WeightGet();
  }
  got.acceptance = sum * sum / squares / evaluations;
  return got;
}

}  // namespace

int main(int argc, char** argv) {
  return peers::Main(argc, argv, "Orocos BFL 0.8.0 particle filter",
                     "particles from a normal law about a least squares fit, 1.2 times as wide, weighted by prior over "
                     "proposal; one update with the whole pack; mean before resampling",
                     Filter);
}
