package armcmc.spy.model;

import java.util.ArrayDeque;
import java.util.ArrayList;
import java.util.List;

/** The marginal posteriors of one parameter over the last seconds. */
public final class DensityHistory {
  /** One posterior and when it came, s. */
  public static final class Entry {
    public final double time;
    public final Density density;

    Entry(double time, Density density) {
      this.time = time;
      this.density = density;
    }
  }

  private final double window;
  private final double resolution;
  private final ArrayDeque<Entry> entries = new ArrayDeque<>();

  /** @param window s, what is kept; @param resolution s: of posteriors that are nearer to each other the last stays */
  public DensityHistory(double window, double resolution) {
    this.window = window;
    this.resolution = resolution;
  }

  public void add(double time, Density density) {
    double from = time;
    Entry newest = entries.peekLast();
    if (newest != null && time - newest.time < resolution) {
      from = newest.time;
      entries.removeLast();
    }
    entries.addLast(new Entry(from, density));
    while (entries.peekFirst().time < time - window) entries.removeFirst();
  }

  /** Oldest first. */
  public List<Entry> entries() { return new ArrayList<>(entries); }

  /** The newest, or null. */
  public Density newest() { return entries.isEmpty() ? null : entries.peekLast().density; }
}
