// Recordings as text: the samples, and the packs made of them.
#include <cstdint>
#include <memory>

#include "armcmc/replay/csv_source.hpp"
#include "armcmc/support/program.hpp"
#include "input_file.hpp"
#include "plants/hunt_crossley/model.hpp"
#include "plants/soft_actuator/model.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace armcmc;
  if (size < 1) return 0;
  const fuzz::InputFile file(data + 1, size - 1);  // the first byte: how to read it
  replay::SourceRequest request;
  request.data = file.path();
  request.plant = (data[0] & 1U) != 0 ? SoftActuator::kInfo.plant : HuntCrossley::kInfo.plant;
  request.num_inputs = request.plant == SoftActuator::kInfo.plant ? 4 : 2;
  request.skip_bad = (data[0] & 2U) != 0;
  request.period = (data[0] & 4U) != 0 ? 0.1 : 0.004;
  try {
    replay::CsvSource source(request, {});
    static replay::RecordedPack pack;
    while (source.Next(&pack))
      if (pack.pack.Validate() != Status::kOk) __builtin_trap();
    (void)source.notes();
  } catch (const support::InputError&) {
  }
  return 0;
}
