// What a law predicts for parameters: states, laws, derivatives over whole runs.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "armcmc/identify/trajectory_model.hpp"
#include "armcmc/support/wider_lanes.hpp"

namespace armcmc::identify {
namespace {

// What is written in parts of a vector is waited for where it is read as a whole: so these, too, are made of vectors.

/// sum = a + factor b; sum may be a or b.
ARMCMC_FOR_WIDER_LANES
void AddScaled(std::size_t count, const Lanes* a, double factor, const Lanes* b, Lanes* sum) {
  for (std::size_t s = 0; s < count; ++s) {
    ARMCMC_OVER_LANES
    for (std::size_t l = 0; l < kLanes; ++l) sum[s][l] = a[s][l] + factor * b[s][l];
  }
}

ARMCMC_FOR_WIDER_LANES
void Fill(double value, Lanes* lanes) {
  ARMCMC_OVER_LANES
  for (std::size_t l = 0; l < kLanes; ++l) (*lanes)[l] = value;
}

}  // namespace

/// States of candidates from sample to sample, and what their rates remember.
class TrajectoryModel::Walk {
 public:
  /// @param fixed   [input] Those that vary by candidate.
  /// @param offset  [state] Added to the starts; may be null.
  Walk(const TrajectoryModel& model, const std::vector<Lanes>& fixed, const std::vector<Lanes>* offset)
      : model_(model),
        offset_(offset),
        input_(fixed),
        before_(model.num_past_),
        after_(model.num_past_),
        origin_(model.num_states_),
        rate_(model.num_states_),
        sum_(model.num_states_),
        rate_run_(model.rate_.Begin(fixed.data(), model.series_->dt)),
        past_run_(model.past_.Begin(fixed.data(), model.series_->dt)),
        start_run_(model.start_.Begin(fixed.data(), model.series_->dt)) {}

  /// To the row, which is the first of a run or follows the last one.
  void To(std::size_t row, bool begins) {
    if (begins) past_run_.Clear();
    SetSignals(row);
    const double* const t = &model_.series_->t[row];
    if (model_.num_past_ > 0) model_.past_.Evaluate(1, input_.data(), 1, t, &past_run_, after_.data());
    if (begins) {
      model_.start_.Evaluate(1, input_.data(), 1, t, &start_run_, State());
      for (std::size_t s = 0; offset_ != nullptr && s < model_.num_states_; ++s)
        for (std::size_t l = 0; l < kLanes; ++l) State()[s][l] += (*offset_)[s][l];
    } else {
      Advance(row - 1);
    }
    std::swap(before_, after_);
  }
  [[nodiscard]] Lanes* State() { return input_.data() + model_.first_state_; }

 private:
  void SetSignals(std::size_t row) {
    for (std::size_t s = 0; s < model_.num_signals_; ++s) Fill(model_.series_->signals[s][row], &input_[s]);
  }

  /// Classical Runge-Kutta from `row` to the next.
  void Advance(std::size_t row) {
    constexpr std::array<double, 4> kPart{0.0, 0.5, 0.5, 1.0}, kWeight{1.0, 2.0, 2.0, 1.0};
    const std::size_t num_states = model_.num_states_;
    Lanes* const state = State();
    Lanes* const past = input_.data() + (model_.num_inputs_ - model_.num_past_);
    const double h = model_.series_->dt / model_.substeps_;
    const std::vector<std::size_t>& runs = model_.series_->runs;
    const auto begins = [&](std::size_t k) {
      return k == model_.num_rows() || std::binary_search(runs.begin(), runs.end(), k);
    };
    const bool has_earlier = row > 0 && !begins(row), has_later = !begins(row + 2);
    for (int i = 0; i < model_.substeps_; ++i) {
      std::copy_n(state, num_states, origin_.begin());
      std::fill(sum_.begin(), sum_.end(), Lanes{});
      for (std::size_t stage = 0; stage < kPart.size(); ++stage) {
        const double part = (i + kPart[stage]) / model_.substeps_;
        for (const std::size_t s : model_.rate_reads_) {
          const double* const value = &model_.series_->signals[s][row];
          Fill(ValueBetween(model_.between_[s], has_earlier ? value - 1 : nullptr, value[0], value[1],
                            has_later ? value + 2 : nullptr, part),
               &input_[s]);
        }
        for (std::size_t p = 0; p < model_.num_past_; ++p)
          for (std::size_t l = 0; l < kLanes; ++l)
            past[p][l] = before_[p][l] + (model_.past_held_[p] ? 0.0 : part) * (after_[p][l] - before_[p][l]);
        if (stage > 0) AddScaled(num_states, origin_.data(), kPart[stage] * h, rate_.data(), state);
        const double t = model_.series_->t[row] + part * model_.series_->dt;
        model_.rate_.Evaluate(1, input_.data(), 1, &t, &rate_run_, rate_.data());
        AddScaled(num_states, sum_.data(), kWeight[stage], rate_.data(), sum_.data());
      }
      AddScaled(num_states, origin_.data(), h / 6.0, sum_.data(), state);
    }
  }

