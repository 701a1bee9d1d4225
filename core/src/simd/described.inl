// Predicts and scores described plants by their tapes; included by kernels.inl, once per instruction set.

#include <algorithm>
#include <type_traits>

#include "simd/states.inl"

namespace armcmc::simd::ARMCMC_SIMD_NAMESPACE {
namespace {

/// The active one of several laws at sample n.
[[gnu::always_inline]] inline const Tape& TapeAt(const Tape* tapes, const ModeData& data, std::size_t n) noexcept {
  return data.law == nullptr ? *tapes : tapes[data.law[data.sample[n]]];
}

/// sum[v] = constant + sum of scalars x registers, for the vectors of a group.
/// @param lane0   Of the group's first lane in register 0; others are `stride` numbers apart.
template <int kGroup>
[[gnu::always_inline]] inline void TapeSumOf(const expression::TapeSum& terms, const double* row, const double* lane0,
                                             std::size_t stride, Simd::V* sum) noexcept {
  const Simd::V constant = terms.constant == expression::TapeSum::kNone ? Simd::V{} : Simd::Set(row[terms.constant]);
  for (int g = 0; g < kGroup; ++g) sum[g] = constant;
  for (std::size_t t = 0; t < terms.count; ++t) {
    const double* value = lane0 + terms.parameter[t] * stride;
    const Simd::V scalar = Simd::Set(terms.scalar[t] == expression::TapeSum::kNone ? 1.0 : row[terms.scalar[t]]);
    for (int g = 0; g < kGroup; ++g) sum[g] = Simd::Fma(Simd::Load(value + g * Simd::kLanes), scalar, sum[g]);
  }
}

/// Runs the laws, or their errors, at the samples of `data`, in order; place(n) is where lane 0 of the result
/// of sample n goes, the others behind it.
/// @tparam kSize       Candidates: the first half of a tile, or one, or two.
/// @param offset, end  Of the states of a plant that has some, and one tile: added to their starts, and them at the end
///                     of the pack; null: neither.
template <std::size_t kSize, class Place>
[[gnu::always_inline]] inline void RunSamples(const Tape* tapes, const ModeData& data, const ThetaTile* theta,
                                              Place place, const StateTile* offset = nullptr,
                                              StateTile* end = nullptr) noexcept {
  TapeRegisters<kSize> registers;  // NOLINT(cppcoreguidelines-pro-type-member-init): written before read
  for (std::size_t d = 0; d < static_cast<std::size_t>(tapes->num_parameters); ++d)
    for (std::size_t lane = 0; lane < kSize; lane += kTileLanes)
      std::copy_n(theta[lane / kTileLanes].value[d].data(), std::min<std::size_t>(kSize, kTileLanes),
                  registers.value[d].data() + lane);
  const auto start = [&] {
    for (int t = 0; t < data.num_tapes; ++t) StartTape(tapes[t], data.scalars->Row(0), &registers);
  };
  const auto one = [&](std::size_t n) {
    const Tape& tape = TapeAt(tapes, data, n);
    const double* row = data.scalars->Row(data.sample[n]);
    double* const result = place(n);
    if (tape.shape == expression::TapeShape::kLinear) {
      constexpr std::size_t kGroup = TapeGroup<kSize>::kVectors;
      for (std::size_t lane = 0; lane < kSize; lane += kGroup * Simd::kLanes) {
        Simd::V sum[kGroup];
        TapeSumOf<kGroup>(tape.rest, row, registers.value[0].data() + lane, kSize, sum);
        for (std::size_t v = 0; v < kGroup; ++v) Simd::Store(result + lane + v * Simd::kLanes, sum[v]);
      }
      return;
    }
    if (tape.size() > 0) RunTape(tape, row, data.past, &registers);
    std::copy_n(registers.value[tape.result[0]].data(), kSize, result);
  };
  const auto samples = static_cast<std::size_t>(data.num_samples);
  if (data.states == nullptr) {
    start();
    for (std::size_t n = 0; n < samples; ++n) one(n);
    return;
  }
  StateIntegrator<kSize> states(*data.states, data.scalars->Row(0), data.past, &registers, data.start_fit, offset);
  start();
  for (std::size_t n = 0; n < samples; ++n) {
    states.AdvanceTo(data.sample[n]);
    one(n);
  }
  if (end == nullptr) return;
  states.AdvanceTo(data.states->num_samples - 1);
  states.CopyTo(end);
}

/// Adds to the law of kSize candidates what makes its errors independent beside an uncertain start.
template <std::size_t kSize>
void FitStart(const StartFit& fit, const ModeData& data, PredictionTile* tile) noexcept {
  constexpr std::size_t kVectorsPerRow = kSize / Simd::kLanes;
  Simd::V along[kMaxStates][kVectorsPerRow] = {};
  const auto count = static_cast<std::size_t>(fit.count);
  const auto samples = static_cast<std::size_t>(data.num_samples);
  for (std::size_t n = 0; n < samples; ++n)
    for (std::size_t v = 0; v < kVectorsPerRow; ++v) {
      const Simd::V law = Simd::Load(tile->value[n].data() + v * Simd::kLanes);
      const Simd::V error = (Simd::Set(data.target[n]) - law) * Simd::Set(data.weight[n]);
      for (std::size_t j = 0; j < count; ++j)
        along[j][v] = Simd::Fma(error, Simd::Set(fit.direction[j][n]), along[j][v]);
    }
  for (std::size_t n = 0; n < samples; ++n)
    for (std::size_t j = 0; j < count; ++j) {
      const Simd::V part = Simd::Set(fit.shrink[j] * fit.direction[j][n] / data.weight[n]);
      for (std::size_t v = 0; v < kVectorsPerRow; ++v) {
        double* law = tile->value[n].data() + v * Simd::kLanes;
        Simd::Store(law, Simd::Fma(along[j][v], part, Simd::Load(law)));
      }
    }
}

template <std::size_t kSize>
void PredictTape(const ModeData& data, const ThetaTile& theta, PredictionTile* tile) noexcept ARMCMC_NONBLOCKING {
  RunSamples<kSize>(data.tape, data, &theta, [tile](std::size_t n) { return tile->value[n].data(); });
  if (data.start_fit != nullptr) FitStart<kSize>(*data.start_fit, data, tile);
}

void RunStates(const ModeData& data, const ThetaTile& theta, const StateTile& offset, StateTile* end,
               PredictionTile* law) noexcept ARMCMC_NONBLOCKING {
  RunSamples<kTileLanes>(
      data.tape, data, &theta, [law](std::size_t n) { return law->value[n].data(); }, &offset, end);
}

/// Sums of the squares of law - target, weighted, for kSize candidates; and of what the directions of a start have of
/// it. Several samples at a time: sums stay where arithmetic is done.
template <bool kWeighted, std::size_t kSize>
class SquareSums {
  static constexpr std::size_t kVectors = TapeGroup<kSize>::kVectors;  ///< At a time.
  static constexpr std::size_t kSamples = 8;

