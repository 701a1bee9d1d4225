package armcmc.spy.draw;

import armcmc.spy.model.Series;
import java.awt.Color;
import java.awt.Graphics2D;
import java.awt.Rectangle;
import java.awt.Shape;
import java.awt.Stroke;
import java.awt.geom.Ellipse2D;
import java.awt.geom.Line2D;
import java.awt.geom.Path2D;
import java.util.function.DoubleFunction;

/** One chart: axes, grid, and lines and bands in the units of the axes. */
final class Plot {
  private static final int LEFT = 66;
  private static final int BOTTOM = 22;
  private static final int LABEL = 14;
  private static final double GAP = 1.2;  // s without a sample: the line breaks

  final Rectangle area;
  final Axis x;
  final Axis y;
  private final Pen pen;
  private final Graphics2D g;

  /** Room for a name of the horizontal axis below its numbers. */
  static Plot named(Pen pen, Rectangle outer, Axis x, Axis y) {
    return new Plot(pen, new Rectangle(outer.x, outer.y, outer.width, outer.height - LABEL), x, y);
  }

  /** Without a name of the horizontal axis: for time, whose numbers carry their unit. */
  Plot(Pen pen, Rectangle outer, Axis x, Axis y) {
    this.pen = pen;
    this.x = x;
    this.y = y;
    g = pen.g;
    area = new Rectangle(outer.x + LEFT, outer.y + 6, Math.max(10, outer.width - LEFT - 10),
        Math.max(10, outer.height - BOTTOM - 6));
  }

  Pen pen() { return pen; }

  double px(double value) { return area.x + x.at(value) * area.width; }

  double py(double value) { return area.y + area.height - y.at(value) * area.height; }

  /** Grid, numbers, and what the axes are. */
  void frame(String xLabel, String yLabel) {
    frame(yLabel, tick -> x.text(tick, across()));
    pen.centre(xLabel, Pen.SMALL, Palette.MUTED, area.x + area.width / 2, area.y + area.height + 30);
  }

  /** The same where the horizontal axis is time, in s before now. */
  void timeFrame(String yLabel) {
    frame(yLabel, tick -> tick == 0 ? "now" : x.text(tick, across()) + " s");
  }

  private int across() { return Math.max(2, area.width / 90); }

  private void frame(String yLabel, DoubleFunction<String> text) {
    g.setStroke(Palette.THIN);
    for (double tick : x.ticks(across())) {
      grid(px(tick), true);
      pen.centre(text.apply(tick), Pen.SMALL, Palette.MUTED, (int) px(tick), area.y + area.height + 15);
    }
    int up = Math.max(3, area.height / 34);
    for (double tick : y.ticks(up)) {
      grid(py(tick), false);
      pen.right(y.text(tick, up), Pen.SMALL, Palette.MUTED, area.x - 6, (int) py(tick) + 4);
    }
    g.setColor(Palette.BORDER);
    g.draw(area);
    g.rotate(-Math.PI / 2);
    pen.centre(pen.fit(yLabel, Pen.SMALL, area.height + 24), Pen.SMALL, Palette.MUTED, -(area.y + area.height / 2), area.x - 52);
    g.rotate(Math.PI / 2);
  }

  void line(Series series, double origin, Color color, Stroke stroke) { line(series, 1, origin, color, stroke); }

  /** The same, times a factor. */
  void line(Series series, double factor, double origin, Color color, Stroke stroke) {
    Path2D path = new Path2D.Double();
    double previous = Double.NEGATIVE_INFINITY;
    for (int i = 0; i < series.size(); ++i) {
      double value = factor * series.value(i);
      if (!Double.isFinite(value) || series.time(i) - origin < x.lo) {
        previous = Double.NEGATIVE_INFINITY;
        continue;
      }
      double t = series.time(i);
      if (t - previous > GAP) {
        path.moveTo(px(t - origin), py(value));
      }
      path.lineTo(px(t - origin), py(value));
      previous = t;
    }
    inside(path, color, stroke);
  }

  /** Between two series with the same times. */
  void band(Series low, Series high, double origin, Color color) {
    int i = 0;
    while (i < low.size()) {
      int end = i;
      while (end < low.size() && drawable(low, high, end, origin) && (end == i || low.time(end) - low.time(end - 1) <= GAP)) ++end;
      if (end - i > 1) fillBand(low, high, i, end, origin, color);
      i = Math.max(end, i + 1);
    }
  }

  void horizontal(double value, Color color, Stroke stroke) {
    if (Double.isFinite(value)) inside(new Line2D.Double(area.x, py(value), area.x + area.width, py(value)), color, stroke);
  }

  void vertical(double value, Color color, Stroke stroke) {
    if (Double.isFinite(value)) inside(new Line2D.Double(px(value), area.y, px(value), area.y + area.height), color, stroke);
  }

  /** Marks of whatever in a series is above zero, at the foot of the chart. */
  void events(Series series, double origin, Color color) {
    for (int i = 0; i < series.size(); ++i) {
      if (series.value(i) > 0 && series.time(i) - origin >= x.lo) {
        inside(new Line2D.Double(px(series.time(i) - origin), area.y, px(series.time(i) - origin), area.y + area.height), color, Palette.BOLD);
      }
    }
  }

  /** Points with the interval around them. */
  void points(Series series, Series low, Series high, double origin, Color color) {
    for (int i = 0; i < series.size(); ++i) {
      double t = series.time(i) - origin;
      if (t < x.lo || !Double.isFinite(series.value(i))) continue;
      inside(new Line2D.Double(px(t), py(low.value(i)), px(t), py(high.value(i))), Palette.alpha(color, 130), Palette.LINE);
      Shape old = clip();
      g.setColor(color);
      g.fill(new Ellipse2D.Double(px(t) - 2.5, py(series.value(i)) - 2.5, 5, 5));
      g.setClip(old);
    }
  }

  void shape(Path2D path, Color fill) {
    Shape old = clip();
    g.setColor(fill);
    g.fill(path);
    g.setClip(old);
  }

  void inside(Shape shape, Color color, Stroke stroke) {
    Shape old = clip();
    g.setColor(color);
    g.setStroke(stroke);
    g.draw(shape);
    g.setClip(old);
  }

  private boolean drawable(Series low, Series high, int i, double origin) {
    return Double.isFinite(low.value(i)) && Double.isFinite(high.value(i)) && low.time(i) - origin >= x.lo;
  }

  private void fillBand(Series low, Series high, int from, int to, double origin, Color color) {
    Path2D path = new Path2D.Double();
    path.moveTo(px(low.time(from) - origin), py(low.value(from)));
    for (int i = from + 1; i < to; ++i) path.lineTo(px(low.time(i) - origin), py(low.value(i)));
    for (int i = to - 1; i >= from; --i) path.lineTo(px(high.time(i) - origin), py(high.value(i)));
    path.closePath();
    shape(path, color);
  }

  private Shape clip() {
    Shape old = g.getClip();
    g.clip(area);
    return old;
  }

  private void grid(double position, boolean vertical) {
    g.setColor(Palette.GRID);
    if (vertical) {
      g.draw(new Line2D.Double(position, area.y, position, area.y + area.height));
    } else {
      g.draw(new Line2D.Double(area.x, position, area.x + area.width, position));
    }
  }
}
