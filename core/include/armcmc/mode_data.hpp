#pragma once

#include <array>
#include <cstdint>

#include "armcmc/nonblocking.hpp"
#include "armcmc/types.hpp"

namespace armcmc {

namespace expression {
struct Tape;
struct TapeScalars;
}  // namespace expression
struct CompiledPack;
struct StateRun;
struct StartFit;

inline constexpr int kMaxFeatures = 6;  ///< Precomputed inputs a model may keep for each sample.
inline constexpr int kTileLanes = 32;   ///< Candidates scored side by side.

/// Arrays of candidates are padded to whole tiles.
[[nodiscard]] constexpr int RoundUpToTile(int n) noexcept { return (n + kTileLanes - 1) / kTileLanes * kTileLanes; }

/// The samples of one pack that belong to one mode, in time order, as the scoring kernels read them.
struct alignas(64) ModeData {
  int num_samples = 0;
  double pack_share = 1.0;                       ///< num_samples over the samples of the whole pack, in (0, 1].
  double time_s = 0.0;                           ///< Plant time of the last sample of the whole pack.
  double duration_s = 0.0;                       ///< Duration of the whole pack, s.
  double interval_s = 0.0;                       ///< Between two samples of the whole pack.
  int pack_samples = 0;                          ///< Of the whole pack.
  std::array<double, kMaxPackSamples> target{};  ///< What the model predicts, unit of the regression target.
  std::array<double, kMaxPackSamples> weight{};  ///< exp(-rho (N_s - n)), in (0, 1].
  std::array<std::array<double, kMaxPackSamples>, kMaxFeatures> feature{};  ///< Meaning fixed by the model.
  bool weighted = true;  ///< false: every weight is 1, and is not read for scoring.
  // Of a compiled plant with effects, else null: the prediction comes from there, features are not read.
  const CompiledPack* compiled = nullptr;
  int mode = 0;  ///< Mode in `compiled`.
  // Of a described plant: its law, law - target, and what no parameter changes, one row per sample of the pack. Modes
  // that are sampled together have one law each.
  const expression::Tape* tape = nullptr;
  const expression::Tape* error_tape = nullptr;
  int num_tapes = 1;
  const std::uint8_t* law = nullptr;  ///< Which of several laws acts, one number per sample of the pack.
  const expression::TapeScalars* scalars = nullptr;
  const double* past = nullptr;      ///< PastLines::value of the pack.
  const StateRun* states = nullptr;  ///< Trajectories over the pack; null: the plant has no states.
  const StartFit* start_fit =
      nullptr;  ///< Removes from the errors what an uncertain start can explain; null: the start is certain.
  std::array<std::int16_t, kMaxPackSamples> sample{};  ///< Index in the pack.

  /// From sample n to the end of the pack, s.
  [[nodiscard]] double TimeToEnd(int n) const noexcept ARMCMC_NONBLOCKING {
    return interval_s * (pack_samples - 1 - sample[static_cast<std::size_t>(n)]);
  }
};

/// Predictions of kTileLanes candidates: value[n][lane].
struct alignas(64) PredictionTile {
  std::array<std::array<double, kTileLanes>, kMaxPackSamples> value;
};

/// Physical parameters of kTileLanes candidates: value[parameter][lane].
struct alignas(64) ThetaTile {
  std::array<std::array<double, kTileLanes>, kMaxParams> value;
};
/// Two tiles that are scored in one pass over the samples.
using ThetaPair = std::array<ThetaTile, 2>;

}  // namespace armcmc
