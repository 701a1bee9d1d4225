package armcmc.spy.draw;

import armcmc.estimator_status_t;
import armcmc.spy.model.Series;
import armcmc.spy.model.StatusModel;
import java.awt.Rectangle;

/** The charts over time of the status panel. */
final class StatusCharts {
  private final Pen pen;
  private final StatusModel model;
  private final double now;

  StatusCharts(Pen pen, StatusModel model, double now) {
    this.pen = pen;
    this.model = model;
    this.now = now;
  }

  void stages(Rectangle r) {
    Rectangle inner = pen.card(r, "Stage times");
    estimator_status_t s = model.status();
    double deadline = 1e-6 * Math.max(1, s.deadline_ns);
    double top = Math.pow(10, Math.ceil(Math.log10(Math.max(2 * deadline, 2 * highest(model.endToEnd)))));
    double least = model.collect.quantile(0.02, now - StatusModel.WINDOW);
    double bottom = Double.isFinite(least) && least > 0 ? Math.pow(10, Math.floor(Math.log10(least))) : 1e-3;
    Plot plot = plot(inner, Axis.logarithmic(Math.min(bottom, deadline / 100), top));
    plot.timeFrame("[ms], log scale");
    plot.events(model.machineMisses, now, Palette.alpha(Palette.WARNING, 120));
    plot.events(model.lateMisses, now, Palette.alpha(Palette.MEASURED, 150));
    plot.events(model.ownMisses, now, Palette.BAD);
    plot.horizontal(deadline, Palette.BAD, Palette.DASHED);
    plot.line(model.collect, now, Palette.COLLECT, Palette.LINE);
    plot.line(model.adjust, now, Palette.ADJUST, Palette.LINE);
    plot.line(model.execute, now, Palette.EXECUTE, Palette.LINE);
    plot.line(model.endToEnd, now, Palette.INK, Palette.LINE);
    Legend legend = new Legend(pen, r.x + r.width - 475, r.y + 23);
    legend.line(Palette.COLLECT, Palette.LINE, "collect");
    legend.line(Palette.ADJUST, Palette.LINE, "adjust");
    legend.line(Palette.EXECUTE, Palette.LINE, "execute");
    legend.line(Palette.INK, Palette.LINE, "total");
    legend.line(Palette.BAD, Palette.DASHED, "deadline");
  }

  void mismatch(Rectangle r) {
    Rectangle inner = pen.card(r, "Mismatch zeta");
    Range range = new Range();
    range.include(0);
    double since = now - StatusModel.WINDOW;
    range.include(1.15 * model.threshold.quantile(0.9, since));
    range.include(model.zeta.quantile(1, since));
    range.include(model.zeta.quantile(0, since));
    boolean negative = model.zeta.quantile(0, since) < 0;
    if (negative) range.include(-1.15 * model.threshold.quantile(0.9, since));
    Plot plot = plot(inner, range.axis());
    plot.timeFrame("[noise sd]");
    plot.line(model.threshold, now, Palette.BAD, Palette.DASHED);
    if (negative) plot.line(model.threshold, -1, now, Palette.BAD, Palette.DASHED);
    plot.line(model.zeta, now, Palette.ESTIMATE, Palette.LINE);
    Legend legend = new Legend(pen, r.x + r.width - 435, r.y + 23);
    legend.line(Palette.ESTIMATE, Palette.LINE, "zeta");
    legend.line(Palette.BAD, Palette.DASHED, "threshold: beyond it the past is dropped");
  }

  void change(Rectangle r) {
    Rectangle inner = pen.card(r, "Changes of the parameters");
    Plot plot = plot(inner, Axis.linear(0, 1.05));
    plot.timeFrame("probability [-]");
    plot.line(model.persisted, now, Palette.MEASURED, Palette.LINE);
    plot.line(model.drifted, now, Palette.ESTIMATE, Palette.LINE);
    plot.line(model.changed, now, Palette.BAD, Palette.LINE);
    Legend legend = new Legend(pen, r.x + r.width - 360, r.y + 23);
    legend.line(Palette.MEASURED, Palette.LINE, "persisted");
    legend.line(Palette.ESTIMATE, Palette.LINE, "drifted");
    legend.line(Palette.BAD, Palette.LINE, "changed at once");
  }

  void rates(Rectangle r) {
    Rectangle inner = pen.card(r, "Forgetting and acceptance");
    Plot plot = plot(inner, Axis.linear(0, 1.05));
    plot.timeFrame("share [-]");
    plot.line(model.lambda, now, Palette.EXECUTE, Palette.LINE);
    plot.line(model.acceptance, now, Palette.TRUTH, Palette.LINE);
    Legend legend = new Legend(pen, r.x + r.width - 380, r.y + 23);
    legend.line(Palette.EXECUTE, Palette.LINE, "forgetting factor lambda");
    legend.line(Palette.TRUTH, Palette.LINE, "acceptance rate");
  }

  private Plot plot(Rectangle inner, Axis y) {
    Rectangle room = new Rectangle(inner.x, inner.y, inner.width, inner.height + 6);
    return new Plot(pen, room, Axis.linear(-StatusModel.WINDOW, 0), y);
  }

  private static double highest(Series series) {
    double highest = series.quantile(1, Double.NEGATIVE_INFINITY);
    return Double.isNaN(highest) ? 0 : highest;
  }
}
