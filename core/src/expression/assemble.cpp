#include <algorithm>
#include <stdexcept>
#include <string>

#include "expression/virtual_code.hpp"

namespace armcmc::expression {
namespace {

bool Commutes(TapeOp op) noexcept {
  switch (op) {
    case TapeOp::kAdd:
    case TapeOp::kMultiply:
    case TapeOp::kMultiplyAdd:
    case TapeOp::kMultiplyAddS:
    case TapeOp::kTakeProduct:
    case TapeOp::kEqual:
    case TapeOp::kNotEqual:
    case TapeOp::kAnd:
    case TapeOp::kOr: return true;
    default: return false;
  }
}

/// Allocates registers, different ones for values that are alive at the same time, and emits the code.
class Assembler {
 public:
  Assembler(const VirtualCode& code, const TapeLayout& layout, Tape* tape)
      : tape_(*tape), results_(code.results), layout_(layout), fixed_(layout.num_parameters + layout.num_states) {
    for (const bool once : {true, false})
      for (const Virtual& v : code.code)
        if (v.once == once) order_.push_back(v);
    if (layout.advances) Chain();
    num_once_ = static_cast<int>(std::count_if(order_.begin(), order_.end(), [](const Virtual& v) { return v.once; }));
    const int never = static_cast<int>(order_.size());
    last_use_.assign(static_cast<std::size_t>(code.num_values()), -1);
    for (std::size_t i = 0; i < order_.size(); ++i)
      for (const int r : order_[i].registers) last_use_[At(r)] = static_cast<int>(i);
    last_read_ = last_use_;
    for (const int result : results_) last_use_[At(result)] = never;
    for (int value = 0; value < code.num_values(); ++value)
      // Values that are computed once, or given, are valid for every sample.
      if (value < fixed_ || (code.once[At(value)] && last_use_[At(value)] >= num_once_)) last_use_[At(value)] = never;
    place_.assign(static_cast<std::size_t>(code.num_values()), -1);
    for (int value = 0; value < fixed_; ++value) place_[At(value)] = value;
    used_ = std::max(fixed_, layout.first_free);
  }

  void Write() {
    for (std::size_t i = 0; i < order_.size(); ++i) {
      if (static_cast<int>(i) == num_once_) previous_ = -1;  // no value is kept between samples
      One(static_cast<int>(i));
      if (order_[i].once) tape_.once = Size();
    }
    if (layout_.advances) MoveResults();
    tape_.num_registers = used_;
    for (std::size_t r = 0; r < results_.size(); ++r) tape_.result[r] = Byte(Place(results_[r]));
    tape_.num_results = static_cast<int>(results_.size());
  }

 private:
  static std::size_t At(int i) { return static_cast<std::size_t>(i); }
  static std::uint8_t Byte(int value) { return static_cast<std::uint8_t>(value); }
  [[nodiscard]] int Place(int value) const { return place_[At(value)]; }
  [[nodiscard]] int Size() const { return static_cast<int>(tape_.code.size()); }

  /// Whether v reads the result of the previous instruction from the accumulator.
  [[nodiscard]] static bool ReadsAccumulator(const Virtual& v, int value) {
    const auto from = std::find(v.registers.begin(), v.registers.end(), value);
    if (from == v.registers.end() || v.op == TapeOp::kLinear) return false;
    const auto at = from - v.registers.begin();
    return at == 0 || v.op == TapeOp::kAddLinear || v.op == TapeOp::kMultiplyAdd || v.op == TapeOp::kTakeProduct ||
           (Commutes(v.op) && at == 1);
  }