  const TrajectoryModel& model_;
  const std::vector<Lanes>* const offset_;
  std::vector<Lanes> input_, before_, after_, origin_, rate_, sum_;
  LaneRun rate_run_, past_run_, start_run_;
};

template <class See>
void TrajectoryModel::Run(const Eigen::MatrixXd& thetas, Eigen::Index first, Eigen::Index count,
                          const std::vector<Lanes>* offset, const std::vector<Eigen::Index>* only, See see) const {
  std::vector<Lanes> fixed(num_inputs_);
  for (std::size_t d = 0; d < parameters_.size(); ++d)
    for (std::size_t l = 0; l < kLanes; ++l)  // what is not asked for repeats the last
      fixed[num_signals_ + d][l] =
          thetas(static_cast<Eigen::Index>(d), first + std::min(static_cast<Eigen::Index>(l), count - 1));
  const bool sequential = num_states_ > 0 || law_.has_memory();
  if (sequential) only = nullptr;
  Walk walk(*this, fixed, offset);
  LaneRun law_run = law_.Begin(fixed.data(), series_->dt);
  const std::size_t first_column = first_state_ + num_states_;
  std::vector<Lanes> input(num_inputs_ * kTile);
  std::array<Lanes, kTile> law{};
  std::array<std::size_t, kTile> row{};
  std::array<double, kTile> t{};
  const std::size_t size = only != nullptr ? only->size() : num_rows();
  std::size_t run = 0;
  for (std::size_t k = 0; k < size;) {
    const bool begins = run < series_->runs.size() && series_->runs[run] == k;
    std::size_t end = std::min(k + kTile, size);
    if (sequential && begins) {
      law_run.Clear();
      ++run;
    }
    if (sequential && run < series_->runs.size()) end = std::min(end, series_->runs[run]);
    const std::size_t samples = end - k;
    for (std::size_t r = 0; r < samples; ++r) {
      const std::size_t n = only != nullptr ? static_cast<std::size_t>((*only)[k + r]) : k + r;
      row[r] = n;
      t[r] = series_->t[n];
      for (const std::size_t s : law_reads_) Fill(series_->signals[s][n], &input[s * kTile + r]);
      for (std::size_t c = 0; c < columns_.size(); ++c) Fill(columns_[c][n], &input[(first_column + c) * kTile + r]);
      if (num_states_ == 0) continue;
      walk.To(n, begins && r == 0);
      for (std::size_t s = 0; s < num_states_; ++s) input[(first_state_ + s) * kTile + r] = walk.State()[s];
    }
    law_.Evaluate(samples, input.data(), kTile, t.data(), &law_run, law.data());
    for (std::size_t r = 0; r < samples; ++r)
      see(static_cast<Eigen::Index>(row[r]), law[r],
          [&](std::size_t s) -> const Lanes& { return input[(first_state_ + s) * kTile + r]; });
    k = end;
  }
}

void TrajectoryModel::Predict(const Eigen::MatrixXd& thetas, Eigen::MatrixXd* predictions,
                              const std::vector<Eigen::Index>* only) const {
  constexpr auto kWidth = static_cast<Eigen::Index>(kLanes);
  predictions->resize(static_cast<Eigen::Index>(num_rows()), thetas.cols());
  if (only != nullptr) predictions->setZero();
  for (Eigen::Index first = 0; first < thetas.cols(); first += kWidth) {
    const Eigen::Index count = std::min(kWidth, thetas.cols() - first);
    Run(thetas, first, count, nullptr, only, [&](Eigen::Index n, const Lanes& law, const auto&) {
      for (Eigen::Index c = 0; c < count; ++c) (*predictions)(n, first + c) = law[static_cast<std::size_t>(c)];
    });
  }
  for (Eigen::Index c = 0; c < thetas.cols(); ++c)
    if (!predictions->col(c).allFinite()) (*predictions)(0, c) = std::numeric_limits<double>::quiet_NaN();
}

bool TrajectoryModel::PredictOne(const Eigen::VectorXd& theta, Eigen::VectorXd* prediction) const {
  Eigen::MatrixXd predictions;
  Predict(theta, &predictions);
  *prediction = predictions.col(0);
  return std::isfinite((*prediction)[0]);
}

Eigen::MatrixXd TrajectoryModel::States(const Eigen::VectorXd& theta) const {
  Eigen::MatrixXd states(static_cast<Eigen::Index>(num_rows()), static_cast<Eigen::Index>(num_states_));
  Run(theta, 0, 1, nullptr, nullptr, [&](Eigen::Index n, const Lanes&, const auto& state) {
    for (std::size_t s = 0; s < num_states_; ++s) states(n, static_cast<Eigen::Index>(s)) = state(s)[0];
  });
  return states;
}

Eigen::Index TrajectoryModel::RowsToForget(const Eigen::VectorXd& theta, double share) const {
  // Lane 0 as it is, lane s + 1 with another start of state s.
  std::vector<Lanes> offset(num_states_, Lanes{});
  const Eigen::MatrixXd states = num_states_ > 0 ? States(theta) : Eigen::MatrixXd();
  const PlantDescription& described = plant_->description();
  const bool several =
      std::count_if(described.states.begin(), described.states.end(),
                    [&](const StateDescription& state) { return state.start == described.output; }) > 1;
  bool any = false;
  for (std::size_t s = 0; s < num_states_; ++s) {
    const bool guessed = several && described.states[s].start == described.output;
    if (!guessed && !plant_->graph().IsNumber(plant_->states()[s].start)) continue;
    const double rms =
        std::sqrt(states.col(static_cast<Eigen::Index>(s)).squaredNorm() / static_cast<double>(num_rows()));
    offset[s][s + 1] = rms;
    any = any || rms > 0.0;
  }
  if (!any) return 0;
  const std::size_t length = series_->runs.size() > 1 ? series_->runs[1] : num_rows();
  std::vector<double> change(length, 0.0);
  Run(theta, 0, 1, &offset, nullptr, [&](Eigen::Index n, const Lanes& law, const auto&) {
    if (static_cast<std::size_t>(n) >= length) return;
    for (std::size_t s = 0; s < num_states_; ++s)
      change[static_cast<std::size_t>(n)] =
          std::max(change[static_cast<std::size_t>(n)], std::fabs(law[s + 1] - law[0]));
  });
  const double most = *std::max_element(change.begin(), change.end());
  std::size_t rows = length;
  while (rows > 0 && !(change[rows - 1] > share * most)) --rows;
  return static_cast<Eigen::Index>(rows);
}

Eigen::MatrixXd TrajectoryModel::Around(const Eigen::VectorXd& theta) const {
  constexpr double kStep = 1e-5;
  const Eigen::VectorXd spread = Spread(), lower = Lower(), upper = Upper();
  const Eigen::Index size = num_parameters();
  Eigen::MatrixXd thetas = theta.replicate(1, 1 + 2 * size);
  for (Eigen::Index d = 0; d < size; ++d) {
    thetas(d, 1 + d) = std::min(theta[d] + kStep * spread[d], upper[d]);
    thetas(d, 1 + size + d) = std::max(theta[d] - kStep * spread[d], lower[d]);
  }
  return thetas;
}

bool TrajectoryModel::LineariseFrom(const Eigen::MatrixXd& around, const Eigen::Ref<const Eigen::MatrixXd>& predictions,
                                    Eigen::VectorXd* prediction, Eigen::MatrixXd* jacobian) {
  const Eigen::Index size = around.rows();
  if (!predictions.row(0).allFinite()) return false;
  *prediction = predictions.col(0);
  jacobian->resize(prediction->size(), size);
  for (Eigen::Index d = 0; d < size; ++d) {
    const double width = around(d, 1 + d) - around(d, 1 + size + d);
    if (!(width > 0.0)) return false;
    jacobian->col(d) = (predictions.col(1 + d) - predictions.col(1 + size + d)) / width;
  }
  return true;
}

bool TrajectoryModel::Linearise(const Eigen::VectorXd& theta, Eigen::VectorXd* prediction, Eigen::MatrixXd* jacobian,
                                const std::vector<Eigen::Index>* only) const {
  const Eigen::MatrixXd thetas = Around(theta);
  Eigen::MatrixXd predictions;
  Predict(thetas, &predictions, only);
  return LineariseFrom(thetas, predictions, prediction, jacobian);
}

}  // namespace armcmc::identify
