package armcmc.spy.draw;

import java.awt.Color;
import java.awt.Stroke;
import java.awt.geom.Line2D;

/** What lines, areas and colours mean, in one row. */
final class Legend {
  private static final int GAP = 22;
  private final Pen pen;
  private final int baseline;
  private int x;

  Legend(Pen pen, int x, int baseline) {
    this.pen = pen;
    this.x = x;
    this.baseline = baseline;
  }

  void box(Color color, String text) {
    pen.fill(color, x, baseline - 11, 22, 12);
    word(28, text);
  }

  void line(Color color, Stroke stroke, String text) {
    pen.g.setColor(color);
    pen.g.setStroke(stroke);
    pen.g.draw(new Line2D.Double(x, baseline - 4.5, x + 26, baseline - 4.5));
    word(32, text);
  }

  void map(String text) {
    for (int i = 0; i < 60; ++i) pen.fill(new Color(ColourMap.rgb(i / 59.0)), x + i, baseline - 11, 1, 12);
    word(66, text);
  }

  private void word(int offset, String text) {
    x = pen.left(text, Pen.SMALL, Palette.MUTED, x + offset, baseline) + GAP;
  }
}
