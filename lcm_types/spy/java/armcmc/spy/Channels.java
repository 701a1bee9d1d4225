package armcmc.spy;

/** The channels of one estimator and its plant: seven names behind one prefix. */
public final class Channels {
  public static final String PACK = "PLANT_PACK";
  public static final String PACK_V2 = "PLANT_PACK_V2";
  public static final String TRUTH = "PLANT_TRUTH";
  public static final String ESTIMATE = "EST_ESTIMATE";
  public static final String POSTERIOR = "EST_POSTERIOR";
  public static final String CHANGE = "EST_CHANGE";
  public static final String STATUS = "EST_STATUS";

  static final String[] ALL = {PACK, PACK_V2, TRUTH, ESTIMATE, POSTERIOR, CHANGE, STATUS};

  private Channels() {}

  /** What stands before the known name of a channel; empty when the channel has another name. */
  public static String prefix(String channel) {
    for (String name : ALL) {
      if (channel.endsWith(name)) return channel.substring(0, channel.length() - name.length());
    }
    return "";
  }
}
