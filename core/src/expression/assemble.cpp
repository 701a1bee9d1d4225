#include <algorithm>
#include <stdexcept>
#include <string>

#include "expression/virtual_code.hpp"

namespace armcmc::expression {
namespace {

/// Gives values that are alive at the same time registers of their own, and writes the code down.
class Assembler {
 public:
  Assembler(const VirtualCode& code, Tape* tape) : tape_(*tape) {
    for (const bool once : {true, false})
      for (const Virtual& v : code.code)
        if (v.once == once) order_.push_back(&v);
    last_use_.assign(static_cast<std::size_t>(code.num_values()), -1);
    for (std::size_t i = 0; i < order_.size(); ++i)
      for (const int r : order_[i]->registers) last_use_[static_cast<std::size_t>(r)] = static_cast<int>(i);
    const int never = static_cast<int>(order_.size());
    for (const int result : code.results) last_use_[static_cast<std::size_t>(result)] = never;
    for (int value = 0; value < code.num_values(); ++value) {
      // What is computed once, or handed in, is there for every sample.
      const bool stays = value < code.num_fixed || (code.once[static_cast<std::size_t>(value)] &&
                                                    last_use_[static_cast<std::size_t>(value)] >= NumOnce());
      if (stays) last_use_[static_cast<std::size_t>(value)] = never;
    }
    place_.assign(static_cast<std::size_t>(code.num_values()), -1);
    for (int value = 0; value < code.num_fixed; ++value) place_[static_cast<std::size_t>(value)] = value;
    used_ = code.num_fixed;
  }

  void Write() {
    for (std::size_t i = 0; i < order_.size(); ++i) {
      One(*order_[i], static_cast<int>(i));
      if (order_[i]->once) tape_.once = tape_.size;
    }
    tape_.num_registers = used_;
  }
  [[nodiscard]] int Place(int value) const { return place_[static_cast<std::size_t>(value)]; }

 private:
  [[nodiscard]] int NumOnce() const {
    return static_cast<int>(std::count_if(order_.begin(), order_.end(), [](const Virtual* v) { return v->once; }));
  }

  void One(const Virtual& v, int at) {
    std::vector<int> from;
    for (const int r : v.registers) from.push_back(Place(r));
    for (const int r : v.registers)
      if (last_use_[static_cast<std::size_t>(r)] == at) Free(Place(r));
    const int to = Take();
    place_[static_cast<std::size_t>(v.to)] = to;
    if (last_use_[static_cast<std::size_t>(v.to)] < 0) Free(to);

    TapeInstruction i;
    i.op = v.op;
    i.to = Byte(to);
    const auto scalar = [&](std::size_t s) { return Byte(v.scalars.at(s)); };
    switch (v.op) {
      case TapeOp::kLinear:
      case TapeOp::kAddLinear: {
        const std::size_t head = v.op == TapeOp::kLinear ? 0 : 1;
        i.a = head == 0 ? scalar(0) : Byte(from[0]);
        const std::size_t count = from.size() - head;
        i.b = Byte(static_cast<int>(count));
        Append(i);
        for (std::size_t t = 0; t < count; t += 2) {
          TapeInstruction pair;
          const std::size_t s = 1 - head;
          pair.to = Byte(from[head + t]);
          pair.a = scalar(s + t);
          if (t + 1 < count) {
            pair.b = Byte(from[head + t + 1]);
            pair.c = scalar(s + t + 1);
          }
          Append(pair);
        }
        return;
      }
      case TapeOp::kSplat: i.a = scalar(0); break;
      case TapeOp::kExp2S:
        i.a = Byte(from[0]);
        i.b = scalar(0);
        break;
      case TapeOp::kPowerInt:
        i.a = Byte(from[0]);
        i.b = Byte(v.number);
        break;
      case TapeOp::kMultiplyAddS:
        i.a = Byte(from[0]);
        i.b = Byte(from[1]);
        i.c = scalar(0);
        break;
      default:
        if (!from.empty()) i.a = Byte(from[0]);
        if (from.size() > 1) i.b = Byte(from[1]);
        if (from.size() > 2) i.c = Byte(from[2]);
    }
    Append(i);
  }

  static std::uint8_t Byte(int value) { return static_cast<std::uint8_t>(value); }

  void Append(const TapeInstruction& i) {
    if (tape_.size == kMaxTapeInstructions)
      throw std::length_error("needs more than " + std::to_string(kMaxTapeInstructions) + " instructions a sample");
    tape_.code[static_cast<std::size_t>(tape_.size++)] = i;
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
    if (std::find(free_.begin(), free_.end(), place) == free_.end()) free_.push_back(place);
  }

  Tape& tape_;
  std::vector<const Virtual*> order_;
  std::vector<int> last_use_;  ///< Of a value: the instruction that reads it last.
  std::vector<int> place_;     ///< Of a value: its register.
  std::vector<int> free_;
  int used_ = 0;
};

}  // namespace

void Assemble(const VirtualCode& code, Tape* tape) {
  Assembler assembler(code, tape);
  assembler.Write();
  for (std::size_t r = 0; r < code.results.size(); ++r)
    tape->result[r] = static_cast<std::uint8_t>(assembler.Place(code.results[r]));
  tape->num_results = static_cast<int>(code.results.size());
}

}  // namespace armcmc::expression
