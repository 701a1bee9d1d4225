#include "prospect.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "armcmc/identify/fit.hpp"
#include "motion.hpp"
#include "widths.hpp"

namespace armcmc::ladder {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using expression::SymbolKind;

constexpr std::size_t kComparedEffects = 3;  // larger ties need a second experiment
constexpr double kLeastProbability = 0.1;    // lower bound of the weight of an effect
constexpr double kMuchTheSame =
    0.05;  // share of the missing part by which two effects must differ, since no law is exact
constexpr double kOutputReach = 2.0;  // relative to the recorded range of the output

std::shared_ptr<const Plant> Copy(const Plant& plant) { return std::make_shared<const Plant>(plant.description()); }

}  // namespace

Tied::Tied(const Rung& rung) {
  plants_.push_back(Copy(rung.base.model->plant()));
  theta_.push_back(rung.base.fit.theta);
  for (std::size_t k = 0; k < std::min(rung.named.size(), kComparedEffects); ++k) {
    const Contender& contender = rung.contenders[rung.named[k]];
    contenders_.push_back(&contender);
    plants_.push_back(Copy(*contender.candidate.plant));
    theta_.push_back(contender.trial.fit.theta);
  }
  const Trial& best = contenders_.front()->trial;
  const std::vector<std::uint8_t>& rows = rung.view.data.training;
  error_sd_ = best.fit.error_sd;
  square_ = error_sd_ * error_sd_ * Correlated(best, rows) + 1e-300;
  std::vector<double> output;
  for (std::size_t n = 0; n < rows.size(); ++n)
    if (rows[n] != 0 && best.model->active()[n] != 0) output.push_back(best.model->target()[static_cast<Index>(n)]);
  const auto half = output.begin() + static_cast<std::ptrdiff_t>(output.size() / 2);
  std::nth_element(output.begin(), half, output.end());
  middle_ = *half;
  for (const double y : output) reach_ = std::max(reach_, std::fabs(y - middle_));
}

std::string Tied::NotMade() const {
  const PlantDescription& described = plants_.front()->description();
  const std::vector<std::size_t> inputs = InputsOf(described);
  std::vector<bool> made(described.signals.size(), false);
  for (const std::size_t s : inputs) made[s] = true;
  // Derivatives of prescribed signals are prescribed too; each pass adds the next order.
  for (std::size_t round = 0; round < made.size(); ++round)
    for (std::size_t s = 0; s < made.size(); ++s)
      for (std::size_t of = 0; of < made.size(); ++of)
        if (made[of] && described.signals[s].derivative_of == described.signals[of].name) made[s] = true;
  for (const std::shared_ptr<const Plant>& plant : plants_)
    for (std::size_t s = 0; s < made.size(); ++s) {
      const int signal = plant->NodeOf(SymbolKind::kSignal, static_cast<int>(s));
      const auto reads = [&](int node) { return node >= 0 && plant->graph().DependsOn(node, signal); };
      bool read = false;
      for (const PlantMode& mode : plant->modes()) {
        read = read || reads(mode.when) || reads(mode.law);
        // A target other than the output is not simulated.
        if (!mode.passive && mode.target != plant->NodeOf(SymbolKind::kSignal, plant->output()))
          return "what the law explains";
      }
      for (const PlantState& state : plant->states()) read = read || reads(state.rate);
      if (read && !made[s]) return described.signals[s].name;
    }
  return "";
}

std::optional<Tied::Made> Tied::Make(const std::shared_ptr<identify::Series>& series) const {
  Made made;
  std::vector<double>& output = series->signals[static_cast<std::size_t>(plants_.front()->output())];
  for (std::size_t i = 0; i < plants_.size(); ++i) {
    made.models.push_back(std::make_shared<const identify::TrajectoryModel>(plants_[i], series));
    made.prediction.emplace_back();
    made.jacobian.emplace_back();
    if (!made.models[i]->Linearise(theta_[i], &made.prediction[i], &made.jacobian[i])) return std::nullopt;
    if ((made.prediction[i].array() - middle_).abs().maxCoeff() > kOutputReach * reach_) return std::nullopt;
    // A state that starts at the output starts at the output of the base model; for a simulated plant, at its first
    // value.
    if (i == 0 && !IsSimulated(plants_[i]->description()))
      std::copy(made.prediction[0].begin(), made.prediction[0].end(), output.begin());
  }
  return made;
}

