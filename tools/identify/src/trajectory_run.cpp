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

/// States of candidates from sample to sample, and what their rates remember. Of twice as many side by side, an
/// operation of one does not wait for that of the other: arrays are [..][half] then.
template <std::size_t kHalves>
class TrajectoryModel::Walk {
 public:
  /// @param fixed   [input][half] Those that vary by candidate.
  /// @param offset  [state] Added to the starts; may be null.
  Walk(const TrajectoryModel& model, const std::vector<Lanes>& fixed, const std::vector<Lanes>* offset)
      : model_(model),
        offset_(offset),
        input_(fixed),
        before_(model.num_past_ * kHalves),
        after_(model.num_past_ * kHalves),
        origin_(model.num_states_ * kHalves),
        rate_(model.num_states_ * kHalves),
        sum_(model.num_states_ * kHalves),
        rate_run_(kHalves > 1 ? model.rate_.BeginPair(fixed.data(), model.series_->dt)
                              : model.rate_.Begin(fixed.data(), model.series_->dt)) {
    std::vector<Lanes> half(model.num_inputs_);
    for (std::size_t h = 0; h < kHalves; ++h) {
      for (std::size_t i = 0; i < half.size(); ++i) half[i] = fixed[i * kHalves + h];
      past_run_[h] = model.past_.Begin(half.data(), model.series_->dt);
      start_run_[h] = model.start_.Begin(half.data(), model.series_->dt);
    }
  }

  /// To the row, which is the first of a run or follows the last one.
  void To(std::size_t row, bool begins) {
    SetSignals(row);
    const double* const t = &model_.series_->t[row];
    for (std::size_t h = 0; h < kHalves; ++h) {
      if (begins) past_run_[h].Clear();
      if (model_.num_past_ > 0)
        model_.past_.Evaluate(1, input_.data() + h, kHalves, t, &past_run_[h], after_.data() + h);
      if (!begins) continue;
      model_.start_.Evaluate(1, input_.data() + h, kHalves, t, &start_run_[h], States() + h);
      for (std::size_t s = 0; offset_ != nullptr && s < model_.num_states_; ++s)
        for (std::size_t l = 0; l < kLanes; ++l) States()[s * kHalves + h][l] += (*offset_)[s][l];
    }
    if (!begins) Advance(row - 1);
    std::swap(before_, after_);
  }
  [[nodiscard]] const Lanes& State(std::size_t s, std::size_t half) { return States()[s * kHalves + half]; }

 private:
  [[nodiscard]] Lanes* States() { return input_.data() + model_.first_state_ * kHalves; }
  void SetSignal(std::size_t s, double value) {
    for (std::size_t h = 0; h < kHalves; ++h) Fill(value, &input_[s * kHalves + h]);
  }
  void SetSignals(std::size_t row) {
    for (std::size_t s = 0; s < model_.num_signals_; ++s) SetSignal(s, model_.series_->signals[s][row]);
  }
  void SetRates(double t) {
    if constexpr (kHalves > 1)
      model_.rate_.EvaluatePair(input_.data(), t, &rate_run_, rate_.data());
    else
      model_.rate_.Evaluate(1, input_.data(), 1, &t, &rate_run_, rate_.data());
  }

  /// Classical Runge-Kutta from `row` to the next.
  void Advance(std::size_t row) {
    constexpr std::array<double, 4> kPart{0.0, 0.5, 0.5, 1.0}, kWeight{1.0, 2.0, 2.0, 1.0};
    const std::size_t size = model_.num_states_ * kHalves;
    Lanes* const state = States();
    Lanes* const past = input_.data() + (model_.num_inputs_ - model_.num_past_) * kHalves;
    const double h = model_.series_->dt / model_.substeps_;
    const std::vector<std::size_t>& runs = model_.series_->runs;
    const auto begins = [&](std::size_t k) {
      return k == model_.num_rows() || std::binary_search(runs.begin(), runs.end(), k);
    };
    const bool has_earlier = row > 0 && !begins(row), has_later = !begins(row + 2);
    for (int i = 0; i < model_.substeps_; ++i) {
      std::copy_n(state, size, origin_.begin());
      std::fill(sum_.begin(), sum_.end(), Lanes{});
      for (std::size_t stage = 0; stage < kPart.size(); ++stage) {
        const double part = (i + kPart[stage]) / model_.substeps_;
        for (const std::size_t s : model_.rate_reads_) {
          const double* const value = &model_.series_->signals[s][row];
          SetSignal(s, ValueBetween(model_.between_[s], has_earlier ? value - 1 : nullptr, value[0], value[1],
                                    has_later ? value + 2 : nullptr, part));
        }
        for (std::size_t p = 0; p < model_.num_past_; ++p)
          for (std::size_t k = p * kHalves; k < (p + 1) * kHalves; ++k)
            for (std::size_t l = 0; l < kLanes; ++l)
              past[k][l] = before_[k][l] + (model_.past_held_[p] ? 0.0 : part) * (after_[k][l] - before_[k][l]);
        if (stage > 0) AddScaled(size, origin_.data(), kPart[stage] * h, rate_.data(), state);
        SetRates(model_.series_->t[row] + part * model_.series_->dt);
        AddScaled(size, sum_.data(), kWeight[stage], rate_.data(), sum_.data());
      }
      AddScaled(size, origin_.data(), h / 6.0, sum_.data(), state);
    }
  }

