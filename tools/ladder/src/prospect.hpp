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

/// Expected evidence of a motion about tied effects.
struct Prospect {
  double decided = 0.0;             ///< Share of the pairs that would be decided, weighted with the probabilities.
  double least = 0.0;               ///< Nats between the closest pair.
  std::size_t one = 0, two = 0;     ///< The closest pair.
  std::size_t pairs = 0, open = 0;  ///< Number of pairs; number that would remain undecided.
};

/// Tied effects, and their predictions for other inputs.
class Tied {
 public:
  /// @param rung  Outlives this; the three best of it are compared.
  explicit Tied(const Rung& rung);

  /// The signals read by the laws that a motion cannot prescribe, in words; empty if there are none.
  [[nodiscard]] std::string NotMade() const;

  /// Evidence with the rivals refitted by one Gauss-Newton step from their fits; less accurate than Refitted().
  /// @param series  Inputs; its output is simulated here.
  /// @return empty if a law is not finite there, or if the output leaves twice its recorded range.
  [[nodiscard]] std::optional<Prospect> Expected(const std::shared_ptr<identify::Series>& series) const;
  /// Evidence with the rivals refitted.
  [[nodiscard]] std::optional<Prospect> Refitted(const std::shared_ptr<identify::Series>& series) const;

  [[nodiscard]] const Contender& operator[](std::size_t i) const { return *contenders_[i]; }
  [[nodiscard]] double error_sd() const { return error_sd_; }

 private:
  /// Models, predictions and Jacobians: the base model, then one for each effect.
  struct Made {
    std::vector<std::shared_ptr<const identify::TrajectoryModel>> models;
    std::vector<Eigen::VectorXd> prediction;
    std::vector<Eigen::MatrixXd> jacobian;
  };
  [[nodiscard]] std::optional<Made> Make(const std::shared_ptr<identify::Series>& series) const;
  /// Squared error of the rival, refitted to the simulated output.
  [[nodiscard]] double Left(const Made& made, std::size_t truth, std::size_t rival) const;
  /// @param left  [truth][model, 0: the base].
  [[nodiscard]] Prospect Judge(const std::vector<std::vector<double>>& left) const;

  std::vector<const Contender*> contenders_;
  std::vector<std::shared_ptr<const Plant>> plants_;  ///< Base model, then one for each effect.
  std::vector<Eigen::VectorXd> theta_;                ///< Their fitted parameters.
  double error_sd_ = 0.0, square_ = 0.0;              ///< square_: f s^2.
  double middle_ = 0.0, reach_ = 0.0;                 ///< Centre and half range of the recorded output.
};

}  // namespace armcmc::ladder
