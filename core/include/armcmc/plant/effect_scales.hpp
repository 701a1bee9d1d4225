#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "armcmc/plant/description.hpp"

namespace armcmc {

/// Sizes of one quantity, in its unit.
struct QuantityScale {
  double mean = 0.0;
  double rms = 1.0;   ///< About the mean; > 0.
  double low = -2.0;  ///< Least and greatest value.
  double high = 2.0;
  double rate = 0.0;  ///< Size of its rate; 0: rms times 2 pi over the period.
};

/// What the priors of an effect are measured in.
struct DataScales {
  double dt = 0.01;                               ///< s, between samples.
  double record = 10.0;                           ///< s, from the first sample to the last.
  double start = 0.0;                             ///< s, time of the first sample.
  double period = 1.0;                            ///< s, in which the output oscillates.
  double noise = 1.0;                             ///< Standard deviation, unit of the output.
  std::map<std::string, QuantityScale> quantity;  ///< Of every signal and state, by name.
};

/// Scales of a recording.
/// @param columns  Of every signal in the order of the file, equally long; an empty one: not recorded.
/// @param times    s, of every row, increasing.
/// States have the scale of a signal with their unit, first one of their role; else that of a signal whose rate has
/// their unit, times 2 pi / period a rate; else 1. The rate of a state is at least a tenth of the largest term in it,
/// |d rate / d x| times the rms of x: where a state is damped heavily, its terms cancel and its rate says little of
/// them.
/// @throws PlantError where there are fewer than two rows or lengths differ.
[[nodiscard]] DataScales MeasuredScales(const PlantDescription& plant, const std::vector<std::vector<double>>& columns,
                                        const std::vector<double>& times);

/// Scales where no data is at hand: a guess that a plant file says enough for.
///
/// The output varies by 30 standard deviations of the noise. A signal x varies by the output over the size
/// (|mean| + sd, of a lognormal prior the median) of a parameter whose unit is the output's over that of x; rates
/// follow from what they are the rate of, with a period of 1 s, and vice versa; all other signals are 1 in
/// their unit.
[[nodiscard]] DataScales DefaultScales(const PlantDescription& plant);

/// Value of a size such as "0.3*output" or "2*dt" or "high_x + 0.1*range_x".
///
/// Names: dt, record, start, period, noise; of the output, and of each name in `bound` (name -> quantity of the plant):
/// NAME (rms about the mean), mean_NAME, low_NAME, high_NAME, range_NAME (high - low), rate_NAME (NAME times 2 pi /
/// period). A bound parameter has |mean| + sd, a constant |value|.
/// @throws expression::Error, UnknownName with the column.
[[nodiscard]] double ScaleValue(std::string_view text, const PlantDescription& plant, const DataScales& scales,
                                const std::map<std::string, std::string>& bound);

}  // namespace armcmc
