#include "estimates.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "armcmc/gap/separation.hpp"
#include "armcmc/identify/fit.hpp"

namespace armcmc::ladder {

Estimated Estimates(const Trial& trial, const std::vector<std::uint8_t>& rows) {
  const Eigen::MatrixXd covariance = identify::Covariance(*trial.model, rows, trial.fit);
  Estimated out;
  std::vector<gap::FittedParameter> fitted;
  for (Eigen::Index d = 0; d < trial.fit.theta.size(); ++d) {
    const ParameterDescription& p = trial.model->parameters()[static_cast<std::size_t>(d)];
    const bool logarithmic = p.prior == "lognormal";
    const double value = trial.model->Shown(d, trial.fit.theta[d]);
    const double sd = std::sqrt(std::max(covariance(d, d), 0.0));
    fitted.push_back({p.name, p.unit, value, logarithmic});
    out.parameters.push_back({p.name, p.unit, value, logarithmic ? value * sd : sd});
  }
  gap::Separation separation = gap::Separate(fitted, covariance);
  for (std::size_t d = 0; d < fitted.size(); ++d)
    out.parameters[d].confounded_with = std::move(separation.confounded_with[d]);
  out.determined = std::move(separation.combinations);
  return out;
}

}  // namespace armcmc::ladder
