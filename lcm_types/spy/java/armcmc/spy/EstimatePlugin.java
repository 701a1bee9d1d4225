package armcmc.spy;

import armcmc.estimate_t;
import armcmc.spy.draw.EstimatePainter;
import armcmc.spy.model.EstimateModel;
import javax.swing.Action;
import javax.swing.JDesktopPane;
import javax.swing.JFrame;
import lcm.spy.ChannelData;
import lcm.spy.SpyPlugin;

/** Opens the live panel of the estimates. */
public class EstimatePlugin implements SpyPlugin {
  @Override public boolean canHandle(long fingerprint) { return fingerprint == estimate_t.LCM_FINGERPRINT; }

  @Override public Action getAction(JDesktopPane pane, ChannelData channel) {
    return new PanelAction("ARMCMC estimates", pane, channel, EstimatePlugin::open);
  }

  /** @param frame window to use, or null for a new one */
  static void open(String channel, JFrame frame) {
    EstimateModel model = new EstimateModel();
    PanelWindow.open(channel, frame, model, new EstimatePainter(model, channel));
  }
}
