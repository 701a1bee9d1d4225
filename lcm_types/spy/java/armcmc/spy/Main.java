package armcmc.spy;

import java.io.IOException;
import javax.swing.SwingUtilities;
import lcm.spy.Spy;

/** Starts lcm-spy and, when asked to, the live panels beside it. */
public final class Main {
  private Main() {}

  /** URL, "true" for panels at once, prefix of their channels. */
  public static void main(String[] arguments) throws IOException {
    new Spy(arguments[0]);
    if (!arguments[1].equals("true")) return;
    SwingUtilities.invokeLater(() -> {
      EstimatePlugin.open(arguments[2] + Channels.ESTIMATE, null);
      PosteriorPlugin.open(arguments[2] + Channels.POSTERIOR, null);
      StatusPlugin.open(arguments[2] + Channels.STATUS, null);
    });
  }
}
