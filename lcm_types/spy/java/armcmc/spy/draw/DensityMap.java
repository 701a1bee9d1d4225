package armcmc.spy.draw;

import armcmc.spy.model.DensityHistory;
import java.awt.image.BufferedImage;
import java.util.Arrays;
import java.util.List;

/** The posteriors of the last seconds as colours: time to the right, the parameter upwards. */
final class DensityMap {
  private DensityMap() {}

  /** Each column is scaled to its own peak: a sharp posterior would leave a broad one black. */
  static void draw(Plot plot, List<DensityHistory.Entry> entries, double now) {
    int width = plot.area.width;
    int height = plot.area.height;
    BufferedImage image = new BufferedImage(width, height, BufferedImage.TYPE_INT_RGB);
    int[] pixels = new int[width * height];
    Arrays.fill(pixels, Palette.GRID.getRGB());
    for (int k = 0; k < entries.size(); ++k) {
      DensityHistory.Entry entry = entries.get(k);
      double end = k + 1 < entries.size() ? entries.get(k + 1).time : now;
      // A posterior stands until the next comes; a longer silence is a gap.
      end = Math.min(end, entry.time + 0.6);
      int from = Math.max(0, column(plot, entry.time - now));
      int to = Math.min(width, column(plot, end - now));
      if (from < to) fill(pixels, width, height, from, to, entry, plot);
    }
    image.setRGB(0, 0, width, height, pixels, 0, width);
    plot.pen().g.drawImage(image, plot.area.x, plot.area.y, null);
  }

  private static int column(Plot plot, double t) { return (int) Math.round(plot.x.at(t) * plot.area.width); }

  private static void fill(int[] pixels, int width, int height, int from, int to, DensityHistory.Entry entry, Plot plot) {
    double peak = entry.density.peak();
    for (int row = 0; row < height; ++row) {
      double value = plot.y.value(1 - (row + 0.5) / height);
      int rgb = ColourMap.rgb(entry.density.at(value) / peak);
      Arrays.fill(pixels, row * width + from, row * width + to, rgb);
    }
  }
}
