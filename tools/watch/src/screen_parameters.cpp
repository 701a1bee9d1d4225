#include <algorithm>
#include <cmath>
#include <span>

#include "armcmc/support/text_table.hpp"
#include "armcmc/watch/names.hpp"
#include "screen_parts.hpp"

namespace armcmc::watch {
namespace {

using support::Significant;

// Columns where the fields of a row begin.
constexpr int kUnit = 10, kMean = 22, kInterval = 44, kRight = 66;
constexpr int kTruth = 10, kDrift = 12;
// Where the pictures stand below: the drift with its unit before them.
constexpr int kDriftBelow = 33;

/// Where the sparklines of a row stand, and how wide they are.
struct Pictures {
  bool below = false;  ///< On a line of their own, where the terminal is narrow.
  int mean_at = 0, mean = 0;
  int density_at = 0, density = 0;
};

Pictures Layout(int columns) {
  Pictures p;
  p.below = columns < 110;
  p.mean_at = p.below ? kUnit + kDriftBelow : kRight + kTruth + kDrift + 1;
  const int room = std::max(2, columns - p.mean_at - 2);
  p.density = std::min(32, room / 2);
  p.mean = std::min(60, room - p.density - 1);
  p.density_at = p.mean_at + p.mean + 1;
  return p;
}

/// Rate of the drift of a parameter of the mode that is reported; NaN: nothing is known.
double DriftRate(const WatchState& state, int i) {
  if (!state.change || i >= state.change->n_params) return std::nan("");
  const change_t& c = *state.change;
  const int mode = std::clamp<int>(c.mode, 0, change_t::MAX_MODES - 1);
  return c.known[mode] != 0 ? c.drift_rate[mode][i] : std::nan("");
}

std::string DensityOf(const WatchState& state, int i, int columns, Glyphs glyphs) {
  if (!state.posterior || state.posterior->known == 0 || i >= state.posterior->n_params) return "";
  const posterior_t& p = *state.posterior;
  const int bins = std::clamp<int>(p.n_bins, 1, posterior_t::MAX_BINS);
  return DensityLine(std::span<const double>(p.density[i], static_cast<std::size_t>(bins)), std::min(columns, bins),
                     glyphs);
}

TextLine Numbers(const WatchState& state, int i) {
  const estimate_t& e = *state.estimate;
  TextLine line;
  line.AddLeft(FieldText(e.param_name[i], 16), kUnit - 1, Ink::kBold).To(kUnit);
  line.AddLeft(FieldText(e.param_unit[i], 16), kMean - kUnit - 1).To(kMean);
  if (e.known == 0) {
    line.Add("not known yet", Ink::kDim);
    return line;
  }
  line.AddRight(Significant(e.ar_ap[i], 5), 10, Ink::kBold).AddRight(Significant(e.sd[i], 3), 11).To(kInterval);
  line.Add(" [").Add(Significant(e.q025[i], 5)).Add(", ").Add(Significant(e.q975[i], 5)).Add("]").To(kRight);
  const double truth = state.truth ? TrueValue(*state.truth, e, i) : std::nan("");
  if (std::isfinite(truth)) line.AddRight(Significant(truth, 5), kTruth);
  return line;
}

void AddDrift(const WatchState& state, int i, const Pictures& pictures, TextLine* line) {
  const double rate = DriftRate(state, i);
  if (std::isnan(rate)) return;
  if (!pictures.below) {
    line->To(kRight + kTruth).AddRight(Significant(rate, 3), kDrift);
    return;
  }
  const std::string unit = PerSecond(FieldText(state.estimate->param_unit[i], 16));
  line->To(kUnit).Add("drifts ", Ink::kDim).Add(Significant(rate, 3)).Add(" " + unit, Ink::kDim);
}

void AddPictures(const WatchState& state, const View& view, int i, const Pictures& pictures, TextLine* line) {
  const std::vector<double> means =
      state.means[static_cast<std::size_t>(i)].Newest(static_cast<std::size_t>(pictures.mean));
  line->To(pictures.mean_at).Add(Sparkline(means, view.glyphs), Ink::kGood);
  line->To(pictures.density_at).Add(DensityOf(state, i, pictures.density, view.glyphs), Ink::kGood);
}

TextLine Head(const WatchState& state, const Pictures& pictures) {
  TextLine head;
  head.Add("parameter", Ink::kDim).To(kUnit).Add("unit", Ink::kDim).To(kMean);
  head.AddRight("mean", 10, Ink::kDim).AddRight("sd", 11, Ink::kDim).To(kInterval).Add(" 95 % interval", Ink::kDim);
  head.To(kRight).AddRight(state.truth ? "truth" : "", kTruth, Ink::kDim);
  if (pictures.below) return head;
  head.AddRight(state.change ? "drift per s" : "", kDrift, Ink::kDim);
  head.To(pictures.mean_at).AddLeft("recent mean", pictures.mean, Ink::kDim);
  head.To(pictures.density_at).AddLeft("density", pictures.density, Ink::kDim);
  return head;
}

}  // namespace

void AddParameters(const WatchState& state, const View& view, std::vector<TextLine>* lines) {
  const Pictures pictures = Layout(view.columns);
  lines->push_back(Head(state, pictures));
  if (!state.estimate) {
    TextLine none;
    none.Add("no EST_ESTIMATE yet", Ink::kDim);
    lines->push_back(none);
  } else {
    const int n = std::clamp<int>(state.estimate->n_params, 0, estimate_t::MAX_PARAMS);
    for (int i = 0; i < n; ++i) {
      lines->push_back(Numbers(state, i));
      if (pictures.below) lines->emplace_back();
      AddDrift(state, i, pictures, &lines->back());
      AddPictures(state, view, i, pictures, &lines->back());
    }
  }
  lines->emplace_back();
}

}  // namespace armcmc::watch