 public:
  explicit SquareSums(const ModeData& data) noexcept
      : data_(data), count_(data.start_fit != nullptr ? static_cast<std::size_t>(data.start_fit->count) : 0) {}

  /// Where the errors of sample n go; samples come in their order.
  double* Place(std::size_t n) noexcept {
    if (n == first_ + kSamples) Add(n);
    return error_[n - first_].data();
  }
  /// After the last sample. out[lane] = the sum.
  void Finish(double* out) noexcept {
    Add(static_cast<std::size_t>(data_.num_samples));
    for (std::size_t lane = 0; lane < kSize; lane += Simd::kLanes) {
      Simd::V sum = Simd::Load(sum_.data() + lane);
      // |e - sum_j shrink_j u_j (u_j' e)|^2
      for (std::size_t j = 0; j < count_; ++j) {
        const double kept = 1.0 - data_.start_fit->shrink[j];
        const Simd::V along = Simd::Load(along_[j].data() + lane);
        sum = Simd::Fma(along * along, Simd::Set(kept * kept - 1.0), sum);
      }
      Simd::Store(out + lane, sum);
    }
  }

 private:
  /// total[lane] += sum of term(error, sample) over the samples that are there.
  template <class Term>
  void AddTerms(std::size_t end, Term term, double* total) noexcept {
    for (std::size_t lane = 0; lane < kSize; lane += kVectors * Simd::kLanes) {
      Simd::V sum[kVectors];
      for (std::size_t v = 0; v < kVectors; ++v) sum[v] = Simd::Load(total + lane + v * Simd::kLanes);
      for (std::size_t n = first_; n < end; ++n) {
        const double* error = error_[n - first_].data() + lane;
        for (std::size_t v = 0; v < kVectors; ++v) sum[v] = term(Simd::Load(error + v * Simd::kLanes), n, sum[v]);
      }
      for (std::size_t v = 0; v < kVectors; ++v) Simd::Store(total + lane + v * Simd::kLanes, sum[v]);
    }
  }
  /// The samples from first_ to before `end`.
  void Add(std::size_t end) noexcept {
    if constexpr (kWeighted)
      for (std::size_t n = first_; n < end; ++n)
        for (double& error : error_[n - first_]) error *= data_.weight[n];
    AddTerms(
        end, [](Simd::V e, std::size_t, Simd::V sum) { return Simd::Fma(e, e, sum); }, sum_.data());
    for (std::size_t j = 0; j < count_; ++j)
      AddTerms(
          end,
          [direction = data_.start_fit->direction[j].data()](Simd::V e, std::size_t n, Simd::V sum) {
            return Simd::Fma(e, Simd::Set(direction[n]), sum);
          },
          along_[j].data());
    first_ = end;
  }

