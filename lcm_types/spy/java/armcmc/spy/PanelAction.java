package armcmc.spy;

import java.awt.Window;
import java.awt.event.ActionEvent;
import java.util.function.BiConsumer;
import javax.swing.AbstractAction;
import javax.swing.JDesktopPane;
import javax.swing.JFrame;
import javax.swing.SwingUtilities;
import lcm.spy.ChannelData;

/** An entry of lcm-spy's menu, and what its double click does. */
final class PanelAction extends AbstractAction {
  private final transient JDesktopPane pane;
  private final transient ChannelData channel;
  private final transient BiConsumer<String, JFrame> open;

  /**
   * @param pane all that is in the window that lcm-spy opens for a plug-in; null where it only asks for the name
   * @param open gets the name of the channel and that window, or null
   */
  PanelAction(String name, JDesktopPane pane, ChannelData channel, BiConsumer<String, JFrame> open) {
    super(name);
    this.pane = pane;
    this.channel = channel;
    this.open = open;
  }

  @Override public void actionPerformed(ActionEvent event) {
    if (channel == null) return;
    Window window = pane == null ? null : SwingUtilities.getWindowAncestor(pane);
    open.accept(channel.name, window instanceof JFrame ? (JFrame) window : null);
  }
}
