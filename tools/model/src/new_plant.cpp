#include "new_plant.hpp"

#include <algorithm>
#include <fstream>
#include <regex>
#include <sstream>

#include "armcmc/support/plant_file.hpp"
#include "armcmc/support/program.hpp"

namespace armcmc::model {
namespace {

constexpr const char* kGuide =
    R"(# A plant: signals that are measured, parameters that are sought, and the law between them.
# Change what stands here, then ask what was understood:  armcmc-model check FILE
#
#   [signals]     every measured quantity. role says what it is (position, velocity, acceleration, force, pressure,
#                 drive, level, ...); derivative_of lets a recording do without it; between = "held" says that it keeps
#                 its value until the next sample, as a command does, "smooth" that it is a curve (states see a line)
#   output        the signal that the law explains; the law says what it would be without noise
#   [parameters]  unit, and what is known before any data: mean and sd, or prior = "uniform" with lower and upper, or
#                 prior = "lognormal" (mean is the median, sd that of the logarithm)
#   [constants]   numbers with a name            [let]     subexpressions with a name
#   [[mode]]      instead of law: name, when, law; the first whose condition holds acts
#   [states]      what is integrated: unit, rate, start
#   [noise]       law = gaussian | student_t | laplace | mixture, std in the unit of what is explained
#
# Expressions: + - * / ^, < <= > >= == !=, and or not, abs sign sqrt exp log log2 log10 sin cos tan asin acos atan tanh
# min max clamp(x, lo, hi) step(x) if(c, a, b), and with memory lowpass(e, tau) delay(e, tau) integral(e) previous(e)
# elapsed(). t is the plant's time, s.
)";

}  // namespace

std::string NewPlantText(const std::string& name, const std::filesystem::path& from) {
  const bool is_name = !name.empty() && std::all_of(name.begin(), name.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
  });
  if (!is_name) throw support::InputError("NAME \"" + name + "\": expected lower-case letters, digits and _");
  (void)support::ReadPlant(from);  // what is wrong there would be wrong here
  std::ifstream file(from, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  std::string made = kGuide + std::string("\n") +
                     std::regex_replace(text.str(), std::regex("(^|\n)name( *)= *\"[^\"]*\""),
                                        "$1name$2= \"" + name + "\"", std::regex_constants::format_first_only);
  if (support::PlantFromText(made, from.string()).description().name != name)
    throw support::InputError(from.string() + ": expected its name as  name = \"...\"  on a line of its own");
  return made;
}

}  // namespace armcmc::model
