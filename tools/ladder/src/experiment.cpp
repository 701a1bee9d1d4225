#include "armcmc/ladder/experiment.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <optional>
#include <sstream>

#include "armcmc/gap/effect_words.hpp"
#include "motion.hpp"
#include "prospect.hpp"

namespace armcmc::ladder {
namespace {

constexpr std::array kPaceLadder = {0.25, 0.5, 1.0, 2.0, 4.0};
constexpr double kMostSpeed = 4.0;     // relative to the recording
constexpr double kWorthItsWear = 1.1;  // required gain of a motion over one half as fast
constexpr double kNeedsNoMore = 0.9;   // expected share of decided pairs at which no faster motion is tried
constexpr double kAsWorthy = 0.98;     // of the best score: a slower and simpler motion is preferred
constexpr std::size_t kRefittedMotions = 4;

std::string Short(int digits, double value) {
  std::array<char, 48> text{};
  std::snprintf(text.data(), text.size(), "%.*g", digits, value);
  return text.data();
}

struct Proposed {
  Motion motion;
  Prospect prospect;
  double worth = 0.0;  ///< Score: share of decided pairs, reduced for faster motions.
  double speed = 0.0;  ///< Relative to the recording.
};

double Worth(const Prospect& prospect, double pace) {
  return prospect.decided / std::pow(kWorthItsWear, std::max(0.0, std::log2(pace)));
}

/// Sorts by score; motions within 2 % of the best keep their order, slow and simple ones first.
void PutBestFirst(std::vector<Proposed>* all) {
  double best = 0.0;
  for (const Proposed& one : *all) best = std::max(best, kAsWorthy * one.worth);
  std::stable_sort(all->begin(), all->end(), [best](const Proposed& a, const Proposed& b) {
    return std::min(a.worth, best) > std::min(b.worth, best);
  });
}

/// Largest change from sample to sample, relative to that of the recording.
double SpeedOf(const std::vector<double>& value, double dt, double recorded) {
  double most = 0.0;
  for (std::size_t n = 1; n < value.size(); ++n) most = std::max(most, std::fabs(value[n] - value[n - 1]) / dt);
  return recorded > 0.0 ? most / recorded : 0.0;
}

class Search {
 public:
  Search(const Dataset& data, const Tied& tied, const PlantDescription& plant)
      : tied_(tied), plant_(plant), dt_(data.series->dt), ranges_(RangesOf(data, plant)) {
    // A row of a simulated plant costs as much as several of another.
    const std::size_t most = IsSimulated(plant) ? 3000 : 8000;
    constexpr std::size_t kFewestRows = 1000;
    rows_ = std::clamp(data.series->num_rows(), kFewestRows, most);
    for (const std::vector<double>& signal : data.series->signals) rest_.push_back(signal.front());
  }

  [[nodiscard]] std::optional<Proposed> Best() const {
    std::vector<Proposed> all;
    double most = 0.0;
    for (const double pace : kPaceLadder) {
      for (Motion& motion : MotionsAt(pace, plant_, ranges_, duration_s(), dt_)) {
        const auto series = SeriesOf(motion, plant_, rest_, rows_, dt_);
        if (!series) continue;
        const double speed = SpeedOf(series->signals[motion.moved.signal], dt_, motion.moved.speed);
        if (speed > kMostSpeed) continue;
        const std::optional<Prospect> prospect = tied_.Expected(series);
        if (!prospect) continue;
        all.push_back({std::move(motion), *prospect, Worth(*prospect, pace), speed});
        most = std::max(most, prospect->decided);
      }
      if (pace >= 1.0 && most > kNeedsNoMore) break;
    }
    PutBestFirst(&all);
    all.resize(std::min(all.size(), kRefittedMotions));
    for (Proposed& proposed : all) {
      const std::optional<Prospect> prospect = tied_.Refitted(SeriesOf(proposed.motion, plant_, rest_, rows_, dt_));
      if (prospect) proposed.prospect = *prospect;
      proposed.worth = prospect ? Worth(*prospect, proposed.motion.pace) : 0.0;
    }
    PutBestFirst(&all);
    return all.empty() ? std::nullopt : std::optional(all.front());
  }

  [[nodiscard]] double duration_s() const { return static_cast<double>(rows_) * dt_; }
  [[nodiscard]] double dt() const { return dt_; }
  [[nodiscard]] double rest(std::size_t signal) const { return rest_[signal]; }

  [[nodiscard]] gap::Curve CourseOf(const Motion& motion) const {
    constexpr std::size_t kPoints = 800;
    const auto series = SeriesOf(motion, plant_, rest_, rows_, dt_);
    gap::Curve curve;
    const std::size_t every = std::max<std::size_t>(1, rows_ / kPoints);
    for (std::size_t n = 0; n < rows_; n += every) {
      curve.x.push_back(series->t[n]);
      curve.y.push_back(series->signals[motion.moved.signal][n]);
    }
    return curve;
  }

