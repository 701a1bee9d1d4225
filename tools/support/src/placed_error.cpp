#include "placed_error.hpp"

#include "nearest.hpp"

namespace armcmc::support {

ConfigError PlacedError(StrictTable table, const PlantError& error) {
  std::string what = error.what();
  if (!error.unknown().empty()) what += DidYouMean(error.unknown(), error.known());
  std::string path = error.key();
  for (std::size_t dot = path.find('.'); dot != std::string::npos; dot = path.find('.')) {
    const std::string part = path.substr(0, dot);
    path.erase(0, dot + 1);
    if (const std::size_t bracket = part.find('['); bracket != std::string::npos) {
      table = table.Tables(part.substr(0, bracket)).at(std::stoul(part.substr(bracket + 1)));
    } else {
      // What is wrong with a key of a value that is written without a table is wrong with the value.
      if (!table.IsTable(part)) return table.Error(part, what);
      table = table.Table(part);
    }
  }
  return table.ErrorInText(path, error.column(), what);
}

}  // namespace armcmc::support
