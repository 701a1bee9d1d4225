#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "armcmc/ladder/climb.hpp"
#include "rival.hpp"

namespace armcmc::ladder {

/// What a plant file states as a number may be off by a few percent, and then acts like an effect: a room that is half
/// a degree colder like the offset of a thermometer.
class Constants {
 public:
  /// All outlive it.
  /// @param own  The plant as it came, without constants that effects brought.
  Constants(const PlantDescription& own, const std::shared_ptr<const Plant>& plant, const Dataset& data,
            const View& view, const Trial& base, const DataScales& scales);

  /// A constant that explains as much as an effect with another value, up to 5 % away. Fitted when it is first asked
  /// for.
  [[nodiscard]] std::optional<Rival> RivalOf(const Contender& c);

 private:
  struct Other {
    std::string name;
    double was, is;
    Contender contender;
  };
  void FitThem();

  const PlantDescription& own_;
  const std::shared_ptr<const Plant>& plant_;
  const Dataset& data_;
  const View& view_;
  const Trial& base_;
  const DataScales& scales_;
  std::vector<EffectEntry> entries_;
  std::optional<std::vector<Other>> fitted_;
};

}  // namespace armcmc::ladder
