#include "bootstrap.hpp"

#include <algorithm>
#include <cstddef>
#include <map>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include "comparison.hpp"

namespace armcmc::ladder {
namespace {

constexpr int kBootstrap = 400;

/// Bootstrap samples of the short segments, the same at every call.
/// @param see  Called for each sample with the squared errors of the base model and of those in `among`.
template <class See>
void ForEachSample(const Rung& rung, const std::vector<std::size_t>& among, See see) {
  std::mt19937_64 random(400);
  const std::size_t stretches = rung.base.stretches.size();
  std::vector<double> weight, squares(among.size());
  for (int b = 0; b < kBootstrap; ++b) {
    weight.assign(stretches, 0.0);
    for (std::size_t k = 0; k < stretches; ++k) weight[random() % stretches] += 1.0;
    const auto total = [&](const std::vector<double>& of_stretch) {
      return std::inner_product(weight.begin(), weight.end(), of_stretch.begin(), 0.0);
    };
    for (std::size_t k = 0; k < among.size(); ++k) squares[k] = total(rung.contenders[among[k]].trial.stretches);
    see(total(rung.base.stretches), squares);
  }
}

}  // namespace

void Bootstrap(Rung* rung) {
  std::vector<int> gains(rung->contenders.size(), 0);
  std::vector<std::size_t> judged;
  for (std::size_t i = 0; i < rung->contenders.size(); ++i)
    if (rung->contenders[i].trial.judged) judged.push_back(i);
  std::map<std::string, int> wins;
  ForEachSample(*rung, judged, [&](double base, const std::vector<double>& squares) {
    const auto least = std::min_element(squares.begin(), squares.end());
    if (least != squares.end() && *least < base) {
      const auto winner = judged[static_cast<std::size_t>(least - squares.begin())];
      ++wins[rung->contenders[winner].candidate.entry->family];
    }
    for (std::size_t k = 0; k < judged.size(); ++k)
      if (squares[k] < (1.0 - kLeastGain) * base) ++gains[judged[k]];
  });
  for (std::size_t i = 0; i < rung->contenders.size(); ++i) {
    Contender& c = rung->contenders[i];
    c.gain_share = static_cast<double>(gains[i]) / kBootstrap;
    c.win_share = static_cast<double>(wins[c.candidate.entry->family]) / kBootstrap;
  }
}

double ShareOfFirst(const Rung& rung) {
  int wins = 0;
  ForEachSample(rung, rung.named, [&](double, const std::vector<double>& squares) {
    if (std::min_element(squares.begin(), squares.end()) == squares.begin()) ++wins;
  });
  return static_cast<double>(wins) / kBootstrap;
}

double WinShare(const Rung& rung) {
  double share = 0.0;
  for (const std::size_t i : rung.named) share += rung.contenders[i].win_share;
  return share;
}

}  // namespace armcmc::ladder
