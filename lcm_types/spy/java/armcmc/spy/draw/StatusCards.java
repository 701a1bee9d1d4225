package armcmc.spy.draw;

import armcmc.change_t;
import armcmc.estimate_t;
import armcmc.estimator_status_t;
import armcmc.spy.model.Parameter;
import armcmc.spy.model.PlantNames;
import armcmc.spy.model.StatusModel;
import armcmc.spy.model.Text;
import java.awt.Color;
import java.awt.Font;
import java.awt.Rectangle;
import java.util.Locale;

/** The numbers of the status panel. */
final class StatusCards {
  private static final int ROW = 20;
  private final Pen pen;
  private final StatusModel model;
  private final estimator_status_t s;
  private int y;
  private int pitch = ROW;

  StatusCards(Pen pen, StatusModel model, double now) {
    this.pen = pen;
    this.model = model;
    s = model.status();
  }

  void paint(Rectangle r) {
    int[] weights = {130, 92, 150, 148, 168, 108};
    int sum = prefix(weights, weights.length);
    int top = r.y;
    for (int i = 0; i < weights.length; ++i) {
      int bottom = r.y + r.height * prefix(weights, i + 1) / sum;
      Rectangle card = new Rectangle(r.x, top, r.width, bottom - top - (i + 1 < weights.length ? 8 : 0));
      switch (i) {
        case 0: step(card); break;
        case 1: misses(card); break;
        case 2: draws(card); break;
        case 3: change(card); break;
        case 4: data(card); break;
        default: gap(card);
      }
      top = bottom;
    }
  }

  private void step(Rectangle r) {
    Rectangle inner = pen.card(r, "This step");
    boolean ran = s.end_to_end_ns > 0;
    double slack = 1e-6 * s.slack_ns;
    String text = !ran ? "no pack" : s.slack_ns < 0 ? "MISSED by " + Text.number(-slack) + " ms" : "slack " + Text.number(slack) + " ms";
    Color color = s.slack_ns < 0 ? Palette.BAD : ran ? Palette.GOOD : Palette.MUTED;
    pen.right(text, Pen.BOLD, color, r.x + r.width - 16, r.y + 24);
    int bar = Math.min(24, inner.height / 4);
    deadlineBar(inner.x, inner.y + 4, inner.width, bar);
    begin(inner.y + bar + 24);
    row(inner, 0, "collect", ms(s.collect_ns), Palette.COLLECT);
    row(inner, 1, "adjust", ms(s.adjust_ns), Palette.ADJUST);
    next();
    row(inner, 0, "execute", ms(s.execute_ns), Palette.EXECUTE);
    row(inner, 1, "witness", ms(s.witness_max_ns), null);
    next();
  }

  /** The way to the deadline, and how much of it each stage took. */
  private void deadlineBar(int x, int top, int width, int height) {
    pen.fill(Palette.GRID, x, top, width, height);
    double scale = (double) width / Math.max(1, s.deadline_ns);
    long[] times = {s.collect_ns, s.adjust_ns, s.execute_ns};
    Color[] colours = {Palette.COLLECT, Palette.ADJUST, Palette.EXECUTE};
    int end = (int) Math.min(width, Math.round(scale * s.end_to_end_ns));
    pen.fill(Palette.MEASURED, x, top, end, height);
    double at = 0;
    for (int i = 0; i < times.length; ++i) {
      int from = (int) Math.min(width, Math.round(at));
      at += scale * times[i];
      pen.fill(colours[i], x + from, top, (int) Math.min(width, Math.round(at)) - from, height);
    }
    pen.fill(Palette.BAD, x + width - 3, top - 3, 3, height + 6);
    pen.right("deadline " + ms(s.deadline_ns), Pen.SMALL, Palette.MUTED, x + width - 8, top + height / 2 + 5);
  }

