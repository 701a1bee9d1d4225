package armcmc.spy;

/** Finds the bus that lcm-spy listens to: the panels listen to the same, which its plug-in interface does not tell. */
public final class BusUrl {
  private BusUrl() {}

  /** @return null when LCM's default is meant */
  public static String find() {
    return choose(System.getProperty("armcmc.lcm_url"), System.getProperty("sun.java.command"), System.getenv("LCM_DEFAULT_URL"));
  }

  /** @param command the command line of the program, as lcm-spy understands it: "-l URL" or "--lcm-url=URL" */
  static String choose(String property, String command, String environment) {
    if (property != null && !property.isEmpty()) return property;
    String[] words = command == null ? new String[0] : command.trim().split("\\s+");
    for (int i = 0; i < words.length; ++i) {
      if (words[i].startsWith("--lcm-url=")) return words[i].substring("--lcm-url=".length());
      if (words[i].equals("-l") && i + 1 < words.length) return words[i + 1];
      if (words[i].startsWith("-l") && words[i].length() > 2) return words[i].substring(2);
    }
    return environment == null || environment.isEmpty() ? null : environment;
  }
}
