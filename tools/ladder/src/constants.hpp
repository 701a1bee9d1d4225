#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "armcmc/ladder/climb.hpp"
#include "rival.hpp"

namespace armcmc::ladder {

/// What a plant file states as numbers may be off by a few percent, and then acts like an effect: a room that is half a
/// degree colder like the offset of a thermometer. Several such errors together act like what none of them does.
class Constants {
 public:
  /// All outlive it.
  /// @param own  The plant as it came, without constants that effects brought.
  Constants(const PlantDescription& own, const std::shared_ptr<const Plant>& plant, const Dataset& data,
            const View& view, const Trial& base, const DataScales& scales);

  /// A constant, or all of them together, that explain as much as an effect with other values, up to 5 % away. Fitted
  /// when they are first asked for.
  [[nodiscard]] std::optional<Rival> RivalOf(const Contender& c);

 private:
  struct Other {
    std::vector<ConstantDescription> constants;  ///< In the order of the last parameters of the model.
    Contender contender{};
    bool left_out = false;  ///< Whether `contender` is known on data left out.
  };
  void FitRivals();
  /// Fits from the values `own` of the plant's own parameters, and keeps what is better than before.
  void FitOne(const Eigen::VectorXd& own, Other* other) const;
  void FitFrom(const Eigen::VectorXd& own);
  /// "ps were 6.8e+06 instead of 7e+06 and K were 31 instead of 30"
  [[nodiscard]] static std::string AsIf(const Other& other);

  const PlantDescription& own_;
  const std::shared_ptr<const Plant>& plant_;
  const Dataset& data_;
  const View& view_;
  const Trial& base_;
  const DataScales& scales_;
  std::vector<EffectEntry> entries_;
  std::optional<std::vector<Other>> fitted_;
  std::vector<Eigen::VectorXd> from_;  ///< Own parameters of effects from whose minimum they were fitted.
};

}  // namespace armcmc::ladder
