#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "armcmc/identify/trajectory_model.hpp"
#include "armcmc/ladder/climb.hpp"

namespace armcmc::ladder {

inline constexpr double kDecidingNats = 10.0;

/// What a motion would tell of tied effects.
struct Prospect {
  double decided = 0.0;             ///< Share of the pairs that would be decided, by the probability of either.
  double least = 0.0;               ///< Nats between the closest pair,
  std::size_t one = 0, two = 0;     ///< which is this one.
  std::size_t pairs = 0, open = 0;  ///< Of all; of those, that would not be decided.
};

/// A tie, and what its effects would make of other inputs.
class Tied {
 public:
  /// @param rung  Outlives this; the three best of it are compared.
  explicit Tied(const Rung& rung);

  /// Empty where signals that do not move by themselves are not read; else what the laws read that cannot be made.
  [[nodiscard]] std::string NotMade() const;

  /// By one step of the rivals, from how they were fitted; less certain than Refitted.
  /// @param series  Its output is made here. @return nothing where a law is not finite there or the output too far out.
  [[nodiscard]] std::optional<Prospect> Expected(const std::shared_ptr<identify::Series>& series) const;
  /// With the rivals refitted.
  [[nodiscard]] std::optional<Prospect> Refitted(const std::shared_ptr<identify::Series>& series) const;

  [[nodiscard]] const Contender& operator[](std::size_t i) const { return *contenders_[i]; }
  [[nodiscard]] double error_sd() const { return error_sd_; }

 private:
  /// Of the base, then of each effect.
  struct Made {
    std::vector<std::shared_ptr<const identify::TrajectoryModel>> models;
    std::vector<Eigen::VectorXd> prediction;
    std::vector<Eigen::MatrixXd> jacobian;
  };
  [[nodiscard]] std::optional<Made> Make(const std::shared_ptr<identify::Series>& series) const;
  /// Squares that the rival leaves of it.
  [[nodiscard]] double Left(const Made& made, std::size_t truth, std::size_t rival) const;
  /// @param left  [truth][model, 0: the base].
  [[nodiscard]] Prospect Judge(const std::vector<std::vector<double>>& left) const;

  std::vector<const Contender*> contenders_;
  std::vector<std::shared_ptr<const Plant>> plants_;  ///< Of the base, then of each effect.
  std::vector<Eigen::VectorXd> theta_;                ///< The same.
  double error_sd_ = 0.0, square_ = 0.0;              ///< square_: f s^2.
  double middle_ = 0.0, reach_ = 0.0;                 ///< Of the recorded output.
};

}  // namespace armcmc::ladder
