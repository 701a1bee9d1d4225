#include "armcmc/plant_sim/pack_builder.hpp"

#include <algorithm>
#include <iterator>
#include <type_traits>

namespace armcmc::plant_sim {

static_assert(std::extent_v<decltype(data_pack_t::u), 1> == kMaxInputs);
static_assert(std::extent_v<decltype(plant_truth_t::theta_true)> == kMaxTruth);

PackBuilder::PackBuilder(const Scenario& scenario, std::uint64_t seed, std::int64_t run_id)
    : simulation_(scenario, seed), stride_(scenario.stride()), family_(*scenario.family) {
  pack_.run_id = truth_.run_id = run_id;
  pack_.plant_kind = truth_.plant_kind = family_.kind;
  pack_.n_samples = truth_.n_samples = scenario.pack_samples;
  pack_.n_inputs = family_.num_inputs();
  pack_.dt = scenario.sample_interval_s;
  truth_.n_params = family_.num_truth();
}

bool PackBuilder::Next() noexcept {
  bool finite = simulation_.index() >= 0 || simulation_.Next();
  // What the pack before has, too, moves to the front.
  const int kept = pack_.seq > 0 ? pack_.n_samples - stride_ : 0;
  std::copy_n(pack_.y + pack_.n_samples - kept, kept, pack_.y);
  std::copy_n(truth_.y_true + pack_.n_samples - kept, kept, truth_.y_true);
  for (int i = 0; i < kept; ++i)
    std::copy(std::begin(pack_.u[i + stride_]), std::end(pack_.u[i + stride_]), pack_.u[i]);
  for (int i = kept; i < pack_.n_samples; ++i) {
    finite = simulation_.Next() && finite;
    const PlantSample& measured = simulation_.measured();
    pack_.y[i] = measured.output;
    std::copy(measured.inputs.begin(), measured.inputs.end(), pack_.u[i]);
    truth_.y_true[i] = simulation_.truth().output;
  }
  const PlantSample& last = simulation_.truth();
  truth_.seq = ++pack_.seq;
  pack_.t_last_s = last.t_s;
  truth_.true_mode = last.mode;
  const Theta theta = simulation_.plant().Truth(std::min(last.mode, family_.num_modes() - 1), last.t_s);
  std::copy(theta.begin(), theta.end(), truth_.theta_true);
  return finite;
}

void PackBuilder::Stamp(std::int64_t t_last_ns, std::int64_t utime) noexcept {
  pack_.t_last_ns = truth_.t_last_ns = t_last_ns;
  pack_.utime = truth_.utime = utime;
}

}  // namespace armcmc::plant_sim
