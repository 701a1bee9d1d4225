#include "description_tables.hpp"

namespace armcmc::support {

std::vector<LetDescription> ReadLets(StrictTable* table) {
  std::vector<LetDescription> lets;
  StrictTable named = table->Table("let");
  for (const std::string& name : named.Keys()) lets.push_back({name, named.RequiredText(name)});
  return lets;
}

StateDescription ReadState(StrictTable* at, const std::string& name) {
  StateDescription state;
  state.name = name;
  state.unit = at->RequiredText("unit");
  state.role = at->Text("role", "");
  state.rate = at->RequiredText("rate");
  state.start = at->RequiredText("start");
  state.substeps = static_cast<int>(at->Integer("substeps", 1, 1, 100));
  return state;
}

}  // namespace armcmc::support
