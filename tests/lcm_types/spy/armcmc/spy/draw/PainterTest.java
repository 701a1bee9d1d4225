package armcmc.spy.draw;

import armcmc.change_t;
import armcmc.estimator_status_t;
import armcmc.posterior_t;
import armcmc.spy.Check;
import armcmc.spy.Messages;
import armcmc.spy.model.EstimateModel;
import armcmc.spy.model.PosteriorModel;
import armcmc.spy.model.StatusModel;
import java.awt.Color;
import java.awt.image.BufferedImage;

/** Looks at pictures that were drawn without a screen. */
public class PainterTest {
  private static final double END = 25;
  private final PosteriorModel posteriors = new PosteriorModel();
  private final EstimateModel estimates = new EstimateModel();
  private final StatusModel statuses = new StatusModel();

  private void fill(boolean truth) {
    for (int i = 0; i < 250; ++i) {
      double now = 0.1 * i;
      posteriors.accept(Messages.posterior(i), now);
      posteriors.accept(Messages.estimate(i), now);
      if (truth) posteriors.accept(Messages.truth(), now);
      if (truth) estimates.accept(Messages.truth(), now);
      estimates.accept(Messages.estimate(i), now);
      estimates.accept(Messages.pack(i), now);
      statuses.accept(Messages.estimate(i), now);
      statuses.accept(Messages.change(i), now);
      statuses.accept(Messages.status(i), now);
    }
  }

  private static BufferedImage draw(Painter painter, int width, int height, double now) {
    BufferedImage image = new BufferedImage(width, height, BufferedImage.TYPE_INT_RGB);
    painter.paint(image.createGraphics(), width, height, now);
    return image;
  }

  /** Pixels of a colour, or nearly: the edge of a line is mixed with what it lies on. */
  private static int count(BufferedImage image, Color color) {
    int n = 0;
    for (int y = 0; y < image.getHeight(); ++y) {
      for (int x = 0; x < image.getWidth(); ++x) {
        Color c = new Color(image.getRGB(x, y));
        int distance = Math.abs(c.getRed() - color.getRed()) + Math.abs(c.getGreen() - color.getGreen()) + Math.abs(c.getBlue() - color.getBlue());
        if (distance < 50) ++n;
      }
    }
    return n;
  }

  public void thePosteriorShowsDensityMapAndTruth() {
    fill(true);
    BufferedImage image = draw(new PosteriorPainter(posteriors, "EST_POSTERIOR"), 1400, 900, END);
    Check.that(count(image, new Color(ColourMap.rgb(1))) > 1000, "no bright ridge in the map");
    Check.that(count(image, new Color(ColourMap.rgb(0))) > 5_000, "no dark ground in the map");
    Check.that(count(image, Palette.ESTIMATE) > 500, "no outline of the density");
    Check.that(count(image, Palette.TRUTH) > 300, "no truth");
  }

  public void theTruthIsNotInvented() {
    fill(false);
    BufferedImage image = draw(new PosteriorPainter(posteriors, "EST_POSTERIOR"), 1400, 900, END);
    // The legend has a dash of it.
    Check.that(count(image, Palette.TRUTH) < 100, count(image, Palette.TRUTH) + " pixels of a truth that nobody told");
  }

  public void theEstimatesShowBandsAndOutput() {
    fill(true);
    BufferedImage image = draw(new EstimatePainter(estimates, "EST_ESTIMATE"), 1400, 900, END);
    Check.that(count(image, Palette.TRUTH) > 500, "no truth");
    Check.that(count(image, Palette.ESTIMATE) > 200, "no prediction");
    Check.that(count(image, Palette.INK) > 500, "no mean");
  }

  public void theStatusIsRedOnlyWhenDegraded() {
    fill(true);
    StatusPainter painter = new StatusPainter(statuses, "EST_STATUS");
    int before = count(draw(painter, 1400, 900, END), Palette.BAD);
    estimator_status_t s = Messages.status(300);
    s.degraded_flags = estimator_status_t.DEGRADED_NO_FIFO;
    statuses.accept(s, END);
    int after = count(draw(painter, 1400, 900, END), Palette.BAD);
    Check.that(after - before > 20_000, "the bar took " + (after - before) + " pixels");
    s.gap_suspected = 1;
    Check.that(count(draw(painter, 1400, 900, END), Palette.BAD) - after > 20_000, "a second bar for the gap");
  }

  public void theStagesAreDrawn() {
    fill(true);
    BufferedImage image = draw(new StatusPainter(statuses, "EST_STATUS"), 1400, 900, END);
    for (Color stage : new Color[] {Palette.COLLECT, Palette.ADJUST, Palette.EXECUTE, Palette.INK}) {
      Check.that(count(image, stage) > 200, "a stage is missing: " + stage);
    }
  }

  public void whatIsBelievedAboutChangeIsDrawn() {
    fill(true);
    StatusPainter painter = new StatusPainter(statuses, "EST_STATUS");
    BufferedImage image = draw(painter, 1400, 900, END);
    change_t none = Messages.change(1);
    none.known[0] = 0;
    StatusModel others = new StatusModel();
    for (int i = 0; i < 250; ++i) {
      others.accept(Messages.estimate(i), 0.1 * i);
      others.accept(none, 0.1 * i);
      others.accept(Messages.status(i), 0.1 * i);
    }
    BufferedImage empty = draw(new StatusPainter(others, "EST_STATUS"), 1400, 900, END);
    for (Color part : new Color[] {Palette.MEASURED, Palette.ESTIMATE, Palette.BAD}) {
      int more = count(image, part) - count(empty, part);
      Check.that(more > 300, more + " pixels of a share: " + part);
    }
  }

  public void silenceIsSaid() {
    fill(true);
    for (Painter painter : painters()) {
      int live = count(draw(painter, 1400, 900, END), Palette.WARNING);
      int silent = count(draw(painter, 1400, 900, END + 5), Palette.WARNING);
      Check.that(silent - live > 20_000, "no bar for silence");
    }
  }

  public void everySizeAndEveryStateIsSurvived() {
    for (int round = 0; round < 2; ++round) {
      for (Painter painter : painters()) {
        for (int[] size : new int[][] {{1, 1}, {200, 100}, {1000, 640}, {1400, 900}, {2500, 1400}}) draw(painter, size[0], size[1], END);
      }
      fill(true);
    }
    posterior_t many = Messages.posterior(1);
    many.n_params = 8;
    posteriors.accept(many, END);
    change_t wild = Messages.change(1);
    wild.n_params = 8;
    wild.n_modes = 1_000_000;
    wild.mode = -3;
    wild.drift_rate[0][0] = Double.NaN;
    statuses.accept(wild, END);
    estimator_status_t odd = new estimator_status_t();
    odd.gap_watched = 1;
    odd.gap_log_evidence = Double.NaN;
    statuses.accept(odd, END);
    for (Painter painter : painters()) draw(painter, 1400, 900, END);
  }

  private Painter[] painters() {
    return new Painter[] {new PosteriorPainter(posteriors, "a"), new EstimatePainter(estimates, "b"), new StatusPainter(statuses, "c")};
  }
}
