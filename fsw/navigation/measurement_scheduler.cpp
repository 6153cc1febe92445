#include "fsw/navigation/measurement_scheduler.h"

#include <array>
#include <type_traits>

#include "fsw/messaging/message_fields.h"
#include "fsw/navigation/filter_configuration.h"
#include "fsw/orbit/propagate.h"

namespace vbar::fsw::navigation {
namespace {

using measurements::AidState;
using measurements::Context;
using measurements::kLongestDelay;

constexpr double kMaxRate = 10.0;  // rad/s, of a spacecraft body

/// Calls visit(source, index) for each source of the tuple.
template <class Tuple, class Visitor>
void for_each(Tuple& sources, Visitor&& visit) {
  std::uint8_t index = 0;
  std::apply([&](auto&... source) { (visit(source, index++), ...); }, sources);
}

/// Decodes an attitude. Returns false for a quaternion whose length differs from one by more than a part in a thousand,
/// or for an impossible rate.
template <class Message>
bool attitude_of(const Message& message, measurements::AttitudeSample& sample) {
  if (!messaging::is_rotation(message.q_eci_body)) return false;
  sample.R_eci_body = messaging::rotation(message.q_eci_body);
  sample.rate_body = messaging::vector(message.rate_body);
  return sample.rate_body.squaredNorm() <= kMaxRate * kMaxRate;
}

/// Calls put(sample) for each valid attitude of the queue.
template <class Queue, class Put>
void for_each_attitude(GpsTime now, const Queue& packets, messaging::Inbox& inbox, Put&& put) {
  for (std::size_t k = 0; k < packets.size(); ++k) {
    measurements::AttitudeSample sample;
    sample.time = packets[k].tag.time;
    if (sample.time > now) {
      inbox.count_unusable_time();
    } else if (attitude_of(packets[k].value, sample)) {
      put(sample);
    } else {
      inbox.count_bad_content();
    }
  }
}

// The last value stands for all: the list of vbar.lcm is that of the code.
static_assert(static_cast<int>(AidState::kFailed) == telemetry_event::kAidFailed);

telemetry_event event_of(const measurements::AidTransition& transition, std::int32_t device, std::int64_t step) {
  telemetry_event event{};
  event.step = step;
  event.event = telemetry_event::kEventAid;
  event.severity = transition.after == AidState::kSuspended || transition.after == AidState::kFailed
                       ? telemetry_event::kSeverityWarning
                       : telemetry_event::kSeverityInformation;
  event.device = device;
  event.before = static_cast<std::int32_t>(transition.before);
  event.after = static_cast<std::int32_t>(transition.after);
  return event;
}

}  // namespace

void MeasurementScheduler::configure(GpsTime now, const messaging::Telecommands& telecommands) {
  if (!telecommands.has_changed()) return;
  select(now, telecommands);
  if (telecommands.is_new<target_apriori>()) {
    filter_.set_apriori(apriori_of(*telecommands.in_force<target_apriori>(), telecommands.time_of<target_apriori>()));
  }
}

/// Activates the sources that are selected and have all their telecommands in force, and stops the others.
void MeasurementScheduler::select(GpsTime now, const messaging::Telecommands& telecommands) {
  const auto* navigation = telecommands.in_force<navigation_configuration>();
  if (navigation == nullptr) return;
  filter::FilterSettings blocks = filter_settings(telecommands);
  std::array<bool, std::tuple_size_v<measurements::SourceList>> is_used{};
  for_each(sources_, [&]<class Source>(Source& source, std::uint8_t index) {
    is_used[index] = source.configure({telecommands, blocks}) && (navigation->sources & Source::kUse) != 0;
  });
  filter_.configure(blocks);
  for_each(sources_, [&](auto& source, std::uint8_t index) {
    if (is_used[index] && !source.aid().is_on()) source.aid().go_to(AidState::kWaiting, now);
    if (!is_used[index] && source.aid().is_on()) source.stop(now, filter_);
  });
}

/// Returns the commanded attitude at `time`. The frame of the command rotates with the orbit, so that the state of the
/// filter is propagated to that time.
std::optional<Matrix3> MeasurementScheduler::commanded_attitude(GpsTime time) const {
  if (!platform_.pointing || !filter_.absolute_orbit().started()) return std::nullopt;
  const auto servicer = orbit::propagate_j2(filter_.servicer(), seconds(time - filter_.epoch()));
  if (!servicer.ok()) return std::nullopt;
  return measurements::R_body_eci_of(*platform_.pointing, time, servicer.value());
}

void MeasurementScheduler::take_attitudes(GpsTime now, messaging::Inbox& inbox) {
  attitudes_ = {};
  for_each_attitude(now, inbox.queue<vbar::attitude>(), inbox, [&](const measurements::AttitudeSample& sample) {
    const AttitudeGate::Verdict verdict = attitude_gate_.judge(sample, commanded_attitude(sample.time));
    if (verdict.used) platform_.servicer_attitude.put(*verdict.used);
    ++attitudes_.received;
    if (verdict.is_accepted) return;
    ++attitudes_.refused;
    attitudes_.difference = attitude_gate_.difference();
  });
  for_each_attitude(now, inbox.queue<vbar::crosslink_attitude>(), inbox,
                    [&](const measurements::AttitudeSample& sample) { platform_.target_attitude.put(sample); });
}

void MeasurementScheduler::update(GpsTime now, messaging::Inbox& inbox, std::span<const filter::Burn> burns) {
  Context context{now, inbox, platform_, gnss_};
  for_each(sources_, [](auto& source, std::uint8_t /*index*/) { source.aid().forget_inconsistency(); });
  take_attitudes(now, inbox);
  gnss_.drop_before(filter_.epoch());  // not at the end: the safety monitor reads the epochs of the step
  gnss_.decode(inbox, filter_.epoch());
  for_each(sources_, [&](auto& source, std::uint8_t index) {
    if (source.aid().is_on()) source.collect(context, {queue_, index});
  });
  process_records(context, burns);
  // Without records the epoch follows at a distance, so that the work of a step stays bounded.
  if (now - filter_.epoch() > kLongestDelay + kLongestDelay) filter_.advance_to(now - kLongestDelay, burns);
  for_each(sources_, [&](auto& source, std::uint8_t /*index*/) {
    if (source.aid().is_on()) source.watch(now, filter_);
  });
  if (const auto stars = source<measurements::BearingSource>().star_attitude()) {
    attitude_gate_.take_stars(stars->time, stars->R_eci_body);
  }
}

/// Returns the time up to which records are processed: the oldest one since which a record is pending.
GpsTime MeasurementScheduler::fusion_horizon(GpsTime now) const {
  GpsTime until = now;
  for_each(sources_, [&](const auto& source, std::uint8_t /*index*/) {
    const std::optional<GpsTime> owed = source.aid().is_on() ? source.pending_since(now) : std::nullopt;
    if (owed && *owed < until) until = *owed;
  });
  return until;
}

void MeasurementScheduler::process_records(Context& context, std::span<const filter::Burn> burns) {
  const GpsTime until = fusion_horizon(context.now);
  for (std::size_t k = 0; k < measurements::RecordQueue::kCapacity; ++k) {
    const measurements::Record* next = queue_.front();
    if (next == nullptr || next->time > until) return;
    const measurements::Record record = *next;
    queue_.pop();
    if (record.time < filter_.epoch()) {
      context.inbox.count_unusable_time();
      continue;
    }
    filter_.advance_to(record.time, burns);
    for_each(sources_, [&](auto& source, std::uint8_t index) {
      const bool is_used = index == record.source && source.aid().is_on() && !is_isolated(index);
      if (is_used) source.process_record(record, context, filter_);
    });
  }
}

GpsTime MeasurementScheduler::last_measurement() const {
  GpsTime last;
  for_each(sources_, [&](const auto& source, std::uint8_t /*index*/) {
    if (source.last_measurement() > last) last = source.last_measurement();
  });
  return last;
}

void MeasurementScheduler::check_sources(GpsTime now, faults::FaultMonitor& faults) {
  faults::Check inconsistent{.fault = telemetry_health::kFaultSourceInconsistent};
  faults::Check restarts{.fault = telemetry_health::kFaultSourceRestarts};
  faults::Check contradicting{.fault = telemetry_health::kFaultSourcesContradict};
  const auto detect = [](faults::Check& check, std::int32_t device, double argument) {
    if (check.is_detected) return;
    check.is_detected = true;
    check.device = device;
    check.argument = argument;
  };
  for_each(sources_, [&]<class Source>(Source& source, std::uint8_t index) {
    const measurements::Aid& aid = source.aid();
    if (!aid.is_on()) return;
    const bool is_outside = aid.consistency().is_outside();
    const bool is_restarting = aid.restarts().are_repeated(now);
    if (is_outside) detect(inconsistent, Source::kUse, aid.consistency().mean());
    if (aid.inconsistency()) detect(inconsistent, Source::kUse, *aid.inconsistency());
    if (is_restarting) detect(restarts, Source::kUse, static_cast<double>(aid.restarts().count()));
    if (aid.is_contradicting()) detect(contradicting, Source::kUse, aid.consistency().mean());
    if (is_outside || (is_restarting && !is_isolated(index))) isolate(now, index, source);
  });
  faults.check(now, inconsistent);
  faults.check(now, restarts);
  faults.check(now, contradicting);
  check_attitudes(now, faults);
  const auto& network = source<measurements::KeypointSource>().aiding().network_verdict();
  if (network && uses<measurements::KeypointSource>()) {
    faults.check(now, {.fault = telemetry_health::kFaultPoseNetwork,
                       .is_detected = network->contradicts,
                       .device = measurements::KeypointSource::kUse,
                       .argument = network->angle});
  }
  if (uses<measurements::GnssAbsoluteSource>())
    receivers_.update(now, gnss_, uses<measurements::CdgnssSource>(), faults);
}

void MeasurementScheduler::check_attitudes(GpsTime now, faults::FaultMonitor& faults) const {
  if (attitudes_.received == 0) return;
  faults.check(now, {.fault = telemetry_health::kFaultAttitude,
                     .is_detected = attitudes_.refused > 0,
                     .argument = attitudes_.difference});
}

/// Isolates a source, or inflates the covariance if no other source confirms the orbit. The statistics of its
/// innovations are re-initialised.
template <class Source>
void MeasurementScheduler::isolate(GpsTime now, std::size_t index, Source& source) {
  const double mean = source.aid().consistency().mean();
  source.aid().consistency().reset();
  const bool is_too_large = mean > measurements::Consistency::kMax;
  if constexpr (std::is_same_v<Source, measurements::GnssAbsoluteSource>) {
    if (is_too_large) filter_.inflate_absolute_orbit(kAbsoluteOrbitInflation);
  } else if (!filter_.is_confirmed_by_others({.bit = Source::kUse})) {
    if (is_too_large) {
      if constexpr (requires { source.explain_excess(mean, filter_); }) {
        source.explain_excess(mean, filter_);
      } else {
        filter_.scale_relative_covariance(mean);
      }
    }
  } else {
    isolated_until_[index] = now + kIsolation;
    if constexpr (requires { source.suspend(now, filter_); }) {
      source.suspend(now, filter_);
    } else {
      source.aid().go_to(AidState::kSuspended, now);
    }
  }
}

void MeasurementScheduler::report(messaging::Outbox& outbox, std::int64_t step, GpsTime now,
                                  const messaging::Inbox& inbox) const {
  const measurements::Telemetry telemetry{outbox, step, now, inbox, gnss_, filter_};
  for_each(sources_, [&]<class Source>(const Source& source, std::uint8_t /*index*/) {
    if (source.aid().is_on()) source.report(telemetry);
    for (const measurements::AidTransition& transition : source.aid().transitions()) {
      outbox.send(transition.time, event_of(transition, Source::kUse, step));
    }
  });
}

void MeasurementScheduler::forget_transitions() {
  for_each(sources_, [](auto& source, std::uint8_t /*index*/) { source.aid().forget_transitions(); });
}

}  // namespace vbar::fsw::navigation
