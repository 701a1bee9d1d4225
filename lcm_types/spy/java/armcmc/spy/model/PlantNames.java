package armcmc.spy.model;

import armcmc.data_pack_t;

/** What the numbers of the messages are called, as data_pack_t and plant_truth_t say. */
public final class PlantNames {
  private PlantNames() {}

  public static String mode(int plant, int mode) {
    if (plant == data_pack_t.PLANT_HUNT_CROSSLEY) return pick(mode, "contact", "free");
    if (plant == data_pack_t.PLANT_SOFT_ACTUATOR) return pick(mode, "u_c", "u_d", "shut");
    return "mode " + mode;
  }

  public static String output(int plant) {
    if (plant == data_pack_t.PLANT_HUNT_CROSSLEY) return "contact force";
    if (plant == data_pack_t.PLANT_SOFT_ACTUATOR) return "bending angle";
    return "output";
  }

  public static String outputUnit(int plant) {
    if (plant == data_pack_t.PLANT_HUNT_CROSSLEY) return "N";
    if (plant == data_pack_t.PLANT_SOFT_ACTUATOR) return "rad";
    return "";
  }

  public static String decision(int decision) { return pick(decision, "hold", "reinforcement", "modification"); }

  private static String pick(int i, String... names) { return i >= 0 && i < names.length ? names[i] : "mode " + i; }
}
