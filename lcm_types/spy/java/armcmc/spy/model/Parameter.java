package armcmc.spy.model;

/** A parameter's name and unit. */
public final class Parameter {
  public final String name;
  public final String unit;

  public Parameter(String name, String unit) {
    this.name = name;
    this.unit = unit;
  }

  /** Its name before the first estimate gives it one. */
  public static Parameter unnamed(int i) { return new Parameter("parameter " + (i + 1), ""); }

  public boolean hasUnit() { return !unit.isEmpty() && !unit.equals("-"); }

  /** Short enough for the side of a small chart: the unit, or the name of what has none. */
  public String axisLabel() { return hasUnit() ? "[" + unit + "]" : name + " [-]"; }

  public String label() { return Text.label(name, unit); }
}
