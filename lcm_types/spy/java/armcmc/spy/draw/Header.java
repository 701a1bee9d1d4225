package armcmc.spy.draw;

import armcmc.spy.model.Freshness;
import java.awt.Color;
import java.awt.Rectangle;
import java.util.Locale;

/** The top of a panel: what it is, and whether messages come. */
final class Header {
  static final int HEIGHT = 46;
  private static final int BAR = 32;

  private final Pen pen;
  private final int width;
  private int bottom;

  Header(Pen pen, int width, int height) {
    this.pen = pen;
    this.width = width;
    pen.fill(Palette.BACK, 0, 0, width, height);
  }

  void title(String title, String detail, Freshness freshness) {
    int x = pen.left(title, Pen.TITLE, Palette.INK, 16, 30);
    pen.left(detail, Pen.NORMAL, Palette.MUTED, x + 14, 30);
    String rate = freshness.rate() > 0 ? String.format(Locale.ROOT, "%.1f messages/s", freshness.rate()) : "";
    pen.right(rate, Pen.NORMAL, Palette.MUTED, width - 16, 30);
    bottom = HEIGHT;
  }

  void alarm(Color color, String text) {
    pen.alarm(new Rectangle(12, bottom, width - 24, BAR), color, text);
    bottom += BAR + 6;
  }

  void staleness(Freshness freshness, double now) {
    if (!freshness.any()) alarm(Palette.WARNING, "Waiting for the first message");
    if (freshness.stale(now)) {
      alarm(Palette.WARNING, String.format(Locale.ROOT,
          "No message for %.0f s: is the estimator running? What is shown is old.", freshness.age(now)));
    }
  }

  /** Where the rest begins. */
  int bottom() { return bottom; }
}
