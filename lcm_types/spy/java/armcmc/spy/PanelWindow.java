package armcmc.spy;

import armcmc.spy.draw.Painter;
import armcmc.spy.model.MessageSink;
import java.awt.BorderLayout;
import java.awt.Dimension;
import java.awt.event.WindowAdapter;
import java.awt.event.WindowEvent;
import java.io.IOException;
import java.util.HashMap;
import java.util.Map;
import java.util.function.DoubleSupplier;
import javax.swing.JFrame;
import javax.swing.JLabel;
import javax.swing.JOptionPane;
import javax.swing.Timer;
import lcm.lcm.LCM;

/** A live panel in a window of its own, with its own ear on the bus; both end together. */
final class PanelWindow {
  private static final Map<String, JFrame> OPEN = new HashMap<>();

  private PanelWindow() {}

  /** Opens the panel of a channel, or brings it to the front where it is open. @param frame to be filled, or null */
  static void open(String channel, JFrame frame, MessageSink model, Painter painter) {
    JFrame there = OPEN.get(channel);
    if (there != null) {
      if (frame != null) frame.dispose();
      there.setVisible(true);
      there.toFront();
      return;
    }
    DoubleSupplier clock = () -> 1e-9 * System.nanoTime();
    Feed feed;
    try {
      String url = BusUrl.find();
      feed = new Feed(url == null ? new LCM() : new LCM(url), Channels.prefix(channel), model, clock);
    } catch (IOException | RuntimeException problem) {
      JOptionPane.showMessageDialog(null, "Cannot listen to the bus: " + problem.getMessage(), channel, JOptionPane.ERROR_MESSAGE);
      return;
    }
    OPEN.put(channel, fill(frame == null ? new JFrame() : frame, channel, new LivePanel(painter, model, clock), feed));
  }

  private static JFrame fill(JFrame frame, String channel, LivePanel panel, Feed feed) {
    frame.setTitle(channel + " - ARMCMC");
    frame.getContentPane().removeAll();
    frame.setLayout(new BorderLayout());
    frame.setDefaultCloseOperation(JFrame.DISPOSE_ON_CLOSE);
    JLabel complaint = new JLabel(" ");
    complaint.setVisible(false);
    Timer check = new Timer(1000, event -> {
      complaint.setVisible(feed.undecodable() > 0);
      complaint.setText("  " + feed.undecodable() + " messages could not be decoded: does another version of ARMCMC publish them?");
    });
    check.start();
    frame.add(panel, BorderLayout.CENTER);
    frame.add(complaint, BorderLayout.SOUTH);
    frame.addWindowListener(new WindowAdapter() {
      @Override public void windowClosed(WindowEvent event) {
        check.stop();
        feed.close();
        OPEN.remove(channel);
      }
    });
    Dimension screen = frame.getToolkit().getScreenSize();
    frame.setSize(Math.min(1200, screen.width), Math.min(820, screen.height));
    if (!frame.isVisible()) frame.setLocationByPlatform(true);
    frame.setVisible(true);
    frame.revalidate();
    return frame;
  }
}
