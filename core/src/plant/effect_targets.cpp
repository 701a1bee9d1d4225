#include "effect_targets.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <map>

#include "effect_reading.hpp"
#include "effect_text.hpp"

namespace armcmc {
namespace {

// Parts of names of lets: the effect's prefix stands before them, the number of the mode after them.
constexpr std::string_view kAsRead = "target_as_read_", kAsFelt = "target_as_felt_", kSize = "target_size_";
constexpr std::string_view kReference = "target_at_";  // the signal stands after it

std::string Joined(std::initializer_list<std::string_view> parts) {
  std::string text;
  for (const std::string_view part : parts) text += part;
  return text;
}

/// Null where the plant has no such let.
template <class PlantType>
auto* LetCalled(PlantType& plant, const std::string& name) {
  const auto let = std::find_if(plant.lets.begin(), plant.lets.end(), [&](const auto& l) { return l.name == name; });
  return let == plant.lets.end() ? nullptr : &*let;
}
const LetDescription* LetThatEndsWith(const PlantDescription& plant, const std::string& end) {
  for (const LetDescription& let : plant.lets)
    if (let.name.ends_with(end)) return &let;
  return nullptr;
}

/// Name of the constant that stands for a signal; added where it is not there. Drives are at their most, and so is what
/// goes to and fro: at rest a valve has no flow, and a rate is next to none in the mean, that two targets could be
/// compared by.
std::string ReferenceTo(const SignalDescription& signal, const DataScales& scales, PlantDescription* plant) {
  std::string name = Joined({kReference, signal.name});
  const auto is_it = [&name](const ConstantDescription& c) { return c.name == name; };
  if (std::any_of(plant->constants.begin(), plant->constants.end(), is_it)) return name;
  const auto found = scales.quantity.find(signal.name);
  const QuantityScale scale = found == scales.quantity.end() ? QuantityScale{} : found->second;
  const double most = std::fabs(scale.high) < std::fabs(scale.low) ? scale.low : scale.high;
  const bool to_and_fro = signal.role == "drive" || (scale.low < 0.0 && std::fabs(scale.mean) < scale.rms);
  plant->constants.push_back({name, ShortNumber(to_and_fro ? most : scale.mean), signal.unit});
  return name;
}

/// Empty where the text depends on time.
std::string AtReferencePoint(std::string text, const DataScales& scales, PlantDescription* plant) {
  for (const StateDescription& state : plant->states)
    if (Mentions(text, state.name)) text = WithoutLets(*plant, Inserted(text, {{state.name, state.start}}));
  for (const std::string& name : NamesIn(text))
    if (name == "t" || name == "integral" || name == "elapsed") return {};
  std::map<std::string, std::string> by;
  for (const SignalDescription& signal : plant->signals)
    if (Mentions(text, signal.name)) by[signal.name] = ReferenceTo(signal, scales, plant);
  return WithNames(text, by);
}

}  // namespace

bool IsTargetAsRead(std::string_view let) { return let.find(kAsRead) != std::string_view::npos; }

bool IsTargetReference(std::string_view constant) { return constant.starts_with(kReference); }

void SplitTargets(const std::string& prefix, const std::string& symbol, PlantDescription* plant) {
  for (std::size_t m = 0; m < plant->modes.size(); ++m) {
    ModeDescription& mode = plant->modes[m];
    if (mode.passive || mode.target.empty()) continue;
    const std::string target = WithoutLets(*plant, mode.target), number = std::to_string(m + 1);
    if (!Mentions(target, symbol)) continue;
    mode.target = target;
    if (LetThatEndsWith(*plant, Joined({kAsRead, number})) != nullptr) continue;
    const std::string read = Joined({prefix, kAsRead, number}), felt = Joined({prefix, kAsFelt, number}),
                      size = Joined({prefix, kSize, number});
    plant->lets.push_back({read, target});
    plant->lets.push_back({felt, target});
    plant->lets.push_back({size, "1"});
    mode.law = Joined({read, " - (", felt, " - ", Bracketed(mode.law), ")*", size});
  }
}

void SetTargetSizes(const DataScales& scales, PlantDescription* plant) {
  for (std::size_t m = 0; m < plant->modes.size(); ++m) {
    const std::string number = std::to_string(m + 1);
    const LetDescription* as_read = LetThatEndsWith(*plant, Joined({kAsRead, number}));
    if (as_read == nullptr) continue;
    const std::string_view prefix =
        std::string_view(as_read->name).substr(0, as_read->name.size() - kAsRead.size() - number.size());
    const LetDescription* as_felt = LetCalled(*plant, Joined({prefix, kAsFelt, number}));
    LetDescription* size = LetCalled(*plant, Joined({prefix, kSize, number}));
    if (as_felt == nullptr || size == nullptr) continue;  // a let of the plant's own
    const std::string read = AtReferencePoint(WithoutLets(*plant, as_read->text), scales, plant);
    const std::string felt = AtReferencePoint(WithoutLets(*plant, as_felt->text), scales, plant);
    size->text = read.empty() || felt.empty() ? "1" : Joined({"if(", read, " == 0, 1, (", read, ")/(", felt, "))"});
  }
}

}  // namespace armcmc