double Tied::Left(const Made& made, std::size_t truth, std::size_t rival) const {
  const std::vector<std::uint8_t>& active = made.models[rival]->active();
  const VectorXd precision = identify::PriorPrecision(*made.models[rival]);
  const Index parameters = precision.size();
  MatrixXd normal = MatrixXd(error_sd_ * error_sd_ * precision.asDiagonal());
  VectorXd right = VectorXd::Zero(parameters);
  const VectorXd apart = made.prediction[truth] - made.prediction[rival];
  double squares = 0.0;
  for (Index n = 0; n < apart.size(); ++n) {
    if (active[static_cast<std::size_t>(n)] == 0) continue;
    squares += apart[n] * apart[n];
    right += apart[n] * made.jacobian[rival].row(n).transpose();
    normal.selfadjointView<Eigen::Lower>().rankUpdate(made.jacobian[rival].row(n).transpose());
  }
  normal.triangularView<Eigen::StrictlyUpper>() = normal.transpose();
  const VectorXd size = normal.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  MatrixXd scaled = size.asDiagonal() * normal * size.asDiagonal();
  scaled.diagonal().array() += 1e-12;
  const VectorXd step = size.cwiseProduct(scaled.ldlt().solve(size.cwiseProduct(right)));
  return std::max(0.0, squares - step.dot(right));
}

Prospect Tied::Judge(const std::vector<std::vector<double>>& left) const {
  Prospect prospect;
  prospect.least = HUGE_VAL;
  double total = 0.0;
  const auto nats_of = [&](std::size_t truth, std::size_t rival) { return 0.5 * left[truth][rival + 1] / square_; };
  for (std::size_t one = 0; one < contenders_.size(); ++one)
    for (std::size_t two = 0; two < one; ++two) {
      const double least = std::min(nats_of(one, two), nats_of(two, one));
      ++prospect.pairs;
      if (least < kDecidingNats) ++prospect.open;
      if (least < prospect.least) {
        prospect.least = least;
        prospect.one = two;
        prospect.two = one;
      }
      const double weight =
          (contenders_[one]->win_share + kLeastProbability) * (contenders_[two]->win_share + kLeastProbability);
      for (const auto& [truth, rival] : {std::pair(one, two), std::pair(two, one)}) {
        const double nats = nats_of(truth, rival);
        const double share = std::min(1.0, left[truth][rival + 1] / (left[truth][0] + 1e-300));
        prospect.decided += weight * nats / (nats + kDecidingNats) * share / (share + kMuchTheSame);
        total += weight;
      }
    }
  prospect.decided /= total;
  return prospect;
}

std::optional<Prospect> Tied::Expected(const std::shared_ptr<identify::Series>& series) const {
  const std::optional<Made> made = Make(series);
  if (!made) return std::nullopt;
  std::vector<std::vector<double>> left(contenders_.size(), std::vector<double>(plants_.size(), 0.0));
  for (std::size_t truth = 0; truth < contenders_.size(); ++truth)
    for (std::size_t rival = 0; rival < plants_.size(); ++rival)
      if (rival != truth + 1) left[truth][rival] = Left(*made, truth + 1, rival);
  return Judge(left);
}

std::optional<Prospect> Tied::Refitted(const std::shared_ptr<identify::Series>& series) const {
  constexpr int kIterations = 8;
  const std::optional<Made> made = Make(series);
  if (!made) return std::nullopt;
  std::vector<double>& output = series->signals[static_cast<std::size_t>(plants_.front()->output())];
  const std::vector<std::uint8_t> all(series->num_rows(), 1);
  std::vector<std::vector<double>> left(contenders_.size(), std::vector<double>(plants_.size(), 0.0));
  for (std::size_t truth = 0; truth < contenders_.size(); ++truth) {
    std::copy(made->prediction[truth + 1].begin(), made->prediction[truth + 1].end(), output.begin());
    for (std::size_t rival = 0; rival < plants_.size(); ++rival) {
      if (rival == truth + 1) continue;
      const identify::TrajectoryModel model(plants_[rival], series);
      const identify::FitResult fit = identify::Fit(model, all, theta_[rival], kIterations);
      const auto count = static_cast<double>(std::count(model.active().begin(), model.active().end(), 1));
      left[truth][rival] = fit.valid ? count * fit.error_sd * fit.error_sd : Left(*made, truth + 1, rival);
    }
  }
  return Judge(left);
}

}  // namespace armcmc::ladder
