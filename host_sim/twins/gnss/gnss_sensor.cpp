#include "host_sim/twins/gnss/gnss_sensor.h"

#include <algorithm>
#include <utility>

namespace vbar::twins {
namespace {

Measurement failed(fsw::GpsTime time, const std::string& reason) {
  Measurement measurement;
  measurement.status = MeasurementStatus::kFailed;
  measurement.available = time;
  measurement.reason = "GNSS: " + reason;
  return measurement;
}

template <class Message>
Message attitude_message(const gnss::EpochAttitude& attitude) {
  const Eigen::Quaterniond q_eci_body = attitude.q_body_eci.conjugate();
  Message message{};
  message.q_eci_body[0] = q_eci_body.w();
  message.q_eci_body[1] = q_eci_body.x();
  message.q_eci_body[2] = q_eci_body.y();
  message.q_eci_body[3] = q_eci_body.z();
  std::copy(attitude.rate_body.begin(), attitude.rate_body.end(), message.rate_body);
  return message;
}

}  // namespace

gnss::BodyTruth gnss::body_truth(const TruthSnapshot& truth, const SpacecraftTruth& spacecraft) {
  const truth::AttitudeState& attitude = *spacecraft.attitude;
  BodyTruth body;
  body.time = truth.time;
  body.position_eci = spacecraft.orbit.position_eci;
  body.velocity_eci = spacecraft.orbit.velocity_eci;
  body.q_body_eci = attitude.q_body_eci;
  body.rate_body_eci = attitude.q_body_eci.conjugate() * attitude.rate_body;
  body.R_ecef_eci = truth.R_itrf_gcrf;
  body.acceleration_eci = spacecraft.acceleration_eci;
  body.angular_acceleration_body = spacecraft.angular_acceleration_body;
  return body;
}

GnssSensor::GnssSensor(const Settings& settings, std::unique_ptr<gnss::ReceiverBytes> receiver,
                       std::unique_ptr<gnss::Crosslink> crosslink)
    : settings_(settings),
      receiver_(std::move(receiver)),
      crosslink_(std::move(crosslink)),
      bytes_encoder_(settings.flight_number, 0),
      attitude_encoder_(settings.flight_number, 0) {}

std::optional<fsw::GpsTime> GnssSensor::next_epoch(fsw::GpsTime from) const {
  return next_periodic_epoch(settings_.start, settings_.period, from);
}

Measurement GnssSensor::measure(const TruthSnapshot& truth) {
  const SpacecraftTruth* spacecraft = truth.find(settings_.spacecraft);
  if (spacecraft == nullptr) return failed(truth.time, "no spacecraft \"" + settings_.spacecraft + "\"");
  if (!spacecraft->attitude) return failed(truth.time, "\"" + settings_.spacecraft + "\" has no attitude");

  gnss::ReceiverOutput output = receiver_->output_at(gnss::body_truth(truth, *spacecraft));
  Measurement measurement;
  if (!output.failure.empty()) measurement = failed(truth.time, output.failure);
  measurement.notes = std::move(output.notes);
  if (!output.failure.empty()) return measurement;
  measurement.status = MeasurementStatus::kReady;
  const fsw::GpsTime complete = truth.time + output.delay;
  measurement.available = complete;
  if (!output.is_epoch || truth.time < settings_.delivers_from) return measurement;
  const gnss::EpochAttitude measured = output.measured.value_or(
      gnss::EpochAttitude{truth.time, spacecraft->attitude->q_body_eci, spacecraft->attitude->rate_body});
  bool finite = true;
  if (crosslink_) {
    const std::optional<fsw::GpsTime> arrival = crosslink_->send(complete);
    if (!arrival) return measurement;
    measurement.available = *arrival;
    finite =
        append_packets<crosslink_gnss_bytes, crosslink_attitude>(truth.time, output, measured, measurement.packets);
  } else {
    finite = append_packets<gnss_bytes, attitude>(truth.time, output, measured, measurement.packets);
  }
  if (!finite) return failed(truth.time, "the truth holds a number that is not finite");
  return measurement;
}

template <class BytesMessage, class AttitudeMessage>
bool GnssSensor::append_packets(fsw::GpsTime arrival, const gnss::ReceiverOutput& output,
                                const gnss::EpochAttitude& measured, std::vector<Packet>& packets) {
  const std::vector<std::uint8_t>& bytes = output.bytes;
  BytesMessage message{};
  constexpr std::size_t kPiece = sizeof message.data;
  const std::size_t size = output.bytes_bypass_host ? 0 : bytes.size();
  for (std::size_t begin = 0; begin < size; begin += kPiece) {
    const std::size_t count = std::min(kPiece, size - begin);
    message = {};
    message.count = static_cast<std::int32_t>(count);
    std::copy_n(bytes.begin() + static_cast<std::ptrdiff_t>(begin), count, message.data);
    packets.push_back(*bytes_encoder_.encode(arrival, message));  // bytes are always finite
  }
  auto packet = attitude_encoder_.encode(measured.time, attitude_message<AttitudeMessage>(measured));
  if (packet) packets.push_back(std::move(*packet));
  return packet.has_value();
}

}  // namespace vbar::twins