  /// Moves an instruction directly after the one whose result it reads, if it is not far away and its other operands
  /// are available: each move saves a store and a load.
  void Chain() {
    constexpr std::ptrdiff_t kFar = 8;
    for (auto at = order_.begin(); at != order_.end() && at + 1 != order_.end(); ++at) {
      const auto end = at + 1 + std::min(kFar, order_.end() - (at + 1));
      for (auto next = at + 1; next != end && next->once == at->once; ++next) {
        const bool ready = std::none_of(at + 1, next, [&](const Virtual& between) {
          return std::find(next->registers.begin(), next->registers.end(), between.to) != next->registers.end();
        });
        // The next value of a state, written before the last reader of the state, would have to be copied.
        const bool result = std::find(results_.begin(), results_.end(), next->to) != results_.end();
        if (!ready || result || !ReadsAccumulator(*next, at->to)) continue;
        std::rotate(at + 1, next, next + 1);
        break;
      }
    }
  }

  /// Register a first: the result of the previous instruction, if the arithmetic allows it.
  void PutResultFirst(Virtual* v) const {
    const auto from = std::find(v->registers.begin(), v->registers.end(), previous_);
    if (previous_ < 0 || from == v->registers.end() || from == v->registers.begin()) return;
    const auto at = from - v->registers.begin();
    if ((v->op == TapeOp::kMultiplyAdd || v->op == TapeOp::kTakeProduct) && at == 2) {
      v->op = v->op == TapeOp::kMultiplyAdd ? TapeOp::kAddProduct : TapeOp::kLessProduct;
      std::rotate(v->registers.begin(), from, v->registers.end());
    } else if (Commutes(v->op) && at == 1) {
      std::swap(v->registers[0], v->registers[1]);
    }
  }

  /// A sum with the previous result among its terms begins with that term.
  [[nodiscard]] bool BeginsWithTerm(const Virtual& v) const {
    return v.op == TapeOp::kAddLinear && previous_ >= 0 && v.registers[0] != previous_ &&
           std::find(v.registers.begin(), v.registers.end(), previous_) != v.registers.end();
  }

  void One(int at) {
    Virtual v = order_[At(at)];
    PutResultFirst(&v);
    if (v.op == TapeOp::kAddLinear && v.registers.size() == 2 && v.registers[0] != previous_) {
      v.op = TapeOp::kScaleAdd;
      std::swap(v.registers[0], v.registers[1]);
    }
    const bool sum = v.op == TapeOp::kLinear || v.op == TapeOp::kAddLinear;
    const bool has_a = !v.registers.empty() && v.op != TapeOp::kLinear;
    Virtual start;  // of such a sum
    if (BeginsWithTerm(v)) {
      const auto term = std::find(v.registers.begin(), v.registers.end(), previous_);
      const auto scalar = v.scalars.begin() + (term - v.registers.begin() - 1);
      start.op = TapeOp::kScaleAdd;
      start.registers = {previous_, v.registers[0]};
      start.scalars = {*scalar};
      v.registers.erase(term);
      v.scalars.erase(scalar);
    }
    const bool starts = !start.registers.empty();
    const int first = starts ? start.registers[0] : has_a ? v.registers[0] : -1;
    const bool chained = first >= 0 && first == previous_;
    const auto again = std::count(order_[At(at)].registers.begin(), order_[At(at)].registers.end(), previous_);
    if (chained && again == 1 && last_use_[At(previous_)] == at) tape_.code[At(previous_at_)].stores = false;

    std::vector<int> from;
    for (const int r : v.registers) from.push_back(Place(r));
    TapeInstruction begin;
    if (starts) {
      begin.op = TapeOp::kScaleAdd;
      begin.a = Byte(Place(start.registers[0]));
      begin.b = Byte(Place(start.registers[1]));
      begin.c = Byte(start.scalars[0]);
    }
    for (const int r : order_[At(at)].registers)
      if (last_use_[At(r)] == at) Free(Place(r));
    const int to = PlaceFor(v.to, at);
    place_[At(v.to)] = to;
    if (last_use_[At(v.to)] < 0) Free(to);

    TapeInstruction i;
    i.op = v.op;
    i.to = Byte(to);
    i.loads = has_a && !chained;
    i.stores = true;
    if (starts) {
      begin.to = i.to;
      previous_at_ = Size();
      begin.stores = v.scalars.empty();
      Append(begin);
      if (begin.stores) {
        previous_ = v.to;
        return;
      }
      i.loads = false;
    }
    const auto scalar = [&](std::size_t s) { return Byte(v.scalars.at(s)); };
    if (has_a) i.a = Byte(from[0]);
    previous_ = v.to;
    previous_at_ = Size();
    if (sum) {
      WriteSum(v, from, i);
      return;
    }
    switch (v.op) {
      case TapeOp::kSplat: i.a = scalar(0); break;
      case TapeOp::kScale:
      case TapeOp::kExp2S:
      case TapeOp::kPast:
      case TapeOp::kMinS:
      case TapeOp::kMaxS: i.b = scalar(0); break;
      case TapeOp::kPowerInt: i.b = Byte(v.number); break;
      default:
        if (from.size() > 1) i.b = Byte(from[1]);
        if (from.size() > 2) i.c = Byte(from[2]);
        if (v.op == TapeOp::kMultiplyAddS || v.op == TapeOp::kScaleAdd) i.c = scalar(0);
    }
    Append(i);
  }

