package armcmc.spy.draw;

import java.awt.Graphics2D;

/** Draws what a model holds. Needs no screen. */
public interface Painter {
  /** @param now s, of the clock that the model's messages were stamped with */
  void paint(Graphics2D g, int width, int height, double now);
}
