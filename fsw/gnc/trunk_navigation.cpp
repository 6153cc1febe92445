#include "fsw/gnc/trunk_navigation.h"

#include "fsw/gnc/camera_configuration.h"
#include "fsw/gnc/gnss_configuration.h"
#include "fsw/gnc/message_fields.h"

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

/// False for a quaternion whose length differs from one by more than a part in a thousand, or for an impossible rate.
template <class Message>
bool attitude_of(const Message& message, navigation::AttitudeSample& sample) {
  if (!is_rotation(message.q_eci_body)) return false;
  sample.R_eci_body = rotation(message.q_eci_body);
  sample.rate_body = vector(message.rate_body);
  return sample.rate_body.squaredNorm() <= kMaxRate * kMaxRate;
}

template <class Queue>
void put_attitudes(GpsTime now, const Queue& packets, Inbox& inbox, navigation::AttitudeHistory& history) {
  for (std::size_t k = 0; k < packets.size(); ++k) {
    navigation::AttitudeSample sample;
    sample.time = packets[k].tag.time;
    if (sample.time > now) {
      inbox.count_unusable_time();
    } else if (attitude_of(packets[k].value, sample)) {
      history.put(sample);
    } else {
      inbox.count_bad_content();
    }
  }
}

}  // namespace

void TrunkNavigation::configure(GpsTime now, Inbox& inbox) {
  take_apriori(now, inbox);
  const bool has_any =
      !inbox.queue<vbar::navigation_configuration>().empty() || !inbox.queue<vbar::camera_configuration>().empty() ||
      !inbox.queue<vbar::angles_only_configuration>().empty() || !inbox.queue<vbar::pose_configuration>().empty();
  if (!has_any) return;
  inbox.keep_newest(inbox.queue<vbar::navigation_configuration>(), now, navigation_);
  inbox.keep_newest(inbox.queue<vbar::camera_configuration>(), now, camera_);
  inbox.keep_newest(inbox.queue<vbar::angles_only_configuration>(), now, angles_only_);
  inbox.keep_newest(inbox.queue<vbar::pose_configuration>(), now, pose_);
  configure_sources(now, inbox);
}

void TrunkNavigation::configure_sources(GpsTime now, Inbox& inbox) {
  if (!navigation_) return;
  const auto carrier = carrier_settings(*navigation_);
  if (!carrier.ok()) {
    inbox.count_bad_content();
    navigation_.reset();
    return;
  }
  trunk::TrunkSettings blocks = carrier.value().blocks;
  std::get<sources::OwnGnssSource>(sources_).configure(carrier.value().carrier.servicer_antenna_body_m);
  std::get<sources::CarrierSource>(sources_).configure(carrier.value().carrier, carrier.value().pair_wait);
  if (!configure_bearings(blocks) || !configure_keypoints(blocks)) {
    inbox.count_bad_content();
    return;
  }
  trunk_.configure(blocks);
  select_sources(now);
}

/// False if the telecommands are invalid; they are discarded.
bool TrunkNavigation::configure_bearings(trunk::TrunkSettings& blocks) {
  if (!camera_ || !angles_only_) return true;
  const auto camera = camera_settings(*camera_, *angles_only_);
  const auto bearings = bearing_settings(*angles_only_);
  if (!camera.ok() || !bearings.ok()) {
    camera_.reset();
    angles_only_.reset();
    return false;
  }
  const trunk::TrunkSettings& tuned = bearings.value().blocks;
  blocks.burn_sigma = tuned.burn_sigma;
  blocks.burn_sigma_relative = tuned.burn_sigma_relative;
  blocks.relative_orbit.acceleration = tuned.relative_orbit.acceleration;
  blocks.brightness_offset = tuned.brightness_offset;
  blocks.boresight_a = tuned.boresight_a;
  std::get<sources::BearingSource>(sources_).configure(camera.value(), bearings.value().bearings);
  return true;
}

bool TrunkNavigation::configure_keypoints(trunk::TrunkSettings& blocks) {
  if (!camera_ || !pose_) return true;
  const auto keypoints = keypoint_settings(*camera_, *pose_);
  if (!keypoints.ok()) {
    camera_.reset();
    pose_.reset();
    return false;
  }
  const trunk::TrunkSettings& tuned = keypoints.value().blocks;
  blocks.burn_sigma = tuned.burn_sigma;
  blocks.burn_sigma_relative = tuned.burn_sigma_relative;
  blocks.relative_orbit.acceleration = tuned.relative_orbit.acceleration;
  blocks.attitude = tuned.attitude;
  std::get<sources::KeypointSource>(sources_).configure(keypoints.value().keypoints);
  if (keypoints.value().apriori) trunk_.set_apriori(*keypoints.value().apriori);
  return true;
}