  private void misses(Rectangle r) {
    Rectangle inner = pen.card(r, "Missed deadlines by cause");
    long[] counts = {s.missed_own, s.missed_machine, s.missed_late_data};
    String[] words = {"own", "machine", "late data"};
    Font font = inner.height < 36 ? Pen.TITLE : Pen.LARGE;
    int baseline = inner.y + Math.max(16, Math.min(inner.height - 16, inner.height / 2 + 12));
    for (int i = 0; i < counts.length; ++i) {
      int x = inner.x + i * inner.width / 3;
      Color color = counts[i] == 0 ? Palette.INK : i == 0 ? Palette.BAD : Palette.WARNING;
      int end = pen.left(Long.toString(counts[i]), font, color, x, baseline);
      pen.left(words[i], Pen.NORMAL, Palette.MUTED, end + 8, baseline);
    }
  }

  private void draws(Rectangle r) {
    Rectangle inner = pen.card(r, "Draws and forgetting");
    estimate_t e = model.estimate();
    if (e == null) {
      pen.left("no EST_ESTIMATE on the bus", Pen.NORMAL, Palette.MUTED, inner.x, inner.y + 18);
      return;
    }
    begin(inner, 5);
    row(inner, 0, "mode", PlantNames.mode(e.plant_kind, e.mode), null);
    row(inner, 1, "decision", PlantNames.decision(e.decision), null);
    next();
    boolean above = Math.abs(e.zeta) > e.zeta_threshold && e.zeta_threshold > 0;
    row(inner, 0, "zeta", Text.number(e.zeta) + (above ? " above " : " of ") + Text.number(e.zeta_threshold), null);
    row(inner, 1, "lambda", Text.number(e.lambda), null);
    next();
    row(inner, 0, "draws", Integer.toString(e.draws), null);
    row(inner, 1, "least", Integer.toString(e.k_min), null);
    next();
    row(inner, 0, "ESS", Text.number(Math.round(e.ess)), null);
    row(inner, 1, "Kish ESS", Text.number(Math.round(e.kish_ess)), null);
    next();
    row(inner, 0, "acceptance", percent(e.acceptance), null);
    row(inner, 1, "cut steps", Long.toString(s.truncated_steps), null);
    next();
  }

  private void change(Rectangle r) {
    change_t c = model.change();
    int mode = model.changeMode();
    String of = c == null || c.n_modes < 2 ? "" : ", " + Text.of(c.mode_name[mode]);
    Rectangle inner = pen.card(r, "Probability of change" + of);
    if (c == null || c.known[mode] == 0) {
      pen.left(c == null ? "no EST_CHANGE on the bus" : "nothing is known yet", Pen.NORMAL, Palette.MUTED, inner.x, inner.y + 18);
      return;
    }
    int n = Math.max(0, Math.min(c.n_params, change_t.MAX_PARAMS));
    int columns = n > 3 ? 2 : 1;
    begin(inner, 2 + (n + columns - 1) / columns);
    row(inner, 0, "persisted", percent(c.p_persisted[mode]), Palette.MEASURED);
    row(inner, 1, "drifted", percent(c.p_drifted[mode]), Palette.ESTIMATE);
    next();
    row(inner, 0, "changed at once", percent(c.p_changed[mode]), Palette.BAD);
    row(inner, 1, "speed of the drift:", "", null);
    next();
    int width = columns == 1 ? inner.width - 8 : inner.width / 2 - 8;
    for (int i = 0; i < n; ++i) {
      int x = inner.x + i % columns * (inner.width / 2 + 8);
      Parameter parameter = new Parameter(Text.of(c.param_name[i]), Text.of(c.param_unit[i]));
      String speed = Text.number(c.drift_rate[mode][i]) + (parameter.hasUnit() ? " " + parameter.unit : "") + " per s";
      pen.left(pen.fit(parameter.name, Pen.NORMAL, width / 3), Pen.NORMAL, Palette.MUTED, x, y);
      pen.right(pen.fit(speed, Pen.BOLD, width * 2 / 3), Pen.BOLD, Palette.INK, x + width, y);
      if (i % columns == columns - 1) next();
    }
  }

