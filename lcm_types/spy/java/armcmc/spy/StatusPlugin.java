package armcmc.spy;

import armcmc.change_t;
import armcmc.estimator_status_t;
import armcmc.spy.draw.StatusPainter;
import armcmc.spy.model.StatusModel;
import javax.swing.Action;
import javax.swing.JDesktopPane;
import javax.swing.JFrame;
import lcm.spy.ChannelData;
import lcm.spy.SpyPlugin;

/** Opens the live panel of the estimator's health, which also shows the probabilities of change. */
public class StatusPlugin implements SpyPlugin {
  @Override public boolean canHandle(long fingerprint) {
    return fingerprint == estimator_status_t.LCM_FINGERPRINT || fingerprint == change_t.LCM_FINGERPRINT;
  }

  @Override public Action getAction(JDesktopPane pane, ChannelData channel) {
    return new PanelAction("ARMCMC status", pane, channel, StatusPlugin::open);
  }

  /** @param frame window to use, or null for a new one */
  static void open(String channel, JFrame frame) {
    StatusModel model = new StatusModel();
    PanelWindow.open(channel, frame, model, new StatusPainter(model, channel));
  }
}
