// Recordings of a bus, damaged anywhere.
#include <cstdint>
#include <memory>

#include "armcmc/replay/lcm_source.hpp"
#include "armcmc/support/program.hpp"
#include "input_file.hpp"
#include "plants/hunt_crossley/model.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace armcmc;
  const fuzz::InputFile file(data, size);
  replay::SourceRequest request;
  request.plant = HuntCrossley::kInfo.plant;
  request.num_inputs = HuntCrossley::kInfo.num_inputs;
  request.data = file.path();
  try {
    replay::LcmSource source(request, {});
    static replay::RecordedPack pack;
    while (source.Next(&pack))
      if (pack.pack.Validate() != Status::kOk) __builtin_trap();
    (void)source.notes();
  } catch (const support::InputError&) {
  }
  return 0;
}
