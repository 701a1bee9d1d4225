package armcmc.spy;

import armcmc.change_t;
import armcmc.data_pack_t;
import armcmc.estimate_t;
import armcmc.estimator_status_t;
import armcmc.plant_truth_t;
import armcmc.posterior_t;
import armcmc.spy.model.Gate;
import armcmc.spy.model.MessageSink;
import armcmc.spy.model.SenderClock;
import java.io.IOException;
import java.util.HashMap;
import java.util.Map;
import java.util.concurrent.atomic.AtomicLong;
import java.util.function.DoubleSupplier;
import java.util.regex.Pattern;
import lcm.lcm.LCM;
import lcm.lcm.LCMDataInputStream;
import lcm.lcm.LCMSubscriber;

/**
 * Decodes what one estimator and its plant publish and hands it to a model, which is locked meanwhile. Messages that
 * come faster than a screen shows are dropped before they are decoded; the health of the estimator never is,
 * because a single bad step must show.
 */
final class Feed implements LCMSubscriber, AutoCloseable {
  private static final double INTERVAL = 0.04;  // s

  private final LCM bus;
  private final String prefix;
  private final MessageSink sink;
  private final DoubleSupplier clock;
  private final AtomicLong undecodable = new AtomicLong();
  private final Map<String, SenderClock> clocks = new HashMap<>();
  private final Map<String, Gate> gates = new HashMap<>();

  /** @param bus null: nothing is subscribed, messages come by hand. Closed with the feed. */
  Feed(LCM bus, String prefix, MessageSink sink, DoubleSupplier clock) {
    this.bus = bus;
    this.prefix = prefix;
    this.sink = sink;
    this.clock = clock;
    if (bus != null) bus.subscribe(Pattern.quote(prefix) + "(" + String.join("|", Channels.ALL) + ")", this);
  }

  /** Messages on our channels that hold something else. */
  long undecodable() { return undecodable.get(); }

  @Override public void messageReceived(LCM from, String channel, LCMDataInputStream data) {
    try {
      synchronized (sink) {
        deliver(channel.substring(prefix.length()), data, clock.getAsDouble());
      }
    } catch (IOException foreign) {
      undecodable.incrementAndGet();
    }
  }

  @Override public void close() {
    if (bus != null) bus.close();
  }

  private void deliver(String name, LCMDataInputStream data, double arrival) throws IOException {
    // Every type begins with the fingerprint and the time of the sender.
    data.readLong();
    double sent = 1e-6 * data.readLong();
    data.reset();
    double now = clocks.computeIfAbsent(name, channel -> new SenderClock()).time(sent, arrival);
    boolean all = name.equals(Channels.STATUS) || name.equals(Channels.PACK);
    if (!all && !gates.computeIfAbsent(name, channel -> new Gate(INTERVAL)).pass(now)) return;
    switch (name) {
      case Channels.STATUS: sink.accept(new estimator_status_t(data), now); break;
      case Channels.ESTIMATE: sink.accept(new estimate_t(data), now); break;
      case Channels.POSTERIOR: sink.accept(new posterior_t(data), now); break;
      case Channels.CHANGE: sink.accept(new change_t(data), now); break;
      case Channels.TRUTH: sink.accept(new plant_truth_t(data), now); break;
      case Channels.PACK: sink.accept(new data_pack_t(data), now); break;
      default:
    }
  }
}
