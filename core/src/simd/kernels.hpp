#pragma once

#include <string_view>

#include "armcmc/density_block.hpp"
#include "armcmc/end_of_pack.hpp"
#include "armcmc/expression/operation.hpp"
#include "armcmc/mode_data.hpp"
#include "armcmc/noise_model.hpp"
#include "armcmc/nonblocking.hpp"
#include "armcmc/parameter_space.hpp"
#include "armcmc/plant/state_run.hpp"
#include "armcmc/power_series.hpp"
#include "armcmc/quadratic_form.hpp"

namespace armcmc::simd {

inline constexpr int kMaxMomentRows = 10;

/// prior_t at scored candidates: initial_share P_0 + sum_b memory_share[b] (density of block b of the memory).
struct PriorTerms {
  const double* initial = nullptr;
  const double* memory[3] = {};  ///< Readable also where the share is 0.
  double initial_share = 1.0;
  double memory_share[3] = {};
};

inline constexpr double kMostTilt = 30.0;

/// See Kernels::reweigh, tilt.
struct QuadraticControl {
  int dim = 0;
  double most = 1.0;
  double constant = 0.0;
  double centre[kMaxParams] = {};
  double slope[kMaxParams] = {};
  double curvature[kMaxParams][kMaxParams] = {};  ///< Lower triangle; the rest is not read.
};

/// The hot loops, once per instruction set. All work on kTileLanes candidates side by side, one candidate a lane:
/// sums run in data order whatever the lane count, so sets that fuse multiply and add (AVX2, AVX-512, NEON) give the
/// same bits, and so do those that do not (SSE2, portable).
struct Kernels {
  std::string_view name;

  /// tile[n][lane] = F(x_n, theta[., lane]) for all samples of `data`. `model` indexes CompiledModels(); effects,
  /// and the law of a described plant, come with `data`.
  void (*predict)(int model, const ModeData& data, const ThetaTile& theta,
                  PredictionTile* tile) noexcept ARMCMC_NONBLOCKING;

  /// predict() of the lanes of the first half at least, which takes a long tape little more than half of the time; the
  /// others hold nothing of use.
  void (*predict_half)(int model, const ModeData& data, const ThetaTile& theta,
                       PredictionTile* tile) noexcept ARMCMC_NONBLOCKING;

  /// The states of a described plant at the last sample of the pack of `data`, and its law as predict() has it but for
  /// data.start_fit, with starts that are `offset` from those of data.states.
  void (*run_states)(const ModeData& data, const ThetaTile& theta, const StateTile& offset, StateTile* end,
                     PredictionTile* law) noexcept ARMCMC_NONBLOCKING;

  /// out[lane] = sum_n log p((target_n - tile[n][lane] - noise mean) weight_n), in nats, at scale exp(log_scale[lane]).
  void (*log_likelihood)(const NoiseModel& noise, const ModeData& data, const PredictionTile& tile,
                         const double* log_scale, double* out) noexcept ARMCMC_NONBLOCKING;

  /// predict, then log_likelihood, in one; under Gaussian noise, where every sample depends on its own inputs alone
  /// (no delays, lags or limits), the predictions never reach memory. Powers carry a relative error of 4e-11.
  /// `scratch` holds nothing of use afterwards.
  void (*score)(int model, const NoiseModel& noise, const ModeData& data, const ThetaTile& theta,
                const double* log_scale, PredictionTile* scratch, double* out) noexcept ARMCMC_NONBLOCKING;

  /// score() of two tiles: the same bits, in less time where a plant's tape is long. log_scale[lane] and out[lane] of
  /// the second tile follow those of the first.
  void (*score_two)(int model, const NoiseModel& noise, const ModeData& data, const ThetaPair& theta,
                    const double* log_scale, PredictionTile* scratch, double* out) noexcept ARMCMC_NONBLOCKING;

  /// The power of a compiled law without effects at the samples of `data`, about middle[d] for exponents within
  /// reach[d], d the parameter that is the exponent.
  void (*expand_power)(int model, const ModeData& data, const double* middle, const double* reach,
                       PowerSeries* series) noexcept ARMCMC_NONBLOCKING;

