package armcmc.spy.draw;

/** Dark is improbable, bright is probable; lightness grows evenly, so that it reads without colours, too. */
final class ColourMap {
  private static final int[] ANCHORS = {0x0B1026, 0x16255A, 0x1B4A84, 0x1C7093, 0x2C9599, 0x5BB78F, 0x9DD47F, 0xDDEB8B, 0xFFFCCB};
  private static final int[] TABLE = table();

  private ColourMap() {}

  /** @param level [0, 1]; 0xRRGGBB */
  static int rgb(double level) {
    return TABLE[(int) Math.round(255 * Math.max(0, Math.min(1, level)))];
  }

  private static int[] table() {
    int[] table = new int[256];
    for (int i = 0; i < 256; ++i) {
      double position = i / 255.0 * (ANCHORS.length - 1);
      int left = Math.min((int) position, ANCHORS.length - 2);
      table[i] = mix(ANCHORS[left], ANCHORS[left + 1], position - left);
    }
    return table;
  }

  private static int mix(int a, int b, double weight) {
    int mixed = 0;
    for (int shift = 0; shift <= 16; shift += 8) {
      int x = (a >> shift) & 255;
      int y = (b >> shift) & 255;
      mixed |= (int) Math.round(x + weight * (y - x)) << shift;
    }
    return mixed;
  }
}
