#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include "armcmc/plant_sim/noise.hpp"

namespace armcmc::plant_sim {

/// Something in a plant file or a scenario that cannot be simulated: its key, and the character of its text (from 1; 0:
/// the whole of it).
class DescribedError : public std::runtime_error {
 public:
  DescribedError(std::string key, int column, const std::string& what)
      : std::runtime_error(what), key_(std::move(key)), column_(column) {}
  [[nodiscard]] const std::string& key() const noexcept { return key_; }  ///< "law", "mode[1].when", "states.x.rate"
  [[nodiscard]] int column() const noexcept { return column_; }

 private:
  std::string key_;
  int column_;
};

/// What a plant file says, as far as simulating it needs it. Lists are in the order of the file.
struct DescribedPlant {
  struct Signal {
    std::string name, unit, role, derivative_of;
    std::string between = "linear";  ///< "held", "smooth": what it does between samples, for states.
  };
  struct Constant {
    std::string name;
    double value = 0.0;
  };
  struct Parameter {
    std::string name;
    double usual = 0.0;  ///< Mean of the prior; of a lognormal one the median, of a uniform one the middle.
    bool per_mode = false;
  };
  struct Let {
    std::string name, text;
  };
  struct Mode {
    std::string name, when, law, target;
    bool passive = false;
  };
  struct State {
    std::string name, rate, start, measured_by;
    int substeps = 1;
  };
  std::string name, output, predicts;
  std::vector<Signal> signals;
  std::vector<Constant> constants;
  std::vector<Parameter> parameters;
  std::vector<Let> lets;
  std::vector<Mode> modes;  ///< A plant with one law has one mode without `when`.
  bool one_law = false;     ///< It stands under "law", not under "mode[0].law".
  std::vector<State> states;
  NoiseLaw noise;

  /// Place of a signal; -1: none is called so.
  [[nodiscard]] int SignalAt(const std::string& signal) const;
  [[nodiscard]] int StateAt(const std::string& state) const;
};

/// Says whether packs fit: FNV-1a (64 bit) over the name, unit and role of each signal, then the name of the output;
/// after each text a byte 0xff.
[[nodiscard]] std::uint64_t SignalFingerprint(const DescribedPlant& plant);

}  // namespace armcmc::plant_sim