  /// score() of the first `lanes` candidates, where a PowerSeries of the law has its parameter and the noise is not
  /// Gaussian, with powers from the series; what stands for a candidate whose exponent is out of reach is of no use.
  /// series null: the bits of score(). The other lanes of out hold nothing of use.
  void (*score_near)(int model, const NoiseModel& noise, const ModeData& data, const PowerSeries* series,
                     const ThetaTile& theta, const double* log_scale, int lanes,
                     double* out) noexcept ARMCMC_NONBLOCKING;

  /// Sums over the samples that make a QuadraticForm, for each lane: of law errors and of what the law changes by from
  /// prediction[0] to prediction[1 + i], weighted, in the form's order and with its factors. Those errors and changes
  /// are left in `prediction`.
  void (*quadratic_sums)(const ModeData& data, double noise_mean, int num_linear, PredictionTile* prediction,
                         double* const* sums) noexcept ARMCMC_NONBLOCKING;

  /// sums[j][k] = factor sum_n rows.value[n][j] columns.value[n][k], kTileLanes of each.
  void (*quadratic_products)(int num_samples, const PredictionTile& rows, const PredictionTile& columns, double factor,
                             double* sums) noexcept ARMCMC_NONBLOCKING;

  /// out[lane] = Gaussian log-likelihood of u[., first + lane], whose squared errors the form has.
  void (*score_quadratic)(const QuadraticForm& form, const ParameterSpace& space, const NoiseModel& noise,
                          int num_samples, const double* const* u, int first, double* out) noexcept ARMCMC_NONBLOCKING;

  /// out[lane] += factor * p(u[., first + lane]).
  void (*add_density)(const DensityBlock& block, const double* const* u, int first, double factor,
                      double* out) noexcept ARMCMC_NONBLOCKING;

  /// out[lane] = P_0(u[., first + lane]): 0 outside the bounds.
  void (*initial_prior)(const ParameterSpace& space, const double* const* u, int first,
                        double* out) noexcept ARMCMC_NONBLOCKING;

  /// theta[.][lane] and log_scale[lane] of the candidates u[., first + lane].
  void (*to_physical)(const ParameterSpace& space, const double* const* u, int first, ThetaTile* theta,
                      double* log_scale) noexcept ARMCMC_NONBLOCKING;

  /// out[k] = number first + k * stride of the stream that starts at `origin`, uniform on (0, 1). count a multiple
  /// of 8.
  void (*uniforms)(std::uint64_t origin, std::uint64_t first, std::uint64_t stride, int count,
                   double* out) noexcept ARMCMC_NONBLOCKING;

  /// out[k] = uniform number first + member[k] * stride of the stream. count a multiple of 8.
  void (*uniforms_of)(std::uint64_t origin, std::uint64_t first, std::uint64_t stride, const std::int16_t* member,
                      int count, double* out) noexcept ARMCMC_NONBLOCKING;

  /// choice[k] = number of bounds[0, num_bounds) that are <= pick[k]. count a multiple of 8.
  void (*choose)(const double* pick, const double* bounds, int num_bounds, int count,
                 std::int8_t* choice) noexcept ARMCMC_NONBLOCKING;

  /// Maps count draws of dim uniforms to draws of the block, in place: x[d][k]. count a multiple of 8.
  void (*draw_block)(const DensityBlock& block, int count, double* const* x) noexcept ARMCMC_NONBLOCKING;

  /// sums[0] = sum w, sums[1] = sum w^2, sums[2 + d] = sum w u_d over [0, count); u[d] and w padded to a multiple of 8
  /// with w = 0.
  void (*first_moments)(int dim, const double* const* u, const double* w, int count,
                        double* sums) noexcept ARMCMC_NONBLOCKING;

  /// sums = lower triangle, row by row, of sum w (u - mean)(u - mean)' over `dim` <= kMaxMomentRows rows. Padding as
  /// above.
  void (*second_moments)(int dim, const double* const* u, const double* w, const double* mean, int count,
                         double* sums) noexcept ARMCMC_NONBLOCKING;

  /// e[i][k] = straightened coordinate i of u[., k] for k in [0, count), before `center` and `scale`.
  void (*straighten)(const DensityBlock& block, const double* const* u, int count,
                     double* const* e) noexcept ARMCMC_NONBLOCKING;

  /// With c = z_0 clamped: sums[q] = sum w c^q for q in [0, 2 kDegree], then for each i in [1, dim) kDegree + 1 sums
  /// w c^q z_i.
  void (*bend_moments)(int dim, const double* const* z, const double* w, int count,
                       double* sums) noexcept ARMCMC_NONBLOCKING;