/// As navigation_configuration.source; a camera that is not configured is not a source.
void TrunkNavigation::select_sources(GpsTime now) {
  const int source = navigation_->source;
  const auto select = [&](auto& which, bool is_selected) {
    if (is_selected && !which.aid().is_on()) which.aid().go_to(AidState::kWaiting, now);
    if (!is_selected && which.aid().is_on()) which.stop(now, trunk_);
  };
  select(std::get<sources::IdealSource>(sources_), source == navigation_configuration::kSourceIdealNavigation);
  select(std::get<sources::OwnGnssSource>(sources_), source != navigation_configuration::kSourceIdealNavigation);
  select(std::get<sources::CarrierSource>(sources_), source == navigation_configuration::kSourceGnss);
  select(std::get<sources::BearingSource>(sources_),
         source == navigation_configuration::kSourceAnglesOnly && camera_ && angles_only_);
  select(std::get<sources::KeypointSource>(sources_),
         source == navigation_configuration::kSourcePose && camera_ && pose_);
}

void TrunkNavigation::take_apriori(GpsTime now, Inbox& inbox) {
  const auto& aprioris = inbox.queue<vbar::target_apriori>();
  for (std::size_t k = 0; k < aprioris.size(); ++k) {
    const target_apriori& known = aprioris[k].value;
    trunk::TargetApriori apriori;
    apriori.time = aprioris[k].tag.time;
    apriori.target = {vector(known.position_eci), vector(known.velocity_eci)};
    apriori.sigma_a_roe_m = vector(known.sigma_a_roe_m);
    const bool is_usable = apriori.time <= now && orbit::qns_from_cartesian(apriori.target).ok() &&
                           (apriori.sigma_a_roe_m.array() > 0.0).all() && (apriori.sigma_a_roe_m.array() < 1e6).all();
    if (is_usable) {
      trunk_.set_apriori(apriori);
    } else {
      inbox.count_bad_content();
    }
  }
}

void TrunkNavigation::take_attitudes(GpsTime now, Inbox& inbox) {
  put_attitudes(now, inbox.queue<vbar::attitude>(), inbox, platform_.servicer_attitude);
  put_attitudes(now, inbox.queue<vbar::crosslink_attitude>(), inbox, platform_.target_attitude);
}

void TrunkNavigation::update(GpsTime now, Inbox& inbox, std::span<const navigation::Burn> burns) {
  Context context{now, inbox, platform_, gnss_};
  take_attitudes(now, inbox);
  gnss_.decode(inbox, trunk_.epoch());
  for_each(sources_, [&](auto& source, std::uint8_t index) {
    if (source.aid().is_on()) source.collect(context, {queue_, index});
  });
  fold_records(context, burns);
  gnss_.drop_before(trunk_.epoch());
  // Without records the epoch follows at a distance, so that the work of a step stays bounded.
  if (now - trunk_.epoch() > kLongestDelay + kLongestDelay) trunk_.advance_to(now - kLongestDelay, burns);
  for_each(sources_, [&](auto& source, std::uint8_t /*index*/) {
    if (source.aid().is_on()) source.watch(now, trunk_);
  });
}

/// Not beyond the oldest record that a source still owes.
GpsTime TrunkNavigation::owed_until(GpsTime now) const {
  GpsTime until = now;
  for_each(sources_, [&](const auto& source, std::uint8_t /*index*/) {
    const std::optional<GpsTime> owed = source.aid().is_on() ? source.owes(now) : std::nullopt;
    if (owed && *owed < until) until = *owed;
  });
  return until;
}

void TrunkNavigation::fold_records(Context& context, std::span<const navigation::Burn> burns) {
  const GpsTime until = owed_until(context.now);
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
    trunk_.set_source(record.source);
    for_each(sources_, [&](auto& source, std::uint8_t index) {
      if (index == record.source && source.aid().is_on()) source.fold(record, context, trunk_);
    });
  }
}

GpsTime TrunkNavigation::last_measurement() const {
  GpsTime last = source<sources::IdealSource>().last_measurement();
  const auto compare = [&](GpsTime measured) { last = measured > last ? measured : last; };
  compare(source<sources::CarrierSource>().last_measurement());
  compare(source<sources::BearingSource>().last_measurement());
  compare(source<sources::KeypointSource>().last_measurement());
  return last;
}

void TrunkNavigation::report(Outbox& outbox, std::int64_t step, GpsTime now, const Inbox& inbox) const {
  const sources::Telemetry telemetry{outbox, step, now, inbox, gnss_, trunk_};
  for_each(sources_, [&](const auto& source, std::uint8_t /*index*/) {
    if (source.aid().is_on()) source.report(telemetry);
  });
}

}  // namespace vbar::fsw::gnc