  private void data(Rectangle r) {
    Rectangle inner = pen.card(r, "Data and faults since the start");
    begin(inner, 6);
    pair(inner, "received", s.packs_received, "lost", s.packs_lost, false);
    pair(inner, "duplicate", s.packs_duplicate, "reordered", s.packs_reordered, true);
    pair(inner, "dropped", s.packs_dropped, "rejected", s.packs_rejected, true);
    pair(inner, "- size", s.rejected_size, "- type", s.rejected_type, true);
    pair(inner, "- value", s.rejected_value, "publish errors", s.publish_errors, true);
    pair(inner, "silent periods", s.silent_periods, "plant restarts", s.plant_restarts, true);
  }

  private void gap(Rectangle r) {
    Rectangle inner = pen.card(r, "Does the model miss something?");
    if (s.gap_watched == 0) {
      // Before the first step nobody knows whether it is on.
      pen.left(s.step == 0 ? "no data judged yet" : "not watched ([gap_watch] enabled = false)", Pen.NORMAL, Palette.MUTED, inner.x, inner.y + 18);
      return;
    }
    boolean suspected = s.gap_suspected != 0;
    pen.right(suspected ? "YES, since pack " + s.gap_since_seq : "no", Pen.BOLD, suspected ? Palette.BAD : Palette.GOOD, r.x + r.width - 16, r.y + 24);
    double share = s.gap_log_threshold > 0 ? Math.max(0, Math.min(1, s.gap_log_evidence / s.gap_log_threshold)) : 0;
    int bar = Math.min(16, inner.height / 4);
    pen.fill(Palette.GRID, inner.x, inner.y + 2, inner.width, bar);
    pen.fill(suspected ? Palette.BAD : Palette.ESTIMATE, inner.x, inner.y + 2, (int) Math.round(share * inner.width), bar);
    pen.fill(Palette.BAD, inner.x + inner.width - 3, inner.y - 1, 3, bar + 6);
    begin(inner.y + bar + 20);
    pen.left(String.format(Locale.ROOT, "evidence %s of %s nats", Text.number(s.gap_log_evidence), Text.number(s.gap_log_threshold)),
        Pen.NORMAL, Palette.INK, inner.x, y);
    next();
    String name = Text.of(s.gap_where).replace('_', ' ');
    String where = s.gap_check < 0 ? "no data judged yet" : suspected ? name + ", " + percent(s.gap_share) + " of the excess error" : "nearest: " + name;
    pen.left(pen.fit(where, Pen.NORMAL, inner.width), Pen.NORMAL, Palette.MUTED, inner.x, y);
  }

  private void begin(int baseline) {
    y = baseline;
    pitch = ROW;
  }

  /** Rows that fill a card, closer to each other where it is low. */
  private void begin(Rectangle inner, int rows) {
    y = inner.y + 14;
    pitch = Math.min(ROW, Math.max(1, (inner.height - 10) / Math.max(1, rows - 1)));
  }

  private void next() { y += pitch; }

  private void pair(Rectangle inner, String a, long valueA, String b, long valueB, boolean aIsFault) {
    count(inner, 0, a, valueA, aIsFault);
    count(inner, 1, b, valueB, true);
    next();
  }

  private void count(Rectangle inner, int column, String word, long value, boolean fault) {
    row(inner, column, word, Long.toString(value), null, fault && value > 0 ? Palette.BAD : Palette.INK);
  }

  private void row(Rectangle inner, int column, String word, String value, Color mark) {
    row(inner, column, word, value, mark, Palette.INK);
  }

  private void row(Rectangle inner, int column, String word, String value, Color mark, Color ink) {
    int half = inner.width / 2;
    int x = inner.x + column * (half + 8);
    if (mark != null) {
      pen.fill(mark, x, y - 11, 12, 12);
      x += 18;
    }
    pen.left(word, Pen.NORMAL, Palette.MUTED, x, y);
    pen.right(value, Pen.BOLD, ink, inner.x + column * (half + 8) + half - 8, y);
  }

  private static int prefix(int[] weights, int n) {
    int sum = 0;
    for (int i = 0; i < n; ++i) sum += weights[i];
    return sum;
  }

  private static String ms(long ns) { return Text.number(1e-6 * ns) + " ms"; }

  private static String percent(double share) { return String.format(Locale.ROOT, "%.0f %%", 100 * share); }
}
