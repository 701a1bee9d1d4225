package armcmc.spy.draw;

import armcmc.spy.model.Series;

/** An interval that grows around what it has to show. */
final class Range {
  private double lo = Double.POSITIVE_INFINITY;
  private double hi = Double.NEGATIVE_INFINITY;

  void include(double value) {
    if (!Double.isFinite(value)) return;
    lo = Math.min(lo, value);
    hi = Math.max(hi, value);
  }

  /** All but the rarest values of a series, so that the wide interval of the first second does not flatten the rest. */
  void includeMost(Series series, double share, double since) { include(series.quantile(share, since)); }

  /** With a margin, and with ends that stay put while the values move a little. */
  Axis axis() {
    if (!(hi >= lo)) return Axis.linear(0, 1);
    double size = Math.max(hi - lo, 1e-3 * Math.max(Math.abs(lo), Math.abs(hi)));
    if (size == 0) size = 1;
    double step = Axis.niceStep(size / 4);
    double margin = 0.06 * size;
    return Axis.linear(Math.floor((lo - margin) / step * 2) * step / 2, Math.ceil((hi + margin) / step * 2) * step / 2);
  }
}
