package armcmc.spy;

import java.awt.event.ActionEvent;
import java.util.function.Consumer;
import javax.swing.AbstractAction;
import lcm.spy.ChannelData;

/** An entry of lcm-spy's menu, and what its double click does. */
final class PanelAction extends AbstractAction {
  private final transient ChannelData channel;
  private final transient Consumer<String> open;

  /** @param channel null where lcm-spy only asks for the name; @param open gets the name of the channel */
  PanelAction(String name, ChannelData channel, Consumer<String> open) {
    super(name);
    this.channel = channel;
    this.open = open;
  }

  @Override public void actionPerformed(ActionEvent event) {
    if (channel != null) open.accept(channel.name);
  }
}