  /// Adds draws to num_nodes - 1 cells between nodes. With place = e[k] per_node + origin, held to the nodes, and
  /// j = floor(place): cells[2 j] += w[k], cells[2 j + 1] += w[k] (place - j). Padding as above.
  void (*histogram)(const double* e, const double* w, int count, double per_node, double origin, int num_nodes,
                    double* cells) noexcept ARMCMC_NONBLOCKING;

  /// out[k] = exp(log_likelihood[k] - reference), k in [0, count), count a multiple of the lanes of any set (8).
  void (*relative_likelihood)(const double* log_likelihood, double reference, int count,
                              double* out) noexcept ARMCMC_NONBLOCKING;

  /// Largest finite value[k] where inside[k] > 0, -infinity if there is none. `count` as above, also below.
  double (*largest_inside)(const double* value, const double* inside, int count) noexcept ARMCMC_NONBLOCKING;

  /// weight[k], a relative likelihood, becomes weight[k] prior_t / proposal[k]; 0 outside the bounds and where that is
  /// not finite. proposal may be null: no division then.
  void (*weigh)(const PriorTerms& prior, const double* proposal, int count, double* weight) noexcept ARMCMC_NONBLOCKING;

  /// first_share[k] = part of prior_t that is the memory's first block; sums = {sum w first_share, sum w (part that is
  /// P_0)} with weights padded by 0.
  void (*share_prior)(const PriorTerms& prior, const double* weight, int count, double* first_share,
                      double* sums) noexcept ARMCMC_NONBLOCKING;

  /// weight[k] *= exp(q(u[., k]) - log_likelihood[k]), q = constant + (slope + curvature z)' z with z = u - centre: as
  /// if q were the log-likelihood. An exponent beyond +-kMostTilt is held there; a weight of 0 stays 0. count as above.
  void (*tilt)(const QuadraticControl& control, const double* const* u, const double* log_likelihood, int count,
               double* weight) noexcept ARMCMC_NONBLOCKING;

  /// out[k] = value[k] / by; out may be value. count a multiple of 8.
  void (*divide)(const double* value, double by, int count, double* out) noexcept ARMCMC_NONBLOCKING;

  /// out[k] = a[k] / b[k]; 0 where b[k] is not positive. count a multiple of 8.
  void (*ratio)(const double* a, const double* b, int count, double* out) noexcept ARMCMC_NONBLOCKING;

  /// u[k] = end(v[k]), to the last bit. count a multiple of 8.
  void (*move_to_end)(const EndOfPack& end, const double* v, int count, double* u) noexcept ARMCMC_NONBLOCKING;

  /// Number of k with choice[k] < limit, and of those with inside[k] > 0 too. count a multiple of 8.
  struct Chosen {
    int chosen, inside;
  };
  Chosen (*count_chosen)(const std::int8_t* choice, int limit, const double* inside,
                         int count) noexcept ARMCMC_NONBLOCKING;

  /// weight[k] *= max(0, most - g[k] (constant + sum_i z_i (slope_i + sum_{j <= i} curvature_ij z_j))) with
  /// z_i = u_i[k] - centre_i. @return their sum. count a multiple of 8.
  double (*reweigh)(const QuadraticControl& control, const double* const* u, const double* g, int count,
                    double* weight) noexcept ARMCMC_NONBLOCKING;

  /// First k with the largest a[k] b[k], all of them >= 0; b may be null, which is 1.
  int (*largest_product)(const double* a, const double* b, int count) noexcept ARMCMC_NONBLOCKING;

  /// See expression::Elementary().
  bool (*elementary)(expression::Op op, std::size_t count, const double* a, const double* b,
                     double* out) noexcept ARMCMC_NONBLOCKING;
};

/// The widest set that this CPU runs, or the one that Use() chose.
[[nodiscard]] const Kernels& Best() noexcept;

/// See UseInstructionSet().
bool Use(std::string_view name) noexcept;

extern const Kernels kPortableKernels;  ///< Pairs of doubles; nothing is fused. "sse2" on x86-64.
#if defined(ARMCMC_HAVE_AVX2)
extern const Kernels kAvx2Kernels;
#endif
#if defined(ARMCMC_HAVE_AVX512)
extern const Kernels kAvx512Kernels;
#endif
#if defined(ARMCMC_HAVE_NEON)
extern const Kernels kNeonKernels;
#endif

}  // namespace armcmc::simd