  void WriteSum(const Virtual& v, const std::vector<int>& from, TapeInstruction i) {
    const std::size_t r = v.op == TapeOp::kLinear ? 0 : 1;  // first term
    const std::size_t s = 1 - r;
    if (r == 0) i.a = Byte(v.scalars.at(0));
    const std::size_t count = from.size() - r;
    i.b = Byte(static_cast<int>(count));
    Append(i);
    for (std::size_t t = 0; t < count; t += 2) {
      TapeInstruction pair;
      pair.to = Byte(from[r + t]);
      pair.a = Byte(v.scalars.at(s + t));
      if (t + 1 < count) {
        pair.b = Byte(from[r + t + 1]);
        pair.c = Byte(v.scalars.at(s + t + 1));
      }
      Append(pair);
    }
  }

  /// For the next value of a state, the register of that state after its last reader.
  int PlaceFor(int value, int at) {
    if (layout_.advances)
      for (std::size_t s = 0; s < results_.size(); ++s) {
        const int state = layout_.num_parameters + static_cast<int>(s);
        if (results_[s] == value && last_read_[At(state)] <= at) return state;
      }
    return Take();
  }
  void MoveResults() {
    for (std::size_t s = 0; s < results_.size(); ++s) {
      const int state = layout_.num_parameters + static_cast<int>(s);
      if (Place(results_[s]) == state) continue;
      TapeInstruction i;
      i.loads = i.stores = true;
      i.a = Byte(Place(results_[s]));
      i.to = Byte(state);
      Append(i);
      place_[At(results_[s])] = state;
    }
  }

  void Append(const TapeInstruction& i) {
    if (Size() == layout_.most_instructions)
      throw std::length_error("needs more than " + std::to_string(layout_.most_instructions) +
                              " instructions a sample");
    tape_.code.push_back(i);
  }
  int Take() {
    if (!free_.empty()) {
      const int r = free_.back();
      free_.pop_back();
      return r;
    }
    if (used_ == kMaxTapeRegisters)
      throw std::length_error("needs more than " + std::to_string(kMaxTapeRegisters) +
                              " intermediate values at a time");
    return used_++;
  }
  void Free(int place) {
    if (place >= fixed_ && std::find(free_.begin(), free_.end(), place) == free_.end()) free_.push_back(place);
  }

  Tape& tape_;
  const std::vector<int>& results_;
  const TapeLayout& layout_;
  int fixed_;  ///< Parameters and states.
  int num_once_ = 0;
  std::vector<Virtual> order_;
  std::vector<int> last_use_;   ///< For each value: the instruction after which its register is free.
  std::vector<int> last_read_;  ///< For each value: the last instruction that reads it.
  std::vector<int> place_;      ///< For each value: its register.
  std::vector<int> free_;
  int used_ = 0;
  int previous_ = -1;  ///< The result of the previous instruction; -1: none.
  int previous_at_ = 0;
};

}  // namespace

void Assemble(const VirtualCode& code, const TapeLayout& layout, Tape* tape) { Assembler(code, layout, tape).Write(); }

}  // namespace armcmc::expression
