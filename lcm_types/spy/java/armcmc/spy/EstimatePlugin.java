package armcmc.spy;

import armcmc.estimate_t;
import armcmc.spy.draw.EstimatePainter;
import armcmc.spy.model.EstimateModel;
import javax.swing.Action;
import javax.swing.JDesktopPane;
import lcm.spy.ChannelData;
import lcm.spy.SpyPlugin;

/** Opens the live panel of the estimates. */
public class EstimatePlugin implements SpyPlugin {
  @Override public boolean canHandle(long fingerprint) { return fingerprint == estimate_t.LCM_FINGERPRINT; }

  @Override public Action getAction(JDesktopPane pane, ChannelData channel) {
    return new PanelAction("ARMCMC estimates", channel, EstimatePlugin::open);
  }

  static void open(String channel) {
    EstimateModel model = new EstimateModel();
    PanelWindow.open(channel, model, new EstimatePainter(model, channel));
  }
}
