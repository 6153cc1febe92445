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

void TrunkNavigation::configure(GpsTime now, const Telecommands& telecommands) {
  const bool is_new = telecommands.is_new<navigation_configuration>() || telecommands.is_new<camera_configuration>() ||
                      telecommands.is_new<angles_only_configuration>() || telecommands.is_new<pose_configuration>() ||
                      telecommands.is_new<range_configuration>();
  if (is_new) configure_sources(now, telecommands);
  if (is_new || telecommands.is_new<target_apriori>()) configure_apriori(telecommands);
}

/// From all telecommands in force together: their order of arrival has no effect. The store has validated them, so that
/// no conversion fails.
void TrunkNavigation::configure_sources(GpsTime now, const Telecommands& telecommands) {
  const auto* navigation = telecommands.in_force<navigation_configuration>();
  if (navigation == nullptr) return;
  const auto carrier = carrier_settings(*navigation);
  if (!carrier.ok()) return;
  trunk::TrunkSettings blocks = carrier.value().blocks;
  std::get<sources::OwnGnssSource>(sources_).configure(carrier.value().carrier.servicer_antenna_body_m);
  std::get<sources::CarrierSource>(sources_).configure(carrier.value().carrier, carrier.value().pair_wait);
  configure_bearings(telecommands, blocks);
  configure_keypoints(telecommands, blocks);
  configure_ranges(telecommands);
  trunk_.configure(blocks);
  select_sources(now, telecommands);
}

void TrunkNavigation::configure_bearings(const Telecommands& telecommands, trunk::TrunkSettings& blocks) {
  const auto* known_camera = telecommands.in_force<camera_configuration>();
  const auto* angles_only = telecommands.in_force<angles_only_configuration>();
  if (known_camera == nullptr || angles_only == nullptr) return;
  const auto camera = camera_settings(*known_camera, *angles_only);
  const auto bearings = bearing_settings(*angles_only);
  if (!camera.ok() || !bearings.ok()) return;
  const trunk::TrunkSettings& tuned = bearings.value().blocks;
  blocks.burn_sigma = tuned.burn_sigma;
  blocks.burn_sigma_relative = tuned.burn_sigma_relative;
  blocks.relative_orbit.acceleration = tuned.relative_orbit.acceleration;
  blocks.brightness_offset = tuned.brightness_offset;
  blocks.boresight_a = tuned.boresight_a;
  std::get<sources::BearingSource>(sources_).configure(camera.value(), bearings.value().bearings);
}

void TrunkNavigation::configure_keypoints(const Telecommands& telecommands, trunk::TrunkSettings& blocks) {
  const auto* camera = telecommands.in_force<camera_configuration>();
  const auto* pose = telecommands.in_force<pose_configuration>();
  if (camera == nullptr || pose == nullptr) return;
  const auto keypoints = keypoint_settings(*camera, *pose);
  if (!keypoints.ok()) return;
  const trunk::TrunkSettings& tuned = keypoints.value().blocks;
  blocks.burn_sigma = tuned.burn_sigma;
  blocks.burn_sigma_relative = tuned.burn_sigma_relative;
  blocks.relative_orbit.acceleration = tuned.relative_orbit.acceleration;
  blocks.attitude = tuned.attitude;
  std::get<sources::KeypointSource>(sources_).configure(keypoints.value().keypoints);
  pose_apriori_ = keypoints.value().apriori;
}

void TrunkNavigation::configure_ranges(const Telecommands& telecommands) {
  const auto* ranges = telecommands.in_force<range_configuration>();
  if (ranges == nullptr) return;
  std::get<sources::RangeSource>(sources_).configure(
      {.noise_sigma_m = ranges->noise_sigma_m, .bias_sigma_m = ranges->bias_sigma_m});
}

/// As navigation_configuration.source, and a range finder beside any of them; a camera that is not configured is not a
/// source.
void TrunkNavigation::select_sources(GpsTime now, const Telecommands& telecommands) {
  const int source = telecommands.in_force<navigation_configuration>()->source;
  const bool has_camera = telecommands.in_force<camera_configuration>() != nullptr;
  const auto select = [&](auto& which, bool is_selected) {
    if (is_selected && !which.aid().is_on()) which.aid().go_to(AidState::kWaiting, now);
    if (!is_selected && which.aid().is_on()) which.stop(now, trunk_);
  };
  select(std::get<sources::IdealSource>(sources_), source == navigation_configuration::kSourceIdealNavigation);
  select(std::get<sources::OwnGnssSource>(sources_), source != navigation_configuration::kSourceIdealNavigation);
  select(std::get<sources::CarrierSource>(sources_), source == navigation_configuration::kSourceGnss);
  select(std::get<sources::BearingSource>(sources_), source == navigation_configuration::kSourceAnglesOnly &&
                                                         has_camera &&
                                                         telecommands.in_force<angles_only_configuration>() != nullptr);
  select(std::get<sources::KeypointSource>(sources_), source == navigation_configuration::kSourcePose && has_camera &&
                                                          telecommands.in_force<pose_configuration>() != nullptr);
  select(std::get<sources::RangeSource>(sources_), source != navigation_configuration::kSourceIdealNavigation &&
                                                       telecommands.in_force<range_configuration>() != nullptr);
}

/// With navigation by poses, ROE of preceding navigation take precedence over an absolute orbit, whichever of the two
/// telecommands arrived first. An a-priori orbit in use is set again only by a new telecommand: it has been propagated.
void TrunkNavigation::configure_apriori(const Telecommands& telecommands) {
  const auto* navigation = telecommands.in_force<navigation_configuration>();
  const bool is_pose =
      navigation != nullptr && navigation->source == navigation_configuration::kSourcePose && pose_apriori_.has_value();
  const auto* known = telecommands.in_force<target_apriori>();
  if (!is_pose && known == nullptr) return;
  const AprioriOrigin origin = is_pose ? AprioriOrigin::kPose : AprioriOrigin::kTarget;
  const bool is_new = is_pose ? telecommands.is_new<pose_configuration>() : telecommands.is_new<target_apriori>();
  if (origin == apriori_origin_ && !is_new) return;
  apriori_origin_ = origin;
  if (is_pose) return trunk_.set_apriori(*pose_apriori_);
  trunk::TargetApriori apriori;
  apriori.time = telecommands.time_of<target_apriori>();
  apriori.target = {vector(known->position_eci), vector(known->velocity_eci)};
  apriori.sigma_a_roe_m = vector(known->sigma_a_roe_m);
  trunk_.set_apriori(apriori);
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
