package armcmc.spy.draw;

import armcmc.estimate_t;
import armcmc.spy.model.Band;
import armcmc.spy.model.EstimateModel;
import armcmc.spy.model.Parameter;
import armcmc.spy.model.PlantNames;
import armcmc.spy.model.Series;
import armcmc.spy.model.Text;
import java.awt.Graphics2D;
import java.awt.Rectangle;

/** Per parameter the estimate with its intervals over time; below, the predicted output against the measured. */
public final class EstimatePainter implements Painter {
  private final EstimateModel model;
  private final String title;

  public EstimatePainter(EstimateModel model, String title) {
    this.model = model;
    this.title = title;
  }

  @Override public void paint(Graphics2D g, int width, int height, double now) {
    Pen pen = new Pen(g);
    Header header = new Header(pen, width, height);
    header.title(title, detail(), model.freshness());
    header.staleness(model.freshness(), now);
    estimate_t last = model.last();
    if (last != null && last.known == 0) header.alarm(Palette.WARNING, "Nothing is known yet: no pack of an identified mode has come");
    int top = header.bottom();
    int n = model.count();
    if (n > 0) {
      int columns = n > 4 ? 2 : 1;
      int rows = (n + columns - 1) / columns;
      int below = (height - top) * 29 / 100;
      for (int i = 0; i < n; ++i) {
        int w = (width - 12 - 12 * columns) / columns;
        int h = (height - top - 30 - below) / rows;
        parameter(pen, new Rectangle(12 + i / rows * (w + 12), top + i % rows * h, w, h - 8), i, now);
      }
      output(pen, new Rectangle(12, height - 30 - below, width - 24, below), last);
    }
    legend(pen, height - 10);
  }

  private String detail() {
    estimate_t e = model.last();
    if (e == null) return "";
    String text = "pack " + e.seq + ", mode " + PlantNames.mode(e.plant_kind, e.mode);
    return e.in_contact != 0 ? text : text + ": parameters are the last known of " + model.modeName();
  }

  private void parameter(Pen pen, Rectangle r, int i, double now) {
    Parameter parameter = model.parameter(i);
    Band band = model.band(i);
    Rectangle inner = pen.card(r, parameter.label());
    summary(pen, r, parameter, i);
    double since = now - EstimateModel.WINDOW;
    Range range = new Range();
    range.includeMost(band.q025, 0.08, since);
    range.includeMost(band.q975, 0.92, since);
    range.include(band.q025.last());
    range.include(band.q975.last());
    range.include(model.truth(i));
    Rectangle room = new Rectangle(inner.x, inner.y, inner.width, inner.height + 6);
    Plot plot = new Plot(pen, room, Axis.linear(-EstimateModel.WINDOW, 0), range.axis());
    plot.timeFrame(parameter.axisLabel());
    plot.band(band.q025, band.q975, now, Palette.BAND_95);
    plot.band(band.q25, band.q75, now, Palette.BAND_50);
    plot.line(band.mean, now, Palette.INK, Palette.LINE);
    plot.line(band.truth, now, Palette.TRUTH, Palette.DASHED);
  }

  private void summary(Pen pen, Rectangle r, Parameter parameter, int i) {
    estimate_t e = model.last();
    if (e.known == 0) return;
    String text = "mean " + Text.quantity(e.ar_ap[i], parameter.unit) + "   AR-MAP " + Text.number(e.ar_map[i]) + "   sd " + Text.number(e.sd[i])
        + "   95 % [" + Text.number(e.q025[i]) + ", " + Text.number(e.q975[i]) + "]";
    if (!Double.isNaN(model.truth(i))) text += "   truth " + Text.number(model.truth(i));
    int room = r.width - 40 - pen.width(parameter.label(), Pen.BOLD);
    pen.right(pen.fit(text, Pen.NORMAL, room), Pen.NORMAL, Palette.INK, r.x + r.width - 16, r.y + 24);
  }

  private void output(Pen pen, Rectangle r, estimate_t last) {
    String unit = PlantNames.outputUnit(last.plant_kind);
    String name = PlantNames.output(last.plant_kind);
    Rectangle inner = pen.card(r, "Predicted and measured " + name);
    Band predicted = model.output();
    Series measured = model.measured();
    if (predicted.mean.size() == 0 && measured.size() == 0) {
      pen.left("no PLANT_PACK on the bus, and no prediction yet", Pen.NORMAL, Palette.MUTED, inner.x, inner.y + 20);
      return;
    }
    double end = newest(measured, newest(predicted.mean, Double.NEGATIVE_INFINITY));
    double since = end - EstimateModel.OUTPUT_WINDOW;
    Range range = new Range();
    range.include(measured.quantile(0, since));
    range.include(measured.quantile(1, since));
    range.include(predicted.q025.quantile(0.02, since));
    range.include(predicted.q975.quantile(0.98, since));
    Rectangle room = new Rectangle(inner.x, inner.y, inner.width, inner.height + 6);
    Plot plot = new Plot(pen, room, Axis.linear(-EstimateModel.OUTPUT_WINDOW, 0), range.axis());
    plot.timeFrame(Text.label(name, unit));
    plot.line(measured, end, Palette.MEASURED, Palette.THIN);
    plot.points(predicted.mean, predicted.q025, predicted.q975, end, Palette.ESTIMATE);
    if (last.decision == estimate_t.DECISION_HOLD) return;  // nothing was predicted
    pen.right("rms error over the pack " + Text.number(last.y_rmse) + ", noise sd " + Text.number(last.noise_std), Pen.NORMAL, Palette.INK,
        r.x + r.width - 16, r.y + 24);
  }

  private static double newest(Series series, double other) {
    return series.size() == 0 ? other : Math.max(other, series.time(series.size() - 1));
  }

  private static void legend(Pen pen, int baseline) {
    Legend legend = new Legend(pen, 20, baseline);
    legend.line(Palette.INK, Palette.LINE, "mean");
    legend.box(Palette.BAND_50, "50 %");
    legend.box(Palette.BAND_95, "95 % interval");
    legend.line(Palette.TRUTH, Palette.DASHED, "truth (PLANT_TRUTH)");
    legend.line(Palette.MEASURED, Palette.THIN, "measured");
    legend.line(Palette.ESTIMATE, Palette.BOLD, "predicted at the end of a pack, with 95 % interval");
  }
}
