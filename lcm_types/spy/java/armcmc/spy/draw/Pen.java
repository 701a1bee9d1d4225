package armcmc.spy.draw;

import java.awt.Color;
import java.awt.Font;
import java.awt.FontMetrics;
import java.awt.Graphics2D;
import java.awt.Rectangle;
import java.awt.RenderingHints;
import java.awt.geom.RoundRectangle2D;

/** Text, boxes and cards. */
final class Pen {
  static final Font SMALL = new Font(Font.SANS_SERIF, Font.PLAIN, 12);
  static final Font NORMAL = new Font(Font.SANS_SERIF, Font.PLAIN, 14);
  static final Font BOLD = new Font(Font.SANS_SERIF, Font.BOLD, 14);
  static final Font TITLE = new Font(Font.SANS_SERIF, Font.BOLD, 17);
  static final Font LARGE = new Font(Font.SANS_SERIF, Font.BOLD, 26);

  final Graphics2D g;

  Pen(Graphics2D g) {
    this.g = g;
    g.setRenderingHint(RenderingHints.KEY_ANTIALIASING, RenderingHints.VALUE_ANTIALIAS_ON);
    g.setRenderingHint(RenderingHints.KEY_TEXT_ANTIALIASING, RenderingHints.VALUE_TEXT_ANTIALIAS_ON);
    g.setRenderingHint(RenderingHints.KEY_STROKE_CONTROL, RenderingHints.VALUE_STROKE_PURE);
  }

  /** @return x where the text ends */
  int left(String text, Font font, Color color, int x, int baseline) {
    g.setFont(font);
    g.setColor(color);
    g.drawString(text, x, baseline);
    return x + width(text, font);
  }

  void right(String text, Font font, Color color, int x, int baseline) {
    left(text, font, color, x - width(text, font), baseline);
  }

  void centre(String text, Font font, Color color, int x, int baseline) {
    left(text, font, color, x - width(text, font) / 2, baseline);
  }

  int width(String text, Font font) {
    FontMetrics metrics = g.getFontMetrics(font);
    return metrics.stringWidth(text);
  }

  /** The text, cut with an ellipsis where it is too wide. */
  String fit(String text, Font font, int width) {
    if (width(text, font) <= width) return text;
    String shorter = text;
    while (!shorter.isEmpty() && width(shorter + "\u2026", font) > width) {
      shorter = shorter.substring(0, shorter.length() - 1);
    }
    return shorter + "\u2026";
  }

  void fill(Color color, int x, int y, int width, int height) {
    g.setColor(color);
    g.fillRect(x, y, width, height);
  }

  /** A white card with a title; @return what is inside below the title. */
  Rectangle card(Rectangle r, String title) {
    RoundRectangle2D shape = new RoundRectangle2D.Double(r.x + 0.5, r.y + 0.5, r.width - 1, r.height - 1, 10, 10);
    g.setColor(Palette.CARD);
    g.fill(shape);
    g.setColor(Palette.BORDER);
    g.setStroke(Palette.THIN);
    g.draw(shape);
    left(fit(title, BOLD, r.width - 28), BOLD, Palette.INK, r.x + 14, r.y + 24);
    return new Rectangle(r.x + 14, r.y + 34, r.width - 28, r.height - 44);
  }

  /** A bar of the whole width with a message that must be seen. */
  void alarm(Rectangle r, Color color, String text) {
    g.setColor(color);
    g.fill(new RoundRectangle2D.Double(r.x, r.y, r.width, r.height, 8, 8));
    left(fit(text, BOLD, r.width - 28), BOLD, Color.WHITE, r.x + 14, r.y + r.height / 2 + 5);
  }
}