 private:
  const Tied& tied_;
  const PlantDescription& plant_;
  double dt_;
  std::vector<InputRange> ranges_;
  std::size_t rows_ = 0;
  std::vector<double> rest_;  ///< [signal] Values at the beginning of the recording.
};

std::string NameOf(const Tied& tied, std::size_t i) { return gap::EffectInSentence(tied[i].candidate.entry->name); }

std::string WordsOf(const Proposed& best, const Tied& tied, const PlantDescription& plant, double duration_s) {
  const SignalDescription& signal = plant.signals[best.motion.moved.signal];
  const Prospect& prospect = best.prospect;
  const std::string pair = NameOf(tied, prospect.one) + " and " + NameOf(tied, prospect.two);
  const std::string move = (signal.role == "position" ? "move " : "vary ") + signal.name + " " + best.motion.words +
                           ", within the recording's range of " + Short(3, best.motion.moved.low) + " to " +
                           Short(3, best.motion.moved.high) + " " + signal.unit +
                           (best.speed > 1.2 ? ", at up to " + Short(2, best.speed) + " times its speed" : "");
  const std::string evidence =
      Short(3, duration_s) + " s of it give about " +
      (prospect.least < 1.0 ? Short(1, prospect.least) : Short(6, std::round(prospect.least))) +
      " nats of evidence between " + pair;
  if (prospect.open == prospect.pairs)
    return "No motion within reach of the recording would decide between " +
           (prospect.pairs > 1 ? "any two of them" : pair) + ". The best, to " + move + ": " + evidence + ", of the " +
           Short(2, kDecidingNats) + " that decide.";
  std::string enough = "; " + Short(2, kDecidingNats) + " decide.";
  if (prospect.open > 0) {
    enough = prospect.least < 1.0 ? ", so little that repeating it would hardly help"
                                  : ", which may not be enough: repeat it, or go farther";
    const std::size_t decided = prospect.pairs - prospect.open;
    enough += "; " + std::to_string(decided) + " of the " + std::to_string(prospect.pairs) + " pairs would be decided.";
  }
  return "To separate them: " + move + ". " + evidence + enough;
}

/// Values of the parameters of the plant itself, as the truth of a scenario; a list if each mode has its own.
std::string TruthText(const Contender& contender, const PlantDescription& plant) {
  const identify::TrajectoryModel& model = *contender.trial.model;
  const auto fitted = [&](const std::string& name) -> std::optional<double> {
    for (Eigen::Index d = 0; d < model.num_parameters(); ++d)
      if (model.parameters()[static_cast<std::size_t>(d)].name == name)
        return model.Shown(d, contender.trial.fit.theta[d]);
    return std::nullopt;
  };
  std::ostringstream out;
  out.precision(10);
  for (const ParameterDescription& p : plant.parameters) {
    if (const std::optional<double> value = fitted(p.name)) {
      out << p.name << " = " << *value << "   # " << p.unit << '\n';
      continue;
    }
    out << p.name << " = [";
    for (std::size_t m = 0; m < plant.modes.size(); ++m)
      out << (m > 0 ? ", " : "") << fitted(p.name + "_" + plant.modes[m].name).value_or(p.mean);
    out << "]   # " << p.unit << '\n';
  }
  return out.str();
}

std::string ScenarioOf(const Proposed& best, const std::string& words, const Tied& tied, const PlantDescription& plant,
                       const Search& search) {
  std::ostringstream out;
  out.precision(10);
  out << "# " << words << "\nschema = 1\nrate_hz = " << 1.0 / search.dt() << "\nduration_s = " << search.duration_s()
      << "\n\n[truth] # of the plant, beside " << NameOf(tied, 0) << "\n"
      << TruthText(tied[0], plant) << "\n[inputs]\n";
  for (const auto& [signal, text] : best.motion.program_of)
    out << plant.signals[signal].name << " = { expression = \"" << text << "\" }   # " << plant.signals[signal].unit
        << '\n';
  std::string starts;
  const std::vector<std::size_t> inputs = InputsOf(plant);
  for (std::size_t s = 0; s < plant.signals.size() && !plant.states.empty(); ++s)
    if (plant.signals[s].derivative_of.empty() && std::find(inputs.begin(), inputs.end(), s) == inputs.end())
      starts += plant.signals[s].name + " = " + Short(10, search.rest(s)) + "   # " + plant.signals[s].unit + "\n";
  if (!starts.empty()) out << "\n[start] # as the recording\n" << starts;
  out << "\n[noise]\nlaw = \"gaussian\"\nstd = " << tied.error_sd() << '\n';
  return out.str();
}

}  // namespace

gap::Experiment SeparatingMotion(const Dataset& data, const Rung& rung, const PlantDescription& plant) {
  gap::Experiment experiment;
  const Tied tied(rung);
  if (const std::string not_made = tied.NotMade(); !not_made.empty()) {
    experiment.words = "What a motion would reveal cannot be predicted: " + not_made + " depends on the motion itself.";
    return experiment;
  }
  const Search search(data, tied, plant);
  const std::optional<Proposed> best = search.Best();
  if (!best) {
    experiment.words = "For no motion of the library within the range of the recording can the outcome be predicted.";
    return experiment;
  }
  experiment.words = WordsOf(*best, tied, plant, search.duration_s());
  experiment.nats = best->prospect.least;
  experiment.program = best->motion.program;
  experiment.pace = best->motion.pace;
  experiment.sample_interval_s = search.dt();
  if (best->prospect.open == best->prospect.pairs) return experiment;
  const SignalDescription& moved = plant.signals[best->motion.moved.signal];
  experiment.course = search.CourseOf(best->motion);
  experiment.course_title = moved.name + (moved.unit.empty() ? "" : ", " + moved.unit);
  experiment.scenario_text = ScenarioOf(*best, experiment.words, tied, plant, search);
  return experiment;
}

}  // namespace armcmc::ladder
