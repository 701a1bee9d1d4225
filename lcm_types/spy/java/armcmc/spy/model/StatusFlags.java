package armcmc.spy.model;

import armcmc.estimator_status_t;
import java.util.ArrayList;
import java.util.List;

/** The flags of estimator_status_t in words. */
public final class StatusFlags {
  private StatusFlags() {}

  public static List<String> degraded(int flags) {
    List<String> words = new ArrayList<>();
    add(words, flags, estimator_status_t.DEGRADED_NO_FIFO, "no real-time scheduling (SCHED_FIFO)");
    add(words, flags, estimator_status_t.DEGRADED_NO_AFFINITY, "threads not pinned to CPUs");
    add(words, flags, estimator_status_t.DEGRADED_NO_MLOCK, "memory not locked");
    add(words, flags, estimator_status_t.DEGRADED_SHARED_CPU, "stages share one CPU");
    add(words, flags, estimator_status_t.DEGRADED_NO_WITNESS, "no witness");
    add(words, flags, estimator_status_t.DEGRADED_INJECTED, "injected faults");
    add(words, flags, estimator_status_t.DEGRADED_CPUS_SLEEP, "CPUs sleep when idle");
    addUnknown(words, flags, 127);
    return words;
  }

  public static List<String> faults(int flags) {
    List<String> words = new ArrayList<>();
    add(words, flags, estimator_status_t.FAULT_PLANT_SILENT, "plant is silent");
    add(words, flags, estimator_status_t.FAULT_PLANT_RESTARTED, "plant was restarted");
    add(words, flags, estimator_status_t.FAULT_BAD_DATA, "bad data");
    add(words, flags, estimator_status_t.FAULT_TRUNCATED, "draws cut by the deadline");
    add(words, flags, estimator_status_t.FAULT_PUBLISH, "publishing failed");
    add(words, flags, estimator_status_t.FAULT_BACKLOG, "backlog dropped");
    add(words, flags, estimator_status_t.FAULT_NUMERIC, "numeric trouble");
    add(words, flags, estimator_status_t.FAULT_CLOCK_JUMP, "the plant's clock jumped");
    add(words, flags, estimator_status_t.FAULT_BUS_FLOOD, "bus flooded");
    add(words, flags, estimator_status_t.FAULT_STAGE_HUNG, "a stage hangs");
    add(words, flags, estimator_status_t.FAULT_SNAPSHOT, "snapshot not written");
    addUnknown(words, flags, 2047);
    return words;
  }

  private static void add(List<String> words, int flags, int flag, String word) {
    if ((flags & flag) != 0) words.add(word);
  }

  private static void addUnknown(List<String> words, int flags, int known) {
    if ((flags & ~known) != 0) words.add("unknown flag " + (flags & ~known));
  }
}
