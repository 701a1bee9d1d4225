package armcmc.spy.draw;

import armcmc.estimator_status_t;
import armcmc.spy.model.StatusFlags;
import armcmc.spy.model.StatusModel;
import armcmc.spy.model.Text;
import java.awt.Graphics2D;
import java.awt.Rectangle;

/** The health of the estimator: alarms on top, charts over time to the left, numbers to the right. */
public final class StatusPainter implements Painter {
  private final StatusModel model;
  private final String title;

  public StatusPainter(StatusModel model, String title) {
    this.model = model;
    this.title = title;
  }

  @Override public void paint(Graphics2D g, int width, int height, double now) {
    Pen pen = new Pen(g);
    Header header = new Header(pen, width, height);
    estimator_status_t s = model.status();
    String detail = s == null ? "" : "step " + s.step + ", pack " + s.last_seq + ", period " + Text.number(1e-6 * s.period_ns) + " ms";
    header.title(title, detail, model.freshness());
    header.staleness(model.freshness(), now);
    if (s == null) return;
    alarms(header, s, now);
    int top = header.bottom();
    int right = Math.max(400, width * 36 / 100);
    int left = width - 36 - right;
    int h = height - top - 12;
    StatusCharts charts = new StatusCharts(pen, model, now);
    charts.stages(new Rectangle(12, top, left, h * 37 / 100 - 8));
    charts.mismatch(new Rectangle(12, top + h * 37 / 100, left, h * 21 / 100 - 8));
    charts.change(new Rectangle(12, top + h * 58 / 100, left, h * 21 / 100 - 8));
    charts.rates(new Rectangle(12, top + h * 79 / 100, left, h * 21 / 100));
    new StatusCards(pen, model, now).paint(new Rectangle(24 + left, top, right, h));
  }

  private void alarms(Header header, estimator_status_t s, double now) {
    if (s.degraded_flags != 0) {
      header.alarm(Palette.BAD, "\u26A0 DEGRADED: " + String.join(", ", StatusFlags.degraded(s.degraded_flags)));
    }
    if (s.gap_suspected != 0) {
      header.alarm(Palette.BAD, "\u26A0 MODEL GAP: the model is missing something: " + Text.of(s.gap_where).replace('_', ' ') + ", since pack " + s.gap_since_seq
          + "; armcmc-gap finds out what");
    }
    int faults = model.recentFaults(now);
    if (faults != 0) header.alarm(Palette.WARNING, "Faults in the last 3 s: " + String.join(", ", StatusFlags.faults(faults)));
  }
}
