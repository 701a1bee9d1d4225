#include "armcmc/replay/verify.hpp"

#include <algorithm>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "armcmc/change_t.hpp"
#include "armcmc/estimate_t.hpp"
#include "armcmc/log_export/message_type.hpp"
#include "armcmc/posterior_t.hpp"
#include "armcmc/rt/messages.hpp"
#include "armcmc/support/csv.hpp"
#include "armcmc/support/lcm_log.hpp"
#include "armcmc/support/program.hpp"

namespace armcmc::replay {
namespace {

using Bytes = std::span<const std::uint8_t>;
using Key = std::pair<std::int64_t, std::int64_t>;  // run_id, seq

constexpr const char* kEstimates = "EST_ESTIMATE";
constexpr const char* kPosteriors = "EST_POSTERIOR";
constexpr const char* kChanges = "EST_CHANGE";

/// What was published for one pack; points into the log.
struct Recorded {
  Bytes estimate, posterior, change;
};

template <typename Message>
std::vector<std::uint8_t> Encoded(const Message& message) {
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return bytes;
}

std::string Value(Bytes message, const log_export::MessageField& field, std::size_t index) {
  if (field.type == "double" || field.type == "float")
    return support::ExactNumber(log_export::NumberAt(message, field, index));
  return std::to_string(log_export::IntegerAt(message, field, index));
}

/// "ar_map[0]: 4.01 in the log, 4.02 in the replay" for the first number that differs.
std::string FirstDifference(const log_export::MessageType& type, Bytes recorded, Bytes computed) {
  const auto at = static_cast<std::size_t>(std::mismatch(recorded.begin(), recorded.end(), computed.begin()).first -
                                           recorded.begin());
  for (const log_export::MessageField& field : type.fields) {
    if (at >= field.offset + field.count * field.width) continue;
    const std::size_t index = (at - field.offset) / field.width;
    std::string name(field.name);
    std::size_t block = field.count;
    for (const int size : field.dims) {
      block /= static_cast<std::size_t>(size);
      name.append("[").append(std::to_string(index / block % static_cast<std::size_t>(size))).append("]");
    }
    return name + " is " + Value(recorded, field, index) + " in the log and " + Value(computed, field, index) +
           " in the replay";
  }
  return "the type of the message differs";
}

}  // namespace

struct Verifier::Impl {
  Impl(const std::filesystem::path& path, const EstimatorSettings& settings) : log(path), engine(settings) {}

  void Compare(const char* channel, Bytes published, const std::vector<std::uint8_t>& computed, const Estimate& e) {
    ++result.compared;
    if (std::equal(published.begin(), published.end(), computed.begin(), computed.end())) return;
    ++result.different;
    if (!result.first_difference.empty()) return;
    result.first_difference = "pack " + std::to_string(e.seq) + " (t = " + support::ExactNumber(e.t_last_s) + " s), " +
                              channel + ": " + FirstDifference(*log_export::TypeOf(published), published, computed);
  }

  support::LcmLogReader log;
  rt::EstimatorEngine engine;  // asked for names and units only
  std::map<Key, Recorded> recorded;
  std::map<Key, bool> seen;
  Verification result;
};

Verifier::Verifier(const std::filesystem::path& log, const std::string& prefix, const EstimatorSettings& settings)
    : impl_(std::make_unique<Impl>(log, settings)) {
  support::LcmLogEvent event;
  estimate_t estimate{};
  posterior_t posterior{};
  change_t change{};
  while (impl_->log.Next(&event)) {
    const bool is_estimate = event.channel == prefix + kEstimates, is_posterior = event.channel == prefix + kPosteriors,
               is_change = event.channel == prefix + kChanges;
    if (!is_estimate && !is_posterior && !is_change) continue;
    const int size = static_cast<int>(event.data.size());
    const log_export::MessageType* type = log_export::TypeOf(event.data);
    if (is_estimate && type != nullptr && estimate.decode(event.data.data(), 0, size) == size) {
      impl_->recorded[{estimate.run_id, estimate.seq}].estimate = event.data;
    } else if (is_posterior && type != nullptr && posterior.decode(event.data.data(), 0, size) == size) {
      impl_->recorded[{posterior.run_id, posterior.seq}].posterior = event.data;
    } else if (is_change && type != nullptr && change.decode(event.data.data(), 0, size) == size) {
      impl_->recorded[{change.run_id, change.seq}].change = event.data;
    } else {
      ++impl_->result.undecodable;
    }
  }
  if (impl_->recorded.empty())
    throw support::InputError(log.string() + ": holds no " + prefix + kEstimates + " to compare with" +
                              (impl_->result.undecodable > 0 ? " that this version can read" : " (--prefix?)"));
}

Verifier::~Verifier() = default;

void Verifier::Check(const Estimate& e) {
  const auto found = impl_->recorded.find({e.run_id, e.seq});
  if (found == impl_->recorded.end()) return;
  impl_->seen[found->first] = true;
  rt::StepOutput output;
  output.estimate = e;
  output.info.seq = e.seq;
  output.info.run_id = e.run_id;
  const bool truncated =
      std::any_of(e.modes.begin(), e.modes.end(), [](const ModeEstimate& m) { return m.updated && m.truncated; });
  output.info.status = truncated ? Status::kTruncated : Status::kOk;
  const Recorded& was = found->second;
  if (!was.estimate.empty()) {
    estimate_t message{}, recorded{};
    recorded.decode(was.estimate.data(), 0, static_cast<int>(was.estimate.size()));
    rt::FillEstimate(output, impl_->engine, recorded.utime, &message);
    message.t_release_ns = recorded.t_release_ns;
    message.t_done_ns = recorded.t_done_ns;
    impl_->Compare(kEstimates, was.estimate, Encoded(message), e);
  }
  if (!was.posterior.empty()) {
    posterior_t message{}, recorded{};
    recorded.decode(was.posterior.data(), 0, static_cast<int>(was.posterior.size()));
    rt::FillPosterior(output, impl_->engine, recorded.utime, &message);
    impl_->Compare(kPosteriors, was.posterior, Encoded(message), e);
  }
  if (!was.change.empty()) {
    change_t message{}, recorded{};
    recorded.decode(was.change.data(), 0, static_cast<int>(was.change.size()));
    rt::FillChange(output, impl_->engine, recorded.change_utime, &message);
    impl_->Compare(kChanges, was.change, Encoded(message), e);
  }
}

Verification Verifier::Finish() const {
  Verification result = impl_->result;
  result.without_pack = static_cast<std::int64_t>(impl_->recorded.size() - impl_->seen.size());
  return result;
}

}  // namespace armcmc::replay
