// No sampler, for reference: the least squares fit that samplers start at, its mode taken for the posterior mean.

#include "problem.hpp"

int main(int argc, char** argv) {
  return peers::Main(argc, argv, "least squares fit alone", "no draws: its mode, for reference",
                     [](const peers::Problem& problem, int, int) {
                       peers::Replicate got;
                       got.mean = peers::Fit(problem).mean;
                       return got;
                     });
}
