package armcmc.spy;

import armcmc.posterior_t;
import armcmc.spy.draw.PosteriorPainter;
import armcmc.spy.model.PosteriorModel;
import javax.swing.Action;
import javax.swing.JDesktopPane;
import javax.swing.JFrame;
import lcm.spy.ChannelData;
import lcm.spy.SpyPlugin;

/** Opens the live panel of the posterior. */
public class PosteriorPlugin implements SpyPlugin {
  @Override public boolean canHandle(long fingerprint) { return fingerprint == posterior_t.LCM_FINGERPRINT; }

  @Override public Action getAction(JDesktopPane pane, ChannelData channel) {
    return new PanelAction("ARMCMC posterior", pane, channel, PosteriorPlugin::open);
  }

  /** @param frame window to use, or null for a new one */
  static void open(String channel, JFrame frame) {
    PosteriorModel model = new PosteriorModel();
    PanelWindow.open(channel, frame, model, new PosteriorPainter(model, channel));
  }
}