  const ModeData& data_;
  const std::size_t count_;
  std::size_t first_ = 0;  ///< Sample in row 0.
  alignas(64) std::array<std::array<double, kSize>, kSamples> error_;
  alignas(64) std::array<double, kSize> sum_{};
  alignas(64) std::array<std::array<double, kSize>, kMaxStates> along_{};
};

/// out[lane] = sum of the squares of law - target, weighted, for the lanes of kTiles.
template <bool kWeighted, std::size_t kTiles>
void SumTapeSquares(const ModeData& data, const ThetaTile* theta, double* out) noexcept {
  constexpr std::size_t kSize = kTiles * kTileLanes;
  SquareSums<kWeighted, kSize> sums(data);
  RunSamples<kSize>(data.error_tape, data, theta, [&sums](std::size_t n) { return sums.Place(n); });
  sums.Finish(out);
}

/// The same for tapes with a shape: as many vectors side by side as keep the arithmetic units busy, nothing in memory.
/// Powers carry a relative error of 4e-11, as those of the compiled laws do.
/// @tparam kPowers  Most that one has. @tparam kSeveral  There is more than one tape, and not all need have as many.
template <bool kWeighted, int kPowers, bool kSeveral>
void SumShapeSquares(const ModeData& data, const ThetaTile& theta, double* out) noexcept {
  constexpr int kGroup = Simd::kLanes == 8 ? 4 : 2;
  constexpr double kReach = 960.0;  // |exponent log2 x| that needs no clamp
  for (int lane = 0; lane < kTileLanes; lane += kGroup * Simd::kLanes) {
    Simd::V sum[kGroup] = {};
    for (std::size_t n = 0; n < static_cast<std::size_t>(data.num_samples); ++n) {
      const Tape& tape = kSeveral ? TapeAt(data.error_tape, data, n) : *data.error_tape;
      const double* row = data.scalars->Row(data.sample[n]);
      Simd::V e[kGroup];
      TapeSumOf<kGroup>(tape.rest, row, theta.value[0].data() + lane, kTileLanes, e);
      for (int k = 0; k < (kSeveral ? tape.num_powers : kPowers); ++k) {
        const expression::TapePower& power = tape.power[static_cast<std::size_t>(k)];
        Simd::V factor[kGroup];
        TapeSumOf<kGroup>(power.factor, row, theta.value[0].data() + lane, kTileLanes, factor);
        const double* exponent = theta.value[power.exponent].data() + lane;
        const double log2 = row[power.log2];
        if (std::fabs(log2) * tape.largest_exponent <= kReach) {
          for (int g = 0; g < kGroup; ++g)
            e[g] = Simd::Fma(ScoreSimd::Power(Simd::Load(exponent + g * Simd::kLanes), log2), factor[g], e[g]);
        } else {
          for (int g = 0; g < kGroup; ++g)
            e[g] =
                Simd::Fma(Simd::Exp2OrNan(Simd::Load(exponent + g * Simd::kLanes) * Simd::Set(log2)), factor[g], e[g]);
        }
      }
      for (int g = 0; g < kGroup; ++g) {
        if constexpr (kWeighted) e[g] = e[g] * Simd::Set(data.weight[n]);
        sum[g] = Simd::Fma(e[g], e[g], sum[g]);
      }
    }
    for (int g = 0; g < kGroup; ++g) Simd::Store(out + lane + g * Simd::kLanes, sum[g]);
  }
}

/// SumShapeSquares() of one tape without powers that has kTerms terms: the same bits, with the parameters in hardware
/// registers.
template <bool kWeighted, std::size_t kTerms>
void SumLinearSquares(const ModeData& data, const ThetaTile& theta, double* out) noexcept {
  using expression::TapeSum;
  constexpr int kGroup = Simd::kLanes == 8 ? 4 : 2;
  const TapeSum& terms = data.error_tape->rest;
  for (int lane = 0; lane < kTileLanes; lane += kGroup * Simd::kLanes) {
    Simd::V parameter[kTerms][kGroup];
    for (std::size_t t = 0; t < kTerms; ++t)
      for (int g = 0; g < kGroup; ++g)
        parameter[t][g] = Simd::Load(theta.value[terms.parameter[t]].data() + lane + g * Simd::kLanes);
    Simd::V sum[kGroup] = {};
    for (std::size_t n = 0; n < static_cast<std::size_t>(data.num_samples); ++n) {
      const double* row = data.scalars->Row(data.sample[n]);
      const Simd::V constant = terms.constant == TapeSum::kNone ? Simd::V{} : Simd::Set(row[terms.constant]);
      Simd::V e[kGroup];
      for (int g = 0; g < kGroup; ++g) e[g] = constant;
      for (std::size_t t = 0; t < kTerms; ++t) {
        const Simd::V scalar = Simd::Set(terms.scalar[t] == TapeSum::kNone ? 1.0 : row[terms.scalar[t]]);
        for (int g = 0; g < kGroup; ++g) e[g] = Simd::Fma(parameter[t][g], scalar, e[g]);
      }
      for (int g = 0; g < kGroup; ++g) {
        if constexpr (kWeighted) e[g] = e[g] * Simd::Set(data.weight[n]);
        sum[g] = Simd::Fma(e[g], e[g], sum[g]);
      }
    }
    for (int g = 0; g < kGroup; ++g) Simd::Store(out + lane + g * Simd::kLanes, sum[g]);
  }
}

/// Instruction sets whose vectors of one tile leave half of the hardware registers unused run two tiles side by side.
constexpr bool kTapesInPairs = kTapeVectors < 8;

template <bool kWeighted, std::size_t kTiles>
void SumSquaresOfTapes(const ModeData& data, const ThetaTile* theta, double* out) noexcept {
  using expression::TapeShape;
  const auto are = [&](auto... shapes) {
    return data.states == nullptr && std::all_of(data.error_tape, data.error_tape + data.num_tapes,
                                                 [=](const Tape& tape) { return ((tape.shape == shapes) || ...); });
  };
  const bool several = data.num_tapes > 1;
  const auto shaped = [&](auto powers) {  // no pointers to functions: what they do is not known to be bounded
    for (std::size_t t = 0; t < kTiles; ++t) {
      double* const sums = out + t * kTileLanes;
      if (several)
        SumShapeSquares<kWeighted, decltype(powers)::value, true>(data, theta[t], sums);
      else
        SumShapeSquares<kWeighted, decltype(powers)::value, false>(data, theta[t], sums);
    }
  };
  const auto linear = [&](auto terms) {
    for (std::size_t t = 0; t < kTiles; ++t)
      SumLinearSquares<kWeighted, decltype(terms)::value>(data, theta[t], out + t * kTileLanes);
  };
  if (are(TapeShape::kLinear)) {
    switch (several ? 0 : data.error_tape->rest.count) {
      case 1: linear(std::integral_constant<std::size_t, 1>()); break;
      case 2: linear(std::integral_constant<std::size_t, 2>()); break;
      case 3: linear(std::integral_constant<std::size_t, 3>()); break;
      case 4: linear(std::integral_constant<std::size_t, 4>()); break;
      default: shaped(std::integral_constant<int, 0>());
    }
  } else if (are(TapeShape::kLinear, TapeShape::kPower)) {
    if (several || data.error_tape->num_powers > 1)
      shaped(std::integral_constant<int, 2>());
    else
      shaped(std::integral_constant<int, 1>());
  } else if constexpr (kTapesInPairs) {
    SumTapeSquares<kWeighted, kTiles>(data, theta, out);
  } else {
    for (std::size_t t = 0; t < kTiles; ++t) SumTapeSquares<kWeighted, 1>(data, theta + t, out + t * kTileLanes);
  }
}

template <std::size_t kTiles>
void SumSquaresOfTapes(const ModeData& data, const ThetaTile* theta, double* out) noexcept ARMCMC_NONBLOCKING {
  if (data.weighted) {
    SumSquaresOfTapes<true, kTiles>(data, theta, out);
  } else {
    SumSquaresOfTapes<false, kTiles>(data, theta, out);
  }
}

}  // namespace
}  // namespace armcmc::simd::ARMCMC_SIMD_NAMESPACE
