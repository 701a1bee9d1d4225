package armcmc.spy.draw;

import java.util.ArrayList;
import java.util.List;
import java.util.Locale;

/** Values to positions in [0, 1], and the round values between them. */
final class Axis {
  final double lo;
  final double hi;
  final boolean log;

  private Axis(double lo, double hi, boolean log) {
    this.lo = lo;
    this.hi = hi;
    this.log = log;
  }

  static Axis linear(double lo, double hi) { return new Axis(lo, hi, false); }

  /** @throws IllegalArgumentException unless 0 < lo < hi */
  static Axis logarithmic(double lo, double hi) {
    if (!(lo > 0 && hi > lo && hi < Double.POSITIVE_INFINITY)) throw new IllegalArgumentException(lo + " .. " + hi);
    return new Axis(lo, hi, true);
  }

  double at(double value) {
    if (log) return Math.log(Math.max(value, 1e-300) / lo) / Math.log(hi / lo);
    return (value - lo) / (hi - lo);
  }

  double value(double position) {
    return log ? lo * Math.pow(hi / lo, position) : lo + position * (hi - lo);
  }

  /** About n round values. */
  List<Double> ticks(int n) {
    List<Double> ticks = new ArrayList<>();
    if (log) {
      for (double tick = Math.pow(10, Math.ceil(Math.log10(lo) - 1e-9)); tick <= hi * 1.0001; tick *= 10) ticks.add(tick);
      return ticks;
    }
    double step = step(n);
    long first = (long) Math.ceil(lo / step - 1e-9);
    for (long i = first; i * step <= hi + 1e-9 * step && ticks.size() < 50; ++i) ticks.add(i * step);
    return ticks;
  }

  /** A tick in as many digits as it takes to tell it from the next. */
  String text(double tick, int n) {
    if (log) return trim(String.format(Locale.ROOT, "%.6f", tick));
    double step = step(n);
    double size = Math.max(Math.abs(lo), Math.abs(hi));
    if (size >= 1e6 || size < 1e-3) {
      int digits = (int) Math.max(0, Math.floor(Math.log10(Math.max(Math.abs(tick), step))) - Math.floor(Math.log10(step)));
      return Math.abs(tick) < step / 2 ? "0" : String.format(Locale.ROOT, "%." + Math.min(digits, 6) + "e", tick);
    }
    int decimals = (int) Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
    return String.format(Locale.ROOT, "%." + decimals + "f", Math.abs(tick) < step / 2 ? 0.0 : tick);
  }

  /** Distance of about n round values, of two at least: one alone tells no scale. */
  private double step(int n) {
    double step = niceStep((hi - lo) / Math.max(1, n));
    for (int i = 0; i < 3 && Math.floor(hi / step + 1e-9) - Math.ceil(lo / step - 1e-9) < 1; ++i) {
      step = niceStep(step / 2.6);  // 5, 2, 1: the next round value below
    }
    return step;
  }

  /** 1, 2 or 5 times a power of ten, not below. */
  static double niceStep(double least) {
    double power = Math.pow(10, Math.floor(Math.log10(least)));
    for (double factor : new double[] {1, 2, 5}) {
      if (factor * power >= least * (1 - 1e-9)) return factor * power;
    }
    return 10 * power;
  }

  private static String trim(String number) {
    String text = number;
    while (text.endsWith("0")) text = text.substring(0, text.length() - 1);
    return text.endsWith(".") ? text.substring(0, text.length() - 1) : text;
  }
}