  const TrajectoryModel& model_;
  const std::vector<Lanes>* const offset_;
  std::vector<Lanes> input_, before_, after_, origin_, rate_, sum_;
  LaneRun rate_run_;
  std::array<LaneRun, kHalves> past_run_, start_run_;
};

template <std::size_t kHalves, class See>
void TrajectoryModel::Run(const Eigen::MatrixXd& thetas, Eigen::Index first, Eigen::Index count,
                          const std::vector<Lanes>* offset, const std::vector<Eigen::Index>* only, See see) const {
  std::vector<Lanes> fixed(num_inputs_ * kHalves);
  for (std::size_t d = 0; d < parameters_.size(); ++d)
    for (std::size_t h = 0; h < kHalves; ++h)
      for (std::size_t l = 0; l < kLanes; ++l)  // what is not asked for repeats the last
        fixed[(num_signals_ + d) * kHalves + h][l] = thetas(
            static_cast<Eigen::Index>(d), first + std::min(static_cast<Eigen::Index>(h * kLanes + l), count - 1));
  const bool sequential = num_states_ > 0 || law_.has_memory();
  if (sequential) only = nullptr;
  Walk<kHalves> walk(*this, fixed, offset);
  std::array<LaneRun, kHalves> law_run;
  std::vector<Lanes> input(num_inputs_ * kTile * kHalves);  // [half][input][row of the tile]
  const auto of_half = [&](std::size_t h) { return input.data() + h * num_inputs_ * kTile; };
  for (std::size_t h = 0; h < kHalves; ++h) {
    for (std::size_t i = 0; i < num_inputs_; ++i) of_half(h)[i] = fixed[i * kHalves + h];
    law_run[h] = law_.Begin(of_half(h), series_->dt);
  }
  const std::size_t first_column = first_state_ + num_states_;
  std::array<Lanes, kTile> law{};
  std::array<std::size_t, kTile> row{};
  std::array<double, kTile> t{};
  const std::size_t size = only != nullptr ? only->size() : num_rows();
  std::size_t run = 0;
  for (std::size_t k = 0; k < size;) {
    const bool begins = run < series_->runs.size() && series_->runs[run] == k;
    std::size_t end = std::min(k + kTile, size);
    if (sequential && begins) {
      for (LaneRun& of_law : law_run) of_law.Clear();
      ++run;
    }
    if (sequential && run < series_->runs.size()) end = std::min(end, series_->runs[run]);
    const std::size_t samples = end - k;
    for (std::size_t r = 0; r < samples; ++r) {
      const std::size_t n = only != nullptr ? static_cast<std::size_t>((*only)[k + r]) : k + r;
      row[r] = n;
      t[r] = series_->t[n];
      if (num_states_ > 0) walk.To(n, begins && r == 0);
      for (std::size_t h = 0; h < kHalves; ++h) {
        Lanes* const its = of_half(h);
        for (const std::size_t s : law_reads_) Fill(series_->signals[s][n], &its[s * kTile + r]);
        for (std::size_t c = 0; c < columns_.size(); ++c) Fill(columns_[c][n], &its[(first_column + c) * kTile + r]);
        for (std::size_t s = 0; s < num_states_; ++s) its[(first_state_ + s) * kTile + r] = walk.State(s, h);
      }
    }
    for (std::size_t h = 0; h < kHalves; ++h) {
      law_.Evaluate(samples, of_half(h), kTile, t.data(), &law_run[h], law.data());
      for (std::size_t r = 0; r < samples; ++r)
        see(static_cast<Eigen::Index>(row[r]), h, law[r],
            [&](std::size_t s) -> const Lanes& { return of_half(h)[(first_state_ + s) * kTile + r]; });
    }
    k = end;
  }
}

void TrajectoryModel::Predict(const Eigen::MatrixXd& thetas, Eigen::MatrixXd* predictions,
                              const std::vector<Eigen::Index>* only) const {
  constexpr auto kWidth = static_cast<Eigen::Index>(kLanes);
  predictions->resize(static_cast<Eigen::Index>(num_rows()), thetas.cols());
  if (only != nullptr) predictions->setZero();
  const auto run = [&]<std::size_t kHalves>(Eigen::Index first) {
    const Eigen::Index count = std::min(static_cast<Eigen::Index>(kHalves) * kWidth, thetas.cols() - first);
    Run<kHalves>(thetas, first, count, nullptr, only,
                 [&](Eigen::Index n, std::size_t half, const Lanes& law, const auto&) {
                   const Eigen::Index begin = static_cast<Eigen::Index>(half) * kWidth;
                   for (Eigen::Index c = begin; c < std::min(begin + kWidth, count); ++c)
                     (*predictions)(n, first + c) = law[static_cast<std::size_t>(c - begin)];
                 });
    return first + count;
  };
  for (Eigen::Index first = 0; first < thetas.cols();)
    first = num_states_ > 0 && thetas.cols() - first > kWidth ? run.template operator()<2>(first)
                                                              : run.template operator()<1>(first);
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
  Run<1>(theta, 0, 1, nullptr, nullptr, [&](Eigen::Index n, std::size_t, const Lanes&, const auto& state) {
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
  Run<1>(theta, 0, 1, &offset, nullptr, [&](Eigen::Index n, std::size_t, const Lanes& law, const auto&) {
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
