// What the engine asks of the contact.

#include <cmath>
#include <limits>
#include <memory>

#include "armcmc/models/compiled_plant.hpp"
#include "armcmc/models/plain_ops.hpp"
#include "plants/hunt_crossley/contact_rows.hpp"
#include "plants/hunt_crossley/effects.hpp"
#include "plants/hunt_crossley/gap_family.hpp"
#include "plants/hunt_crossley/log_linear.hpp"
#include "plants/hunt_crossley/model.hpp"

namespace armcmc {
namespace {

/// The force as the law says it; nothing is remembered from pack to pack.
class ContactPredictor final : public OutputPredictor {
 public:
  void Predict(const DataPack& pack, const ShownEstimates& shown, std::array<double, kMaxPackSamples>* output,
               std::array<double, kMaxPackSamples>* free_run) noexcept ARMCMC_NONBLOCKING override {
    for (int n = 0; n < pack.num_samples; ++n) {
      const auto i = static_cast<std::size_t>(n);
      const double x = pack.u[i][0];
      const auto& theta = shown.theta[0];
      (*output)[i] = x < 0.0          ? 0.0
                     : shown.known[0] ? std::pow(x, theta[2]) * (theta[0] + theta[1] * pack.u[i][1])
                                      : std::numeric_limits<double>::quiet_NaN();
      (*free_run)[i] = (*output)[i];
    }
  }

  [[nodiscard]] double LastOutput(const DataPack&, const ShownEstimates&, int,
                                  const double*) const noexcept ARMCMC_NONBLOCKING override {
    return std::numeric_limits<double>::quiet_NaN();  // the law says it
  }
};

/// Contact throughout: x in [0.7, 1.3] m. K = 4 N/m^p, B = 2.3 N s/m^(p+1), p = 1.7.
void TypicalContact(double t, std::size_t n, DataPack* pack) noexcept ARMCMC_NONBLOCKING {
  const double x = 1.0 + 0.3 * std::sin(5.0 * t);
  const double v = 1.5 * std::cos(5.0 * t);
  pack->u[n][0] = x;
  pack->u[n][1] = v;
  pack->y[n] = std::pow(x, 1.7) * (4.0 + 2.3 * v);
}

std::unique_ptr<EffectRows> MakeContactRows(const EstimatorSettings& settings) {
  return settings.num_effects > 0 ? std::make_unique<ContactRows>(settings) : nullptr;
}

std::unique_ptr<OutputPredictor> MakeContactPredictor(const ModelInfo&, const PlantConstants&, const EffectRows*) {
  return std::make_unique<ContactPredictor>();
}

}  // namespace

constinit const CompiledPlant kContactPlant{
    .inputs = {{{"x", "m", ""}, {"v", "m/s", "x"}}},
    .output = {"f", "N", ""},
    .output_word = "force",
    .law_is_output = true,
    .no_contact_as = "",
    .constants = {},
    .rate_unit = "",
    .offline_as = "",
    .effects = ContactEffects::kInfos,
    .variants = {},
    .prepare = &HuntCrossley::Prepare,
    .predict = &HuntCrossley::Predict<PlainOps>,
    .rate = nullptr,
    .typical_sample = &TypicalContact,
    .make_rows = &MakeContactRows,
    .make_predictor = &MakeContactPredictor,
    .make_watch = nullptr,
    .gap_family = &ContactGapFamily,
    .regression = &kLogLinearForm,
};

}  // namespace armcmc
