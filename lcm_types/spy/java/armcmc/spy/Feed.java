package armcmc.spy;

import armcmc.data_pack_t;
import armcmc.estimate_t;
import armcmc.estimator_status_t;
import armcmc.plant_truth_t;
import armcmc.posterior_t;
import armcmc.spy.model.Gate;
import armcmc.spy.model.MessageSink;
import java.io.IOException;
import java.util.concurrent.atomic.AtomicLong;
import java.util.function.DoubleSupplier;
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
  private final Gate estimates = new Gate(INTERVAL);
  private final Gate posteriors = new Gate(INTERVAL);
  private final Gate truths = new Gate(INTERVAL);
  private final Gate packs = new Gate(0);

  /** @param bus null: nothing is subscribed, messages come by hand. Closed with the feed. */
  Feed(LCM bus, String prefix, MessageSink sink, DoubleSupplier clock) {
    this.bus = bus;
    this.prefix = prefix;
    this.sink = sink;
    this.clock = clock;
    if (bus != null) bus.subscribe(java.util.regex.Pattern.quote(prefix) + "(EST_.*|PLANT_PACK|PLANT_TRUTH)", this);
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

  private void deliver(String name, LCMDataInputStream data, double now) throws IOException {
    switch (name) {
      case Channels.STATUS: sink.accept(new estimator_status_t(data), now); break;
      case Channels.ESTIMATE: if (estimates.pass(now)) sink.accept(new estimate_t(data), now); break;
      case Channels.POSTERIOR: if (posteriors.pass(now)) sink.accept(new posterior_t(data), now); break;
      case Channels.TRUTH: if (truths.pass(now)) sink.accept(new plant_truth_t(data), now); break;
      case Channels.PACK: if (packs.pass(now)) sink.accept(new data_pack_t(data), now); break;
      default:
    }
  }
}
