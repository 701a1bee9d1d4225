package armcmc.spy;

import armcmc.posterior_t;
import armcmc.spy.draw.PosteriorPainter;
import armcmc.spy.model.PosteriorModel;
import javax.swing.Action;
import javax.swing.JDesktopPane;
import lcm.spy.ChannelData;
import lcm.spy.SpyPlugin;

/** Opens the live panel of the posterior. */
public class PosteriorPlugin implements SpyPlugin {
  @Override public boolean canHandle(long fingerprint) { return fingerprint == posterior_t.LCM_FINGERPRINT; }

  @Override public Action getAction(JDesktopPane pane, ChannelData channel) {
    return new PanelAction("ARMCMC posterior", channel, PosteriorPlugin::open);
  }

  static void open(String channel) {
    PosteriorModel model = new PosteriorModel();
    PanelWindow.open(channel, model, new PosteriorPainter(model, channel));
  }
}
