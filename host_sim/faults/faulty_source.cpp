#include "host_sim/faults/faulty_source.h"

#include <algorithm>
#include <array>
#include <future>
#include <mutex>
#include <utility>

#include <Eigen/Geometry>

#include "fsw/packets/messages.h"

namespace vbar::faults {
namespace {

using fsw::packets::PacketView;
using twins::Packet;

template <class Message>
std::optional<std::pair<PacketView, Message>> message_in(const Packet& packet) {
  const auto view = fsw::packets::parse_packet(packet);
  if (!view.ok() || view.value().header.apid != fsw::packets::MessageTraits<Message>::kApid) return std::nullopt;
  const auto message = fsw::packets::decode<Message>(view.value());
  if (!message.ok()) return std::nullopt;
  return std::pair(view.value(), message.value());
}

template <class Message>
Packet packet_of(const fsw::packets::PacketHeader& header, const Message& message) {
  std::array<std::uint8_t, fsw::packets::kMaxPacketBytes> buffer;
  const auto size = fsw::packets::encode(header, message, buffer);
  return Packet(buffer.begin(), buffer.begin() + static_cast<std::ptrdiff_t>(size.value()));
}

bool is_of_receiver(const Packet& packet) {
  using fsw::packets::Apid;
  const auto view = fsw::packets::parse_packet(packet);
  return view.ok() &&
         (view.value().header.apid == Apid::kGnssBytes || view.value().header.apid == Apid::kCrosslinkGnssBytes);
}

}  // namespace

struct FaultySource::LastImage {
  std::mutex mutex;
  std::vector<Packet> packets;

  /// Keeps the packets of an image that was taken properly.
  void keep(const std::vector<Packet>& taken) {
    const std::scoped_lock lock(mutex);
    packets = taken;
  }
  std::vector<Packet> in_place_of(std::vector<Packet> taken) {
    const std::scoped_lock lock(mutex);
    return with_pixels_of(packets, std::move(taken));
  }
};

FaultySource::FaultySource(std::unique_ptr<twins::PacketSource> source, std::shared_ptr<const FaultSchedule> schedule,
                           std::string name)
    : source_(std::move(source)), schedule_(std::move(schedule)), last_image_(std::make_shared<LastImage>()) {
  for (const mission::Fault& fault : schedule_->faults())
    if (is_of_source(fault, name)) faults_.push_back(&fault);
  is_upset_.resize(faults_.size(), false);
}

void FaultySource::upset_device(fsw::GpsTime time) {
  using mission::FaultKind;
  using twins::Upset;
  for (std::size_t k = 0; k < faults_.size(); ++k) {
    const mission::Fault& fault = *faults_[k];
    // At its end: a reset receiver is off before.
    if (is_upset_[k] || !fault.has_begun(time) || fault.is_present(time)) continue;
    std::optional<Upset> upset;
    if (fault.kind == FaultKind::kCycleSlip) upset = {Upset::Kind::kCycleSlip, fault.value, fault.satellite};
    if (fault.kind == FaultKind::kClockJump) upset = {Upset::Kind::kClockJump, fault.value, {}};
    if (fault.kind == FaultKind::kReceiverReset) upset = {Upset::Kind::kReset, 0.0, {}};
    if (upset && source_->upset(*upset)) is_upset_[k] = true;
  }
}

twins::TruthSnapshot FaultySource::seen(const twins::TruthSnapshot& truth) const {
  twins::TruthSnapshot seen = truth;
  for (const mission::Fault* const fault : faults_) {
    if (fault->kind != mission::FaultKind::kTargetTurned || !fault->is_present(truth.time)) continue;
    for (twins::SpacecraftTruth& spacecraft : seen.spacecraft) {
      if (spacecraft.name != fault->observed || !spacecraft.attitude) continue;
      Eigen::Quaterniond& q_body_eci = spacecraft.attitude->q_body_eci;
      q_body_eci = Eigen::Quaterniond(Eigen::AngleAxisd(fault->value, fsw::Vector3::UnitX())) * q_body_eci;
    }
  }
  return seen;
}

twins::Measurement FaultySource::measure(const twins::TruthSnapshot& truth) {
  using mission::FaultKind;
  upset_device(truth.time);
  twins::Measurement measurement = source_->measure(seen(truth));
  bool is_frozen = false;
  bool may_freeze = false;
  for (const mission::Fault* const each : faults_) {
    const mission::Fault& fault = *each;
    may_freeze = may_freeze || fault.kind == FaultKind::kFrozen;
    if (!fault.is_present(truth.time)) continue;
    if (fault.kind == FaultKind::kSilent) {
      // What another thread is making is awaited and thrown away, so that nothing outlives the source.
      if (measurement.pending.valid()) measurement.pending.wait();
      twins::Measurement nothing;
      nothing.status = twins::MeasurementStatus::kReady;
      nothing.available = measurement.available;
      return nothing;
    }
    if (fault.kind == FaultKind::kReceiverSilent || fault.kind == FaultKind::kReceiverReset)
      std::erase_if(measurement.packets, is_of_receiver);
    if (fault.kind == FaultKind::kAttitudeError) {
      for (Packet& packet : measurement.packets) packet = with_attitude_error(packet, fault.value);
    }
    is_frozen = is_frozen || fault.kind == FaultKind::kFrozen;
  }
  if (!may_freeze) return measurement;
  const auto treat = [image = last_image_, is_frozen](std::vector<Packet> packets) {
    if (is_frozen) return image->in_place_of(std::move(packets));
    image->keep(packets);
    return packets;
  };
  if (is_frozen) measurement.recipe.reset();  // it would render another image
  if (!measurement.pending.valid()) {
    if (!measurement.packets.empty()) measurement.packets = treat(std::move(measurement.packets));
    return measurement;
  }
  measurement.pending = std::async(std::launch::async, [treat, pending = std::move(measurement.pending)]() mutable {
    twins::Completion completion = pending.get();
    completion.packets = treat(std::move(completion.packets));
    return completion;
  });
  // One after the other: an image must be kept before the next one may repeat it.
  measurement.pending.wait();
  return measurement;
}

bool is_of_source(const mission::Fault& fault, std::string_view source) {
  return !fault.unit.empty() && source == fault.spacecraft + "/" + fault.unit;
}

Packet with_attitude_error(const Packet& packet, double angle) {
  auto found = message_in<vbar::attitude>(packet);
  if (!found) return packet;
  double(&q)[4] = found->second.q_eci_body;
  const Eigen::Quaterniond turned =
      Eigen::Quaterniond(q[0], q[1], q[2], q[3]) * Eigen::Quaterniond(Eigen::AngleAxisd(angle, fsw::Vector3::UnitX()));
  q[0] = turned.w();
  q[1] = turned.x();
  q[2] = turned.y();
  q[3] = turned.z();
  return packet_of(found->first.header, found->second);
}

std::vector<Packet> with_pixels_of(const std::vector<Packet>& last, std::vector<Packet> now) {
  for (std::size_t k = 0; k < now.size() && k < last.size(); ++k) {
    auto fresh = message_in<vbar::image_tile>(now[k]);
    const auto old = message_in<vbar::image_tile>(last[k]);
    if (!fresh || !old || fresh->second.tile != old->second.tile) continue;
    std::copy(std::begin(old->second.data), std::end(old->second.data), std::begin(fresh->second.data));
    now[k] = packet_of(fresh->first.header, fresh->second);
  }
  return now;
}

}  // namespace vbar::faults
