#pragma once

#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

/// What the C++ peers share: the task as files describe it, the log posterior as its formula reads, and a fit.
namespace peers {

using Theta = std::array<double, 3>;  ///< K, B, p.
using Matrix = std::array<Theta, 3>;  ///< Rows.

struct Parameter {
  double mean = 0.0, sd = 1.0, lower = 0.0, upper = 0.0;
};

struct Problem {
  std::array<Parameter, 3> prior;
  std::vector<double> log_x, v, f, noise_sd;
};

/// Numbers of the rows of a CSV below its header, from column `first` on.
inline std::vector<std::vector<double>> ReadRows(const std::string& path, int first) {
  std::ifstream file(path);
  if (!file) throw std::runtime_error("cannot read " + path);
  std::vector<std::vector<double>> rows;
  std::string line, cell;
  std::getline(file, line);
  while (std::getline(file, line)) {
    std::istringstream cells(line);
    rows.emplace_back();
    for (int i = 0; std::getline(cells, cell, ','); ++i)
      if (i >= first) rows.back().push_back(std::stod(cell));
  }
  return rows;
}

inline Problem ReadProblem(const std::string& folder) {
  Problem problem;
  const auto parameters = ReadRows(folder + "/parameters.csv", 1);
  for (std::size_t d = 0; d < 3; ++d)
    problem.prior[d] = {parameters.at(d).at(0), parameters[d].at(1), parameters[d].at(2), parameters[d].at(3)};
  for (const auto& row : ReadRows(folder + "/pack.csv", 0)) {
    problem.log_x.push_back(std::log(row.at(0)));
    problem.v.push_back(row.at(1));
    problem.f.push_back(row.at(2));
    problem.noise_sd.push_back(row.at(3));
  }
  return problem;
}

/// Up to a constant; -infinity outside the box. x^p as exp(p log x), with the logarithms taken once.
inline double LogPosterior(const Problem& problem, const Theta& theta) {
  double sum = 0.0;
  for (std::size_t d = 0; d < 3; ++d) {
    const Parameter& prior = problem.prior[d];
    if (!(theta[d] >= prior.lower && theta[d] <= prior.upper)) return -HUGE_VAL;
    const double z = (theta[d] - prior.mean) / prior.sd;
    sum -= 0.5 * z * z;
  }
  for (std::size_t n = 0; n < problem.f.size(); ++n) {
    const double force = (theta[0] + theta[1] * problem.v[n]) * std::exp(theta[2] * problem.log_x[n]);
    const double z = (problem.f[n] - force) / problem.noise_sd[n];
    sum -= 0.5 * z * z;
  }
  return sum;
}

/// Lower Cholesky factor.
inline Matrix Cholesky(const Matrix& a) {
  Matrix l{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j <= i; ++j) {
      double s = a[i][j];
      for (std::size_t k = 0; k < j; ++k) s -= l[i][k] * l[j][k];
      l[i][j] = i == j ? std::sqrt(s) : s / l[j][j];
    }
  return l;
}

inline Theta Solve(const Matrix& l, Theta b) {
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t k = 0; k < i; ++k) b[i] -= l[i][k] * b[k];
    b[i] /= l[i][i];
  }
  for (std::size_t i = 3; i-- > 0;) {
    for (std::size_t k = i + 1; k < 3; ++k) b[i] -= l[k][i] * b[k];
    b[i] /= l[i][i];
  }
  return b;
}

struct Laplace {
  Theta mean{};
  Matrix covariance{};
};

/// Mode of the posterior and inverse of its Gauss-Newton Hessian: Levenberg-Marquardt from the mean of the prior.
inline Laplace Fit(const Problem& problem) {
  Laplace fit;
  for (std::size_t d = 0; d < 3; ++d) fit.mean[d] = problem.prior[d].mean;
  double value = LogPosterior(problem, fit.mean), damping = 1e-3;
  Matrix hessian{};
  for (int round = 0; round < 60; ++round) {
    hessian = {};
    Theta gradient{};
    for (std::size_t d = 0; d < 3; ++d) {
      const double precision = 1.0 / (problem.prior[d].sd * problem.prior[d].sd);
      hessian[d][d] = precision;
      gradient[d] = precision * (problem.prior[d].mean - fit.mean[d]);
    }
    for (std::size_t n = 0; n < problem.f.size(); ++n) {
      const double h = std::exp(fit.mean[2] * problem.log_x[n]), w = 1.0 / problem.noise_sd[n];
      const double force = (fit.mean[0] + fit.mean[1] * problem.v[n]) * h;
      const Theta row{w * h, w * h * problem.v[n], w * force * problem.log_x[n]};
      for (std::size_t i = 0; i < 3; ++i) {
        gradient[i] += row[i] * w * (problem.f[n] - force);
        for (std::size_t j = 0; j < 3; ++j) hessian[i][j] += row[i] * row[j];
      }
    }
    Matrix damped = hessian;
    for (std::size_t d = 0; d < 3; ++d) damped[d][d] *= 1.0 + damping;
    const Theta step = Solve(Cholesky(damped), gradient);
    Theta next = fit.mean;
    for (std::size_t d = 0; d < 3; ++d) next[d] += step[d];
    const double there = LogPosterior(problem, next);
    if (there >= value) {
      const bool done = there - value < 1e-10;
      fit.mean = next;
      value = there;
      damping *= 0.1;
      if (done) break;
    } else {
      damping *= 10.0;
    }
  }
  const Matrix l = Cholesky(hessian);
  for (std::size_t d = 0; d < 3; ++d) {
    Theta unit{};
    unit[d] = 1.0;
    fit.covariance[d] = Solve(l, unit);
  }
  return fit;
}

/// What one replicate gave.
struct Replicate {
  double acceptance = 0.0;  ///< Of a chain; of a weighted sample Kish's share.
  Theta mean{};
};

/// Prints the replicates as CSV: milliseconds, acceptance, evaluations of the likelihood, estimated posterior means.
/// `run(problem, replicate, evaluations)` does everything that a pack needs, the fit included.
template <class Run>
int Main(int argc, char** argv, const char* peer, const char* how, const Run& run) {
  try {
    if (argc != 4) throw std::invalid_argument("usage: PEER CASE_FOLDER REPLICATES EVALUATIONS");
    const Problem problem = ReadProblem(argv[1]);
    const int replicates = std::stoi(argv[2]), evaluations = std::stoi(argv[3]);
    std::printf("# peer: %s\n# how: %s\nms,acceptance,evaluations,K,B,p\n", peer, how);
    for (int r = 0; r < replicates; ++r) {
      const auto start = std::chrono::steady_clock::now();
      const Replicate got = run(problem, r, evaluations);
      const std::chrono::duration<double, std::milli> ms = std::chrono::steady_clock::now() - start;
      std::printf("%.6g,%.4g,%d,%.17g,%.17g,%.17g\n", ms.count(), got.acceptance, evaluations, got.mean[0], got.mean[1],
                  got.mean[2]);
    }
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: %s\n", argv[0], error.what());
    return 1;
  }
}

}  // namespace peers
