#include "armcmc/tables/experiment.hpp"
#include "armcmc/tables/plants/registry.hpp"

#include <cmath>
#include <stdexcept>
#include <utility>

namespace armcmc::tables {
namespace {

template <typename Array, typename Use>
void Each(Array* into, const Array& from, const Use& use) {
  for (std::size_t i = 0; i < into->size(); ++i) use(&(*into)[i], from[i]);
}

void Add(DriftScore* sum, const DriftScore& s, double share) {
  sum->share += share * s.share;
  Each(&sum->rate, s.rate, [share](double* a, double b) { *a += share * b; });
}

void Add(ContactScore* sum, const ContactScore& s, double share) {
  const auto add = [share](double* a, double b) { *a += share * b; };
  Each(&sum->mae_contact, s.mae_contact, add);
  Each(&sum->mae_active_contact, s.mae_active_contact, add);
  add(&sum->force_contact_mn, s.force_contact_mn);
  add(&sum->force_overall_mn, s.force_overall_mn);
  add(&sum->noisy_force_l2_n, s.noisy_force_l2_n);
  for (std::size_t l = 0; l < kLevels.size(); ++l) {
    Each(&sum->coverage[l], s.coverage[l], add);
    Each(&sum->width[l], s.width[l], add);
    Each(&sum->coverage_variance[l], s.coverage_variance[l], add);
  }
  sum->false_modifications += s.false_modifications;
  Add(&sum->drift, s.drift, share);
  add(&sum->median_ms, s.median_ms);
  sum->max_ms = std::fmax(sum->max_ms, s.max_ms);
  add(&sum->mean_draws, s.mean_draws);
}

void Add(ActuatorScore* sum, const ActuatorScore& s, double share) {
  const auto add = [share](double* a, double b) { *a += share * b; };
  Each(&sum->g_rel_error, s.g_rel_error, add);
  add(&sum->theta1_l2, s.theta1_l2);
  add(&sum->theta2_l2, s.theta2_l2);
  add(&sum->alpha_l2, s.alpha_l2);
  add(&sum->alpha_restarted_l2, s.alpha_restarted_l2);
  add(&sum->flow_rel_error, s.flow_rel_error);
  for (std::size_t m = 0; m < 2; ++m) {
    Each(&sum->coverage50[m], s.coverage50[m], add);
    Each(&sum->coverage95[m], s.coverage95[m], add);
    Add(&sum->drift[m], s.drift[m], share);
  }
  add(&sum->median_ms, s.median_ms);
  sum->max_ms = std::fmax(sum->max_ms, s.max_ms);
}

/// Mean of the seeds' scores, and how uncertain the mean coverage is.
Row MeanRow(Row row, const std::vector<ContactScore>& contact, const std::vector<ActuatorScore>& actuator) {
  for (const ContactScore& s : contact) Add(&row.contact, s, 1.0 / static_cast<double>(contact.size()));
  for (const ActuatorScore& s : actuator) Add(&row.actuator, s, 1.0 / static_cast<double>(actuator.size()));
  const auto n = static_cast<double>(contact.size());
  for (std::size_t l = 0; l < kLevels.size(); ++l)
    for (std::size_t d = 0; d < 3; ++d) {
      double square = 0.0;
      for (const ContactScore& s : contact) square += std::pow(s.coverage[l][d] - row.contact.coverage[l][d], 2);
      const double between = square / std::fmax(n - 1.0, 1.0);
      row.coverage_error[l][d] = std::sqrt(std::fmax(row.contact.coverage_variance[l][d], between) / n);
    }
  return row;
}

}  // namespace

const Row& Experiment::Find(const std::string& wanted) const {
  for (const Row& row : rows)
    if (row.key == wanted) return row;
  throw std::out_of_range(key + " has no row " + wanted);
}

Experiment RunExperiment(const std::string& key, const std::string& title, int seeds, const Source& source,
                         const std::vector<MethodSpec>& methods) {
  struct Scores {
    Row row;
    Point point = Point::kMap;
    std::vector<ContactScore> contact;
    std::vector<ActuatorScore> actuator;
  };
  Experiment e;
  e.key = key;
  e.title = title;
  e.seeds = seeds;
  std::vector<Scores> scores;
  for (int seed = 0; seed < seeds; ++seed) {
    const Recording recording = source(seed);
    std::size_t at = 0;
    for (const MethodSpec& spec : methods) {
      Trace trace = spec.online ? RunMethod(recording, spec) : RunBatch(recording, spec);
      const bool two = spec.key == "armcmc";
      for (const Point point : two ? std::vector<Point>{Point::kAp, Point::kMap} : std::vector<Point>{Point::kMap}) {
        if (seed == 0) {
          const std::string suffix = !two ? "" : point == Point::kAp ? "_ap" : "_map";
          const std::string label = !two ? spec.label : point == Point::kAp ? "AR-AP" : "AR-MAP";
          scores.push_back({{spec.key + suffix, label, trace.online, trace.has_intervals, {}, {}, {}}, point, {}, {}});
        }
        if (kContact.Is(recording.plant))
          scores[at].contact.push_back(ScoreContact(recording, trace, point, spec.settings));
        else
          scores[at].actuator.push_back(ScoreActuator(recording, trace, point, spec.settings));
        ++at;
      }
      if (seed > 0) continue;
      e.settings.push_back(spec.settings);
      e.traces.push_back(std::move(trace));
    }
    if (seed == 0) e.recording = recording;
  }
  e.plant = e.recording.plant;
  for (const Scores& s : scores) e.rows.push_back(MeanRow(s.row, s.contact, s.actuator));
  return e;
}

std::vector<LikelihoodCell> RunLikelihoods(int seeds, AssumedLaws which,
                                           const std::function<Recording(const std::string&, int)>& source,
                                           const std::function<void()>& done) {
  const std::vector<std::pair<std::string, std::string>> noises = {{"gaussian", kContact.key("_paper")},
                                                                   {"student_t", kContact.key("_heavy_tailed")},
                                                                   {"laplace", kContact.key("_laplace")},
                                                                   {"mixture", kContact.key("_impulsive")}};
  std::vector<LikelihoodCell> cells;
  for (const auto& [noise, scenario] : noises) {
    for (const auto& [assumed, other] : noises) {
      if (which == AssumedLaws::kOwn && assumed != noise) continue;
      const MethodSpec spec = PaperMethods(ScenarioSettings(other)).front();
      std::vector<ContactScore> scores;
      Row row;
      row.key = "armcmc_map";
      row.label = "AR-MAP";
      for (int seed = 0; seed < seeds; ++seed) {
        const Recording recording = source(scenario, seed);
        scores.push_back(ScoreContact(recording, RunMethod(recording, spec), Point::kMap, spec.settings));
      }
      cells.push_back({noise, assumed, seeds, MeanRow(std::move(row), scores, {})});
      if (done) done();
    }
  }
  return cells;
}

}  // namespace armcmc::tables
