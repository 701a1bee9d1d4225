package armcmc.spy.draw;

import java.awt.BasicStroke;
import java.awt.Color;
import java.awt.Stroke;

/** Colours that colour-blind people can tell apart (Okabe and Ito), and strokes. A colour never stands without a word. */
final class Palette {
  static final Color BACK = new Color(0xEEF2F6);
  static final Color CARD = Color.WHITE;
  static final Color BORDER = new Color(0xD5DDE5);
  static final Color GRID = new Color(0xE6EBF0);
  static final Color INK = new Color(0x1B2733);
  static final Color MUTED = new Color(0x566573);
  static final Color ESTIMATE = new Color(0x0072B2);
  static final Color BAND_50 = alpha(ESTIMATE, 105);
  static final Color BAND_95 = alpha(ESTIMATE, 45);
  static final Color TRUTH = new Color(0xD55E00);
  static final Color MEASURED = new Color(0x8A96A3);
  static final Color COLLECT = new Color(0x56B4E9);
  static final Color ADJUST = new Color(0x0072B2);
  static final Color EXECUTE = new Color(0x009E73);
  static final Color GOOD = new Color(0x00795A);
  static final Color WARNING = new Color(0x8A5A00);
  static final Color BAD = new Color(0xB71C1C);

  static final Stroke THIN = new BasicStroke(1f);
  static final Stroke LINE = new BasicStroke(1.8f, BasicStroke.CAP_ROUND, BasicStroke.JOIN_ROUND);
  static final Stroke BOLD = new BasicStroke(2.4f, BasicStroke.CAP_ROUND, BasicStroke.JOIN_ROUND);
  static final Stroke DASHED =
      new BasicStroke(2f, BasicStroke.CAP_BUTT, BasicStroke.JOIN_ROUND, 1f, new float[] {7f, 5f}, 0f);

  private Palette() {}

  static Color alpha(Color c, int alpha) { return new Color(c.getRed(), c.getGreen(), c.getBlue(), alpha); }
}
