#include "host_sim/sensors/gnss/gnss_evaluation.h"

#include <algorithm>
#include <cmath>

#include "fsw/gnss/constants.h"
#include "fsw/gnss/single_point.h"
#include "fsw/messaging/message_fields.h"
#include "host_sim/sensors/gnss/gnss_rows.h"

namespace vbar::sensors {
namespace {

using fsw::Vector3;
using fsw::gnss::ReceiverUpdate;
using report::Triple;
using report::TruthRow;

/// A truth row at most this far from an epoch is at the epoch.
constexpr double kSameTime_s = 1e-6;

Vector3 vector_of(const Triple& v) {
  return {v[0], v[1], v[2]};
}

Vector3 relative_position(const TruthRow& row) {
  return vector_of(row.target_position_eci) - vector_of(row.servicer_position_eci);
}
Vector3 relative_velocity(const TruthRow& row) {
  return vector_of(row.target_velocity_eci) - vector_of(row.servicer_velocity_eci);
}

/// Cubic through positions and velocities. Relative motion of 100 m over 10 s: below a micrometre.
Vector3 hermite(const TruthRow& before, const TruthRow& after, double time_s) {
  const double h = after.time_s - before.time_s;
  const double u = (time_s - before.time_s) / h;
  const double u2 = u * u, u3 = u2 * u;
  return (2.0 * u3 - 3.0 * u2 + 1.0) * relative_position(before) + (u3 - 2.0 * u2 + u) * h * relative_velocity(before) +
         (3.0 * u2 - 2.0 * u3) * relative_position(after) + (u3 - u2) * h * relative_velocity(after);
}

fsw::orbit::EarthOrientation orientation_of(const vbar::earth_configuration& configuration) {
  return {.epoch = fsw::GpsTime{configuration.epoch_ns},
          .ut1_minus_gps_s = configuration.ut1_minus_gps_s,
          .ut1_rate = configuration.ut1_rate,
          .pole_x = configuration.pole_x,
          .pole_y = configuration.pole_y};
}

}  // namespace

void GnssEvaluation::on_inputs(fsw::GpsTime /*time*/, std::span<const twins::Packet> inputs) {
  for (const twins::Packet& bytes : inputs)
    if (const auto packet = fsw::packets::parse_packet(bytes); packet.ok()) take(packet.value());
  match_epochs();
}

void GnssEvaluation::take(const fsw::packets::PacketView& packet) {
  const fsw::GpsTime time = packet.header.time;
  if (const auto own = fsw::packets::decode<gnss_bytes>(packet); own.ok()) {
    take_bytes(kServicer, own.value());
  } else if (const auto other = fsw::packets::decode<crosslink_gnss_bytes>(packet); other.ok()) {
    take_bytes(kTarget, other.value());
  } else if (const auto attitude = fsw::packets::decode<vbar::attitude>(packet); attitude.ok()) {
    take_attitude(kServicer, time, attitude.value());
  } else if (const auto their_attitude = fsw::packets::decode<crosslink_attitude>(packet); their_attitude.ok()) {
    take_attitude(kTarget, time, their_attitude.value());
  } else if (const auto earth = fsw::packets::decode<vbar::earth_configuration>(packet); earth.ok()) {
    earth_ = earth.value();
  } else if (const auto receiver = fsw::packets::decode<vbar::receiver_configuration>(packet); receiver.ok()) {
    receiver_ = receiver.value();
  } else if (const auto carrier = fsw::packets::decode<vbar::carrier_configuration>(packet); carrier.ok()) {
    carrier_ = carrier.value();
  }
}

template <class Message>
void GnssEvaluation::take_bytes(std::size_t receiver, const Message& message) {
  constexpr auto kCapacity = static_cast<std::int32_t>(sizeof message.data);
  const std::int32_t count = std::clamp<std::int32_t>(message.count, 0, kCapacity);
  for (std::int32_t n = 0; n < count; ++n) {
    const ReceiverUpdate update = decoders_[receiver].push(message.data[n]);
    if (update == ReceiverUpdate::kObservations) {
      // One that is there already, or older than all of a full buffer, is not needed.
      static_cast<void>(waiting_[receiver].file(decoders_[receiver].observations()));
    } else if (update == ReceiverUpdate::kEphemeris) {
      static_cast<void>(ephemerides_.put(decoders_[receiver].ephemeris()));
    }
  }
}

template <class Message>
void GnssEvaluation::take_attitude(std::size_t receiver, fsw::GpsTime time, const Message& message) {
  if (!fsw::messaging::is_rotation(message.q_eci_body)) return;
  attitudes_[receiver].put(
      {time, fsw::messaging::rotation(message.q_eci_body), fsw::messaging::vector(message.rate_body)});
}

/// An epoch waits for that of the other receiver until a later one has arrived.
void GnssEvaluation::match_epochs() {
  while (const fsw::gnss::ObservationEpoch* const theirs = waiting_[kTarget].oldest()) {
    const fsw::GpsTime tag = theirs->receiver_time;
    const fsw::gnss::ObservationEpoch* const ours = waiting_[kServicer].find(tag);
    if (ours != nullptr) add_pair(*ours, *theirs);
    waiting_[kServicer].drop_through(tag);
    if (ours == nullptr && waiting_[kServicer].oldest() == nullptr) return;
    waiting_[kTarget].drop_through(tag);
  }
}

void GnssEvaluation::add_pair(const fsw::gnss::ObservationEpoch& ours, const fsw::gnss::ObservationEpoch& theirs) {
  using fsw::gnss::EarthFrame;
  if (!earth_ || !receiver_ || !carrier_) return;
  const fsw::GpsTime tag = ours.receiver_time;
  const EarthFrame frame = EarthFrame::at(tag, orientation_of(*earth_));
  const auto our_point = fsw::gnss::single_point(ours, ephemerides_, frame);
  const auto their_point = fsw::gnss::single_point(theirs, ephemerides_, frame);
  const auto our_attitude = attitudes_[kServicer].R_eci_body_at(tag);
  const auto their_attitude = attitudes_[kTarget].R_eci_body_at(tag);
  if (!our_point.ok() || !their_point.ok() || !our_attitude || !their_attitude) return;
  Pair& pair = pairs_.emplace_back();
  fsw::gnss::form_differences(ours, theirs, ephemerides_, frame, pair.differences);
  pair.servicer_eci = our_point.value().position_eci;
  pair.lever_arms_eci = *their_attitude * fsw::messaging::vector(carrier_->target_antenna_body_m) -
                        *our_attitude * fsw::messaging::vector(receiver_->antenna_body_m);
  // A clock that is ahead shows the tag before its time.
  pair.target_later_s = (our_point.value().clock_m - their_point.value().clock_m) / fsw::gnss::kSpeedOfLight;
}

void GnssEvaluation::on_answer(fsw::GpsTime time, std::span<const fsw::packets::PacketView> answer) {
  for (const fsw::packets::PacketView& packet : answer) {
    const auto telemetry = fsw::packets::decode<telemetry_gnss>(packet);
    if (!telemetry.ok()) continue;
    auto row = report::row_of<GnssRow>(telemetry.value());
    row.time_s = seconds_of(time);
    if (row.epoch_gps_ns != 0) row.epoch_s = seconds_of(fsw::GpsTime{row.epoch_gps_ns});
    context_.record.tables.rows<GnssRow>().push_back(row);
  }
  compare_with_truth();
}

void GnssEvaluation::compare_with_truth() {
  for (; !pairs_.empty(); pairs_.pop_front()) {
    const Pair& pair = pairs_.front();
    const double time_s = seconds_of(pair.differences.time);
    if (context_.record.truth.empty() || context_.record.truth.back().time_s < time_s - kSameTime_s) return;
    const std::optional<Relative> relative = relative_at(time_s);
    if (!relative) continue;
    const Vector3 baseline =
        relative->position_eci + pair.lever_arms_eci + pair.target_later_s * relative->target_velocity_eci;
    if (const auto epoch = residuals_of(pair.differences, pair.servicer_eci, baseline)) noise_.add(*epoch);
  }
}

/// Empty before the first step, and between two steps if there was a burn.
std::optional<GnssEvaluation::Relative> GnssEvaluation::relative_at(double time_s) const {
  const std::vector<TruthRow>& truth = context_.record.truth;
  const auto after = std::ranges::lower_bound(truth, time_s - kSameTime_s, {}, &TruthRow::time_s);
  if (after == truth.end()) return std::nullopt;
  const Vector3 velocity = vector_of(after->target_velocity_eci);
  if (after->time_s <= time_s + kSameTime_s) return Relative{relative_position(*after), velocity};
  if (after == truth.begin()) return std::nullopt;
  const auto before = std::prev(after);
  const bool has_burn = std::ranges::any_of(context_.record.maneuvers, [&](const report::ManeuverRow& row) {
    return row.execution_time_s >= before->time_s && row.execution_time_s <= after->time_s;
  });
  if (has_burn) return std::nullopt;
  return Relative{hermite(*before, *after, time_s), velocity};
}

void GnssEvaluation::finish() {
  for (SignalNoiseRow& row : noise_.rows()) context_.record.tables.rows<SignalNoiseRow>().push_back(std::move(row));
}

}  // namespace vbar::sensors
