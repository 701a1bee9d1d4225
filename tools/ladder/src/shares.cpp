#include "shares.hpp"

#include <algorithm>
#include <limits>
#include <set>

namespace armcmc::ladder {
namespace {

struct Family {
  double share = 0.0;
  std::set<std::string> named;
  std::string best;
  double least = std::numeric_limits<double>::infinity();
};

}  // namespace

std::map<std::string, double> SharesOf(const Rung& rung) {
  std::map<std::string, Family> families;
  std::map<std::string, double> shares;
  for (std::size_t i = 0; i < rung.contenders.size(); ++i) {
    const Contender& c = rung.contenders[i];
    if (!c.trial.judged) continue;
    const EffectEntry& entry = *c.candidate.entry;
    shares[entry.name] = 0.0;
    Family& family = families[entry.family];
    family.share = c.win_share;
    if (std::find(rung.named.begin(), rung.named.end(), i) != rung.named.end()) family.named.insert(entry.name);
    if (c.alone.folds < family.least) {
      family.least = c.alone.folds;
      family.best = entry.name;
    }
  }
  if (rung.named.empty()) return shares;
  for (const auto& [name, family] : families) {
    if (family.named.empty()) shares[family.best] = family.share;
    for (const std::string& member : family.named)
      shares[member] = family.share / static_cast<double>(family.named.size());
  }
  return shares;
}

}  // namespace armcmc::ladder
