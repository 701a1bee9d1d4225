#include "armcmc/gap/equation.hpp"

#include <stdexcept>

#include "armcmc/gap/contact_equation.hpp"

namespace armcmc::gap {

// Every plant that the workflow knows: a new one is one line here.
std::unique_ptr<Equation> MakeEquation(const std::string& model) {
  if (model == "hunt_crossley") return MakeContactEquation();
  throw std::invalid_argument("the workflow knows no equation of '" + model + "'; known is hunt_crossley");
}

}  // namespace armcmc::gap
