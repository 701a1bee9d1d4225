#include "armcmc/gap/experiment.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <sstream>

#include "armcmc/gap/smoothing.hpp"

namespace armcmc::gap {
namespace {

constexpr double kTwoPi = 2.0 * std::numbers::pi;
constexpr double kSeconds = 6.0;
constexpr Eigen::Index kMaxRows = 6000;
constexpr std::size_t kCompared = 3;      // candidates; more ties are resolved by a second experiment
constexpr double kEnough = 10.0;          // nats that decide
constexpr double kHopeless = 1.0;         // nats that no few repetitions make enough
constexpr double kLeastWeight = 0.1;      // of a candidate, however improbable
constexpr Eigen::Index kResponse = 2000;  // samples in which noise forgets
constexpr double kSmoothing_s = 0.015;
constexpr double kBand_hz = 14.0;  // of the plant's motions at pace 1
constexpr int kSteps = 10;
constexpr double kPaces[] = {1.0, 2.0, 4.0};
constexpr double kWorth = 1.1;     // times the decisions of a slower motion, that a quicker one must bring
constexpr double kDecided = 0.95;  // expected share of decisions that needs no quicker motion, and no quicker sampling
constexpr int kRefine = 4;         // times as many samples, where no motion decides

double Share(double t, double period) { return t / period - std::floor(t / period); }
double Tap(double share) { return 0.5 - 0.5 * std::cos(kTwoPi * share); }
double Sweep(double t) { return kTwoPi * (0.3 * t + 0.5 * (8.0 - 0.3) * t * t / 10.0); }

double SlowTriangle(double t) { return -0.1 + 1.1 * (1.0 - std::abs(2.0 * Share(t, 4.0) - 1.0)); }
double FastTaps(double t) { return -0.15 + 1.15 * Tap(Share(t, 0.2)); }
double StepHold(double t) {
  constexpr std::array<double, 3> kLevels = {1.0, 0.5, 0.75};
  const double s = 2.0 * Share(t, 2.0);
  return s < 1.4 ? kLevels[static_cast<std::size_t>(t / 2.0) % kLevels.size()] : -0.1;
}
double TapsOfDepths(double t) {
  constexpr std::array<double, 6> kDepths = {0.3, 0.9, 0.5, 1.0, 0.2, 0.7};
  return -0.1 + (kDepths[static_cast<std::size_t>(t / 0.8) % kDepths.size()] + 0.1) * Tap(Share(t, 0.8));
}
double ContactChirp(double t) { return 0.6 + 0.35 * std::sin(Sweep(t)); }
double FreeAirChirp(double t) { return -0.6 + 0.4 * std::sin(Sweep(t)); }

/// A motion of the plant's library, in units of the deepest press.
struct ContactProgram {
  const char* name;
  const char* words;
  double (*position)(double t);
};
constexpr std::array<ContactProgram, 6> kContactPrograms = {{
    {"taps_of_depths", "press and release to several depths, one tap every 0.8 s", TapsOfDepths},
    {"fast_taps", "tap five times a second, to full depth", FastTaps},
    {"step_hold", "press quickly and hold for more than a second, at three depths", StepHold},
    {"slow_triangle", "press and release slowly at constant speed, 2 s each way", SlowTriangle},
    {"contact_chirp", "stay in contact and sweep a sine from 0.3 to 8 Hz", ContactChirp},
    {"free_air_chirp", "stay out of contact and sweep a sine from 0.3 to 8 Hz", FreeAirChirp},
}};

/// @param refine  Samples for each that there would be at the rate of `like`.
Signals Simulate(const ContactProgram& program, double pace, const Signals& like, double depth, int refine) {
  Signals s = like;
  const auto rows = refine * std::min(static_cast<Eigen::Index>(kSeconds / like.dt), kMaxRows);
  const double dt = kSeconds / static_cast<double>(rows);
  Vector x(rows);
  for (Eigen::Index i = 0; i < rows; ++i) x[i] = depth * program.position(pace * static_cast<double>(i) * dt);
  // Corners that no drive follows.
  for (int pass = 0; pass < 2; ++pass) {
    const double tau = kSmoothing_s / (pace * dt);
    x = Leaky(x, tau).eval();
    x = Leaky(Vector(x.reverse()), tau).reverse().eval();
  }
  s.dt = dt;
  s.t = Vector::LinSpaced(rows, like.t[0], like.t[0] + static_cast<double>(rows - 1) * dt);
  s.at(Role::kPosition) = x;
  s.at(Role::kVelocity) = SavitzkyGolay(x, 3, 1) / dt;
  s.at(Role::kAcceleration) = SavitzkyGolay(s.at(Role::kVelocity), 3, 1) / dt;
  s.active = (x.array() > 0.0).cast<double>();
  return s;
}

double Separation(const Equation& equation, Signals* s, const Whitener& whitener, const Fitted& truth,
                  const Fitted& rival) {
  s->output = Evaluate(equation, *s, truth.hypothesis, truth.theta, Slopes::None()).y;
  const Fitter fitter(equation, *s, whitener);
  return 0.5 * fitter.Fit(rival.hypothesis, rival.theta, kSteps).squares / whitener.variance;
}

/// The same noise, sampled more often: its correlation over a time stays, as that of a process of first order.
Whitener Refined(const Whitener& whitener, int refine) {
  if (refine == 1 || whitener.phi.size() == 0) return whitener;
  Vector impulse = Vector::Zero(kResponse);
  impulse[0] = 1.0;
  const Vector response = whitener.Colour(impulse);
  const double next =
      std::max(response.head(kResponse - 1).dot(response.tail(kResponse - 1)) / response.squaredNorm(), 0.0);
  const double keep = std::pow(next, 1.0 / refine);
  return {Vector::Constant(1, keep), whitener.variance * whitener.Gain() * (1.0 - keep * keep)};
}

/// What a motion would bring.
struct Prospect {
  double least = HUGE_VAL;  ///< Nats between the closest pair.
  double decided = 0.0;     ///< Share of the pairs that would be decided, by the probability of either.
};

Prospect Expect(const Equation& equation, Signals* s, const Whitener& whitener,
                const std::vector<CandidatePtr>& candidates) {
  Prospect prospect;
  double total = 0.0;
  for (const CandidatePtr& truth : candidates)
    for (const CandidatePtr& rival : candidates) {
      if (truth == rival) continue;
      const double nats = Separation(equation, s, whitener, truth->fit, rival->fit);
      const double weight = (truth->probability + kLeastWeight) * (rival->probability + kLeastWeight);
      prospect.least = std::min(prospect.least, nats);
      prospect.decided += weight * nats / (nats + kEnough);
      total += weight;
    }
  prospect.decided /= total;
  return prospect;
}

}  // namespace

Experiment SeparatingExperiment(const Equation& equation, const Analysis& analysis,
                                const std::vector<CandidatePtr>& candidates) {
  const std::vector<CandidatePtr> compared(
      candidates.begin(), candidates.begin() + static_cast<std::ptrdiff_t>(std::min(candidates.size(), kCompared)));
  const double depth =
      std::max(analysis.signals.at(Role::kPosition).maxCoeff(), analysis.signals.scale_of(Role::kPosition));
  Experiment best;
  const ContactProgram* chosen = nullptr;
  double most = -1.0;
  const auto consider = [&](const ContactProgram& program, double pace, int refine, double worth) {
    Signals s = Simulate(program, pace, analysis.signals, depth, refine);
    const Prospect prospect = Expect(equation, &s, Refined(analysis.fitter->whitener(), refine), compared);
    if (prospect.decided <= worth * most) return;
    most = prospect.decided;
    best.nats = prospect.least;
    best.pace = pace;
    best.program = program.name;
    best.words = program.words;
    best.sample_interval_s = analysis.signals.dt / refine;
    chosen = &program;
  };
  for (const double pace : kPaces) {
    // A quicker motion must be worth its wear.
    for (const ContactProgram& program : kContactPrograms) consider(program, pace, 1, pace > 1.0 ? kWorth : 1.0);
    if (most > kDecided) break;
  }
  // Latencies that are short against a sample differ in what happens between samples.
  if (most <= kDecided && chosen != nullptr) consider(*chosen, best.pace, kRefine, kWorth);
  best.depth = depth;
  char evidence[160];
  std::snprintf(evidence, sizeof(evidence),
                "; %.0f s of it give about %.0f nats of evidence between the closest pair%s", kSeconds, best.nats,
                best.nats < kHopeless ? ", so little that repeating it would hardly help"
                : best.nats < kEnough ? ", which may not be enough: repeat it, or press deeper"
                                      : "");
  char quicker[48] = "";
  if (best.pace > 1.0) std::snprintf(quicker, sizeof(quicker), ", all %.0f times as fast", best.pace);
  char finer[80] = "";
  if (best.sample_interval_s < analysis.signals.dt)
    std::snprintf(finer, sizeof(finer), ", sampled %d times as often, every %.4g ms", kRefine,
                  1e3 * best.sample_interval_s);
  best.words = "To separate them: " + best.words + quicker + finer + evidence + ".";
  return best;
}

std::string ScenarioText(const Equation& equation, const Analysis& analysis, const Experiment& experiment) {
  const Whitener& whitener = analysis.fitter->whitener();
  const Fitted& fit = analysis.finding.best->fit;
  const auto base = equation.Report(analysis.signals, fit.theta, fit.Covariance(whitener.variance));
  std::ostringstream out;
  out.precision(10);
  out << "# " << experiment.words << "\nschema = 1\nplant = \"" << equation.plant()
      << "\"\nduration_s = 10.0\nsample_interval_s = " << experiment.sample_interval_s
      << "\npack_period_s = " << 100.0 * experiment.sample_interval_s << "\n\n[parameters]\n";
  for (const ParameterEstimate& parameter : base)
    out << parameter.name << " = " << parameter.mean << "   # " << parameter.unit << '\n';
  out << "\n[motion]\ntracking = \"prescribed\"\nprogram = \"" << experiment.program
      << "\"\ndepth = " << experiment.depth << "   # m\npace = " << experiment.pace
      << "\nband_hz = " << kBand_hz * experiment.pace
      << "\n\n[noise.f]\nkind = \"gaussian\"\nstd = " << std::sqrt(whitener.variance * whitener.Gain()) << "   # N\n";
  return out.str();
}

}  // namespace armcmc::gap
