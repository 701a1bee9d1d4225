package armcmc.spy;

import armcmc.change_t;
import armcmc.data_pack_t;
import armcmc.estimate_t;
import armcmc.estimator_status_t;
import armcmc.posterior_t;
import armcmc.spy.model.MessageSink;
import java.io.IOException;
import java.util.Arrays;
import javax.swing.Action;
import lcm.lcm.LCMDataInputStream;
import lcm.lcm.LCMDataOutputStream;
import lcm.lcm.LCMEncodable;
import lcm.spy.SpyPlugin;

public class PluginTest {
  private final int[] taken = new int[5];
  private double now;

  private final MessageSink sink = new MessageSink() {
    @Override public void accept(posterior_t message, double time) { ++taken[0]; }

    @Override public void accept(estimate_t message, double time) { ++taken[1]; }

    @Override public void accept(estimator_status_t message, double time) { ++taken[2]; }

    @Override public void accept(data_pack_t message, double time) { ++taken[3]; }

    @Override public void accept(change_t message, double time) { ++taken[4]; }
  };

  private static LCMDataInputStream bytes(LCMEncodable message) throws IOException {
    LCMDataOutputStream out = new LCMDataOutputStream(new byte[20_000]);
    message.encode(out);
    return new LCMDataInputStream(out.toByteArray());
  }

  public void eachPluginTakesItsTypeAndNoOther() {
    Check.that(new PosteriorPlugin().canHandle(posterior_t.LCM_FINGERPRINT), "posterior");
    Check.that(new StatusPlugin().canHandle(estimator_status_t.LCM_FINGERPRINT), "status");
    Check.that(new StatusPlugin().canHandle(change_t.LCM_FINGERPRINT), "change");
    Check.that(new EstimatePlugin().canHandle(estimate_t.LCM_FINGERPRINT), "estimate");
    Check.that(!new PosteriorPlugin().canHandle(estimate_t.LCM_FINGERPRINT), "a foreign type");
  }

  public void lcmSpyFindsThem() throws ReflectiveOperationException {
    for (Class<?> plugin : new Class<?>[] {PosteriorPlugin.class, StatusPlugin.class, EstimatePlugin.class}) {
      // An inherited interface is not seen, nor a constructor that is not public.
      Check.that(Arrays.asList(plugin.getInterfaces()).contains(SpyPlugin.class), plugin + " names the interface itself");
      SpyPlugin made = (SpyPlugin) plugin.getConstructor().newInstance();
      Action asked = made.getAction(null, null);
      Check.that(asked.getValue(Action.NAME).toString().startsWith("ARMCMC"), "lcm-spy asks for the name this way");
      asked.actionPerformed(null);
    }
  }

  public void theFeedDecodesBehindAPrefix() throws IOException {
    Feed feed = new Feed(null, "left_", sink, () -> now);
    feed.messageReceived(null, "left_EST_POSTERIOR", bytes(Messages.posterior(1)));
    feed.messageReceived(null, "left_EST_ESTIMATE", bytes(Messages.estimate(1)));
    feed.messageReceived(null, "left_EST_STATUS", bytes(Messages.status(1)));
    feed.messageReceived(null, "left_PLANT_PACK", bytes(Messages.pack(1)));
    feed.messageReceived(null, "left_EST_CHANGE", bytes(Messages.change(1)));
    Check.equal("[1, 1, 1, 1, 1]", Arrays.toString(taken));
    Check.equal(0L, feed.undecodable());
  }

  public void theFeedDecimatesAllButTheHealth() throws IOException {
    Feed feed = new Feed(null, "", sink, () -> now);
    for (int i = 0; i < 1000; ++i) {
      now = 0.001 * i;
      posterior_t posterior = Messages.posterior(i);
      posterior.utime = 1000L * i;
      feed.messageReceived(null, "EST_POSTERIOR", bytes(posterior));
      feed.messageReceived(null, "EST_STATUS", bytes(Messages.status(i)));
    }
    Check.that(taken[0] <= 26 && taken[0] >= 24, taken[0] + " posteriors of 1000 in a second");
    Check.equal(1000, taken[2]);
  }

  public void aHeapOfLateMessagesIsNotDropped() throws IOException {
    Feed feed = new Feed(null, "", sink, () -> now);
    for (int i = 0; i < 10; ++i) {
      now = i == 0 ? 0 : 1;  // nine of them after a second of standstill
      posterior_t posterior = Messages.posterior(i);
      posterior.utime = 100_000L * i;
      feed.messageReceived(null, "EST_POSTERIOR", bytes(posterior));
    }
    Check.equal(10, taken[0]);
  }

  public void theFeedCountsStrangers() throws IOException {
    Feed feed = new Feed(null, "", sink, () -> now);
    feed.messageReceived(null, "EST_STATUS", bytes(Messages.estimate(1)));
    feed.messageReceived(null, "EST_STATUS", new LCMDataInputStream(new byte[3]));
    Check.equal(2L, feed.undecodable());
    Check.equal(0, taken[2]);
  }

  public void thePrefixIsWhatStandsBeforeTheName() {
    Check.equal("", Channels.prefix("EST_STATUS"));
    Check.equal("robot/left_", Channels.prefix("robot/left_EST_POSTERIOR"));
    Check.equal("", Channels.prefix("SOMETHING_ELSE"));
  }

  public void theBusIsThatOfLcmSpy() {
    Check.equal("a", BusUrl.choose("a", "lcm.spy.Spy -l b", "c"));
    Check.equal("b", BusUrl.choose(null, "lcm.spy.Spy -l b", "c"));
    Check.equal("b", BusUrl.choose(null, "lcm.spy.Spy --lcm-url=b", "c"));
    Check.equal("c", BusUrl.choose("", "lcm.spy.Spy", "c"));
    Check.equal(null, BusUrl.choose(null, null, ""));
  }
}
