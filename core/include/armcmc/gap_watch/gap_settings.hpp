#pragma once

namespace armcmc {

/// The watch for a persistent gap between model and data; see gap_watch.hpp.
struct GapWatchSettings {
  /// Whether the watch runs: [gap_watch] enabled.
  bool enabled = true;
  /// Bound on the probability of a false alarm in one hour of data, in (0, 1). Over T hours it is at most max(1, T)
  /// times this.
  double false_alarm_rate = 0.01;
  /// Tolerated misfit: its root mean square over the noise scale, [0, 1]. A larger value misses small effects, and is
  /// safer where noise or inputs are not as modelled.
  double tolerance = 0.03;
};

}  // namespace armcmc
