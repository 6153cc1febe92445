#include "fsw/gnc/trunk_navigation.h"

#include <array>
#include <type_traits>

#include "fsw/gnc/message_fields.h"
#include "fsw/gnc/trunk_configuration.h"
#include "fsw/orbit/propagate.h"

namespace vbar::fsw::gnc {
namespace {

using sources::AidState;
using sources::Context;
using sources::kLongestDelay;

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
bool attitude_of(const Message& message, navigation::AttitudeSample& sample) {
  if (!is_rotation(message.q_eci_body)) return false;
  sample.R_eci_body = rotation(message.q_eci_body);
  sample.rate_body = vector(message.rate_body);
  return sample.rate_body.squaredNorm() <= kMaxRate * kMaxRate;
}

/// Calls put(sample) for each valid attitude of the queue.
template <class Queue, class Put>
void for_each_attitude(GpsTime now, const Queue& packets, Inbox& inbox, Put&& put) {
  for (std::size_t k = 0; k < packets.size(); ++k) {
    navigation::AttitudeSample sample;
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

telemetry_event event_of(const sources::AidTransition& transition, std::int32_t device, std::int64_t step) {
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

void TrunkNavigation::configure(GpsTime now, const Telecommands& telecommands) {
  if (!telecommands.has_changed()) return;
  select(now, telecommands);
  if (telecommands.is_new<target_apriori>()) {
    trunk_.set_apriori(apriori_of(*telecommands.in_force<target_apriori>(), telecommands.time_of<target_apriori>()));
  }
}

/// Activates the sources that are selected and have all their telecommands in force, and stops the others.
void TrunkNavigation::select(GpsTime now, const Telecommands& telecommands) {
  const auto* navigation = telecommands.in_force<navigation_configuration>();
  if (navigation == nullptr) return;
  filter::FilterSettings blocks = trunk_settings(telecommands);
  std::array<bool, std::tuple_size_v<sources::SourceList>> is_used{};
  for_each(sources_, [&]<class Source>(Source& source, std::uint8_t index) {
    is_used[index] = source.configure({telecommands, blocks}) && (navigation->sources & Source::kUse) != 0;
  });
  trunk_.configure(blocks);
  for_each(sources_, [&](auto& source, std::uint8_t index) {
    if (is_used[index] && !source.aid().is_on()) source.aid().go_to(AidState::kWaiting, now);
    if (!is_used[index] && source.aid().is_on()) source.stop(now, trunk_);
  });
}

/// Returns the commanded attitude at `time`. The frame of the command rotates with the orbit, so that the state of the
/// filter is propagated to that time.
std::optional<Matrix3> TrunkNavigation::commanded_attitude(GpsTime time) const {
  if (!platform_.pointing || !trunk_.absolute_orbit().started()) return std::nullopt;
  const auto servicer = orbit::propagate_j2(trunk_.servicer(), seconds(time - trunk_.epoch()));
  if (!servicer.ok()) return std::nullopt;
  return sources::R_body_eci_of(*platform_.pointing, time, servicer.value());
}

void TrunkNavigation::take_attitudes(GpsTime now, Inbox& inbox) {
  attitudes_ = {};
  for_each_attitude(now, inbox.queue<vbar::attitude>(), inbox, [&](const navigation::AttitudeSample& sample) {
    const AttitudeGate::Verdict verdict = attitude_gate_.judge(sample, commanded_attitude(sample.time));
    if (verdict.used) platform_.servicer_attitude.put(*verdict.used);
    ++attitudes_.received;
    if (verdict.is_accepted) return;
    ++attitudes_.refused;
    attitudes_.difference = attitude_gate_.difference();
  });
  for_each_attitude(now, inbox.queue<vbar::crosslink_attitude>(), inbox,
                    [&](const navigation::AttitudeSample& sample) { platform_.target_attitude.put(sample); });
}

void TrunkNavigation::update(GpsTime now, Inbox& inbox, std::span<const navigation::Burn> burns) {
  Context context{now, inbox, platform_, gnss_};
  for_each(sources_, [](auto& source, std::uint8_t /*index*/) { source.aid().forget_inconsistency(); });
  take_attitudes(now, inbox);
  gnss_.drop_before(trunk_.epoch());  // not at the end: the safety monitor reads the epochs of the step
  gnss_.decode(inbox, trunk_.epoch());
  for_each(sources_, [&](auto& source, std::uint8_t index) {
    if (source.aid().is_on()) source.collect(context, {queue_, index});
  });
  process_records(context, burns);
  // Without records the epoch follows at a distance, so that the work of a step stays bounded.
  if (now - trunk_.epoch() > kLongestDelay + kLongestDelay) trunk_.advance_to(now - kLongestDelay, burns);
  for_each(sources_, [&](auto& source, std::uint8_t /*index*/) {
    if (source.aid().is_on()) source.watch(now, trunk_);
  });
  if (const auto stars = source<sources::BearingSource>().star_attitude()) {
    attitude_gate_.take_stars(stars->time, stars->R_eci_body);
  }
}

/// Returns the time up to which records are processed: the oldest one since which a record is pending.
GpsTime TrunkNavigation::fusion_horizon(GpsTime now) const {
  GpsTime until = now;
  for_each(sources_, [&](const auto& source, std::uint8_t /*index*/) {
    const std::optional<GpsTime> owed = source.aid().is_on() ? source.pending_since(now) : std::nullopt;
    if (owed && *owed < until) until = *owed;
  });
  return until;
}

void TrunkNavigation::process_records(Context& context, std::span<const navigation::Burn> burns) {
  const GpsTime until = fusion_horizon(context.now);
  for (std::size_t k = 0; k < sources::RecordQueue::kCapacity; ++k) {
    const sources::Record* next = queue_.front();
    if (next == nullptr || next->time > until) return;
    const sources::Record record = *next;
    queue_.pop();
    if (record.time < trunk_.epoch()) {
      context.inbox.count_unusable_time();
      continue;
    }
    trunk_.advance_to(record.time, burns);
    for_each(sources_, [&](auto& source, std::uint8_t index) {
      const bool is_used = index == record.source && source.aid().is_on() && !is_isolated(index);
      if (is_used) source.process_record(record, context, trunk_);
    });
  }
}

GpsTime TrunkNavigation::last_measurement() const {
  GpsTime last;
  for_each(sources_, [&](const auto& source, std::uint8_t /*index*/) {
    if (source.last_measurement() > last) last = source.last_measurement();
  });
  return last;
}

void TrunkNavigation::check_sources(GpsTime now, faults::FaultMonitor& faults) {
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
    const sources::Aid& aid = source.aid();
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
  const auto& network = source<sources::KeypointSource>().aiding().network_verdict();
  if (network && uses<sources::KeypointSource>()) {
    faults.check(now, {.fault = telemetry_health::kFaultPoseNetwork,
                       .is_detected = network->contradicts,
                       .device = sources::KeypointSource::kUse,
                       .argument = network->angle});
  }
  if (uses<sources::OwnGnssSource>()) receivers_.update(now, gnss_, uses<sources::CarrierSource>(), faults);
}

void TrunkNavigation::check_attitudes(GpsTime now, faults::FaultMonitor& faults) const {
  if (attitudes_.received == 0) return;
  faults.check(now, {.fault = telemetry_health::kFaultAttitude,
                     .is_detected = attitudes_.refused > 0,
                     .argument = attitudes_.difference});
}

/// Isolates a source, or inflates the covariance if no other source confirms the orbit. The statistics of its
/// innovations are re-initialised.
template <class Source>
void TrunkNavigation::isolate(GpsTime now, std::size_t index, Source& source) {
  const double mean = source.aid().consistency().mean();
  source.aid().consistency().reset();
  const bool is_too_large = mean > sources::Consistency::kMax;
  if constexpr (std::is_same_v<Source, sources::OwnGnssSource>) {
    if (is_too_large) trunk_.inflate_absolute_orbit(kAbsoluteOrbitInflation);
  } else if (!trunk_.is_confirmed_by_others({.bit = Source::kUse})) {
    if (is_too_large) trunk_.scale_relative_covariance(mean);
  } else {
    isolated_until_[index] = now + kIsolation;
    if constexpr (requires { source.suspend(now, trunk_); }) {
      source.suspend(now, trunk_);
    } else {
      source.aid().go_to(AidState::kSuspended, now);
    }
  }
}

void TrunkNavigation::report(Outbox& outbox, std::int64_t step, GpsTime now, const Inbox& inbox) const {
  const sources::Telemetry telemetry{outbox, step, now, inbox, gnss_, trunk_};
  for_each(sources_, [&]<class Source>(const Source& source, std::uint8_t /*index*/) {
    if (source.aid().is_on()) source.report(telemetry);
    for (const sources::AidTransition& transition : source.aid().transitions()) {
      outbox.send(transition.time, event_of(transition, Source::kUse, step));
    }
  });
}

void TrunkNavigation::forget_transitions() {
  for_each(sources_, [](auto& source, std::uint8_t /*index*/) { source.aid().forget_transitions(); });
}

}  // namespace vbar::fsw::gnc
