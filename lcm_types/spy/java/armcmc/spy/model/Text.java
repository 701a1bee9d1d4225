package armcmc.spy.model;

import java.nio.charset.StandardCharsets;
import java.util.Locale;

/** Words and numbers as people read them. */
public final class Text {
  private Text() {}

  /** ASCII up to the first zero byte. */
  public static String of(byte[] field) {
    int size = 0;
    while (size < field.length && field[size] != 0) ++size;
    return new String(field, 0, size, StandardCharsets.US_ASCII);
  }

  /** Four significant digits; powers of ten only outside 1e-4 .. 1e6; "-" for what is no number. */
  public static String number(double value) {
    if (Double.isNaN(value)) return "-";
    if (Double.isInfinite(value)) return value > 0 ? "inf" : "-inf";
    double size = Math.abs(value);
    if (size == 0) return "0";
    if (size < 1e-4 || size >= 1e6) return String.format(Locale.ROOT, "%.3e", value);
    int decimals = Math.max(0, 3 - (int) Math.floor(Math.log10(size)));
    return String.format(Locale.ROOT, "%." + decimals + "f", value);
  }

  /** A number with its unit; nothing follows where the unit is empty or "-". */
  public static String quantity(double value, String unit) {
    return number(value) + (unit.isEmpty() || unit.equals("-") ? "" : " " + unit);
  }

  /** A name with its unit in brackets. */
  public static String label(String name, String unit) {
    return unit.isEmpty() || unit.equals("-") ? name : name + " [" + unit + "]";
  }
}
