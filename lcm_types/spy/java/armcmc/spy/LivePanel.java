package armcmc.spy;

import armcmc.spy.draw.Painter;
import java.awt.Color;
import java.awt.Graphics;
import java.awt.Graphics2D;
import java.util.function.DoubleSupplier;
import javax.swing.JPanel;
import javax.swing.Timer;

/** A picture of a model, redrawn ten times a second while it can be seen. Swing draws it into a buffer first. */
final class LivePanel extends JPanel {
  private static final int PERIOD_MS = 100;
  private final transient Painter painter;
  private final transient Object model;
  private final transient DoubleSupplier clock;
  private final Timer timer = new Timer(PERIOD_MS, event -> repaint());

  /** @param model locked while it is drawn */
  LivePanel(Painter painter, Object model, DoubleSupplier clock) {
    super(true);
    this.painter = painter;
    this.model = model;
    this.clock = clock;
    setBackground(Color.WHITE);
  }

  @Override public void addNotify() {
    super.addNotify();
    timer.start();
  }

  @Override public void removeNotify() {
    timer.stop();
    super.removeNotify();
  }

  @Override protected void paintComponent(Graphics g) {
    Graphics2D copy = (Graphics2D) g.create();
    synchronized (model) {
      painter.paint(copy, getWidth(), getHeight(), clock.getAsDouble());
    }
    copy.dispose();
  }
}
