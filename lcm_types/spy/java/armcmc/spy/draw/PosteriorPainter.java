package armcmc.spy.draw;

import armcmc.spy.model.Density;
import armcmc.spy.model.DensityHistory;
import armcmc.spy.model.Parameter;
import armcmc.spy.model.PosteriorModel;
import armcmc.spy.model.Text;
import java.awt.Graphics2D;
import java.awt.Rectangle;
import java.awt.geom.Path2D;
import java.util.List;

/** Per parameter its marginal density now, and the densities of the last seconds as colours. */
public final class PosteriorPainter implements Painter {
  private final PosteriorModel model;
  private final String title;

  public PosteriorPainter(PosteriorModel model, String title) {
    this.model = model;
    this.title = title;
  }

  @Override public void paint(Graphics2D g, int width, int height, double now) {
    Pen pen = new Pen(g);
    Header header = new Header(pen, width, height);
    String what = model.freshness().any() ? "pack " + model.seq() + ", mode " + model.modeName() : "";
    header.title(title, what, model.freshness());
    header.staleness(model.freshness(), now);
    if (model.freshness().any() && !model.known()) {
      header.alarm(Palette.WARNING, "Nothing is known yet: no pack of this mode has come");
    }
    int top = header.bottom();
    int n = model.count();
    int columns = n > 4 ? 2 : 1;
    int rows = Math.max(1, (n + columns - 1) / columns);
    for (int i = 0; i < n; ++i) {
      int w = (width - 12 - 12 * columns) / columns;
      int h = (height - top - 34) / rows;
      parameter(pen, new Rectangle(12 + i / rows * (w + 12), top + i % rows * h, w, h - 8), i, now);
    }
    legend(pen, width, height - 10);
  }

  private void parameter(Pen pen, Rectangle r, int i, double now) {
    Parameter parameter = model.parameter(i);
    Density density = model.history(i).newest();
    Rectangle inner = pen.card(r, parameter.label());
    if (density == null) {
      pen.left("not known yet", Pen.NORMAL, Palette.MUTED, inner.x, inner.y + 20);
      return;
    }
    summary(pen, r, parameter, density, model.truth(i));
    int half = inner.width * 4 / 10;
    now(pen, new Rectangle(inner.x, inner.y, half, inner.height + 6), parameter, density, model.truth(i));
    past(pen, new Rectangle(inner.x + half, inner.y, inner.width - half, inner.height + 6), i, now);
  }

  private void summary(Pen pen, Rectangle r, Parameter parameter, Density density, double truth) {
    String text = "mean " + Text.quantity(density.mean(), parameter.unit) + "   sd " + Text.number(density.sd())
        + "   95 % [" + Text.number(density.quantile(0.025)) + ", " + Text.number(density.quantile(0.975)) + "]";
    if (!Double.isNaN(truth)) text += "   truth " + Text.number(truth);
    int room = r.width - 40 - pen.width(parameter.label(), Pen.BOLD);
    pen.right(pen.fit(text, Pen.NORMAL, room), Pen.NORMAL, Palette.INK, r.x + r.width - 16, r.y + 24);
  }

  private void now(Pen pen, Rectangle r, Parameter parameter, Density density, double truth) {
    Range range = new Range();
    range.include(density.quantile(0.0005));
    range.include(density.quantile(0.9995));
    // A truth far outside would squeeze the density to a line; then the numbers above say where it is.
    double reach = 4 * (density.quantile(0.975) - density.quantile(0.025));
    if (Math.abs(truth - density.mean()) < reach) range.include(truth);
    Plot plot = Plot.named(pen, r, range.axis(), Axis.linear(0, density.peak() * 1.08));
    plot.frame(parameter.label(), Text.label("density", parameter.hasUnit() ? "1/(" + parameter.unit + ")" : ""));
    area(plot, density, density.lo(), density.hi(), Palette.alpha(Palette.ESTIMATE, 18));
    area(plot, density, density.quantile(0.025), density.quantile(0.975), Palette.BAND_95);
    area(plot, density, density.quantile(0.25), density.quantile(0.75), Palette.BAND_50);
    outline(plot, density);
    plot.vertical(density.mean(), Palette.INK, Palette.LINE);
    plot.vertical(truth, Palette.TRUTH, Palette.DASHED);
  }

  private void past(Pen pen, Rectangle r, int i, double now) {
    Range range = new Range();
    List<DensityHistory.Entry> entries = model.history(i).entries();
    // All but the widest tenth of the intervals, and the newest whole.
    double[] lows = entries.stream().mapToDouble(e -> e.density.quantile(0.005)).sorted().toArray();
    double[] highs = entries.stream().mapToDouble(e -> e.density.quantile(0.995)).sorted().toArray();
    range.include(lows[lows.length / 10]);
    range.include(highs[highs.length - 1 - highs.length / 10]);
    Density newest = model.history(i).newest();
    range.include(newest.quantile(0.005));
    range.include(newest.quantile(0.995));
    range.include(model.truth(i));
    Plot plot = new Plot(pen, r, Axis.linear(-PosteriorModel.WINDOW, 0), range.axis());
    plot.timeFrame(model.parameter(i).axisLabel());
    DensityMap.draw(plot, entries, now);
    plot.horizontal(model.truth(i), Palette.TRUTH, Palette.DASHED);
  }

  private static void area(Plot plot, Density density, double from, double to, java.awt.Color color) {
    Path2D path = new Path2D.Double();
    path.moveTo(plot.px(from), plot.py(0));
    int steps = 120;
    for (int k = 0; k <= steps; ++k) {
      double x = from + (to - from) * k / steps;
      path.lineTo(plot.px(x), plot.py(density.at(x)));
    }
    path.lineTo(plot.px(to), plot.py(0));
    path.closePath();
    plot.shape(path, color);
  }

  private static void outline(Plot plot, Density density) {
    Path2D path = new Path2D.Double();
    path.moveTo(plot.px(density.lo()), plot.py(0));
    for (int k = 0; k < density.bins(); ++k) path.lineTo(plot.px(density.centre(k)), plot.py(density.height(k)));
    path.lineTo(plot.px(density.hi()), plot.py(0));
    plot.inside(path, Palette.ESTIMATE, Palette.BOLD);
  }

  private static void legend(Pen pen, int width, int baseline) {
    Legend legend = new Legend(pen, 20, baseline);
    legend.box(Palette.BAND_50, "50 %");
    legend.box(Palette.BAND_95, "95 % interval");
    legend.line(Palette.INK, Palette.LINE, "mean");
    legend.line(Palette.TRUTH, Palette.DASHED, "truth (PLANT_TRUTH)");
    legend.map("probable: bright, each column scaled to its peak");
  }
}
