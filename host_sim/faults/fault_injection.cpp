#include "host_sim/faults/fault_injection.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <future>
#include <mutex>
#include <utility>

#include <Eigen/Geometry>

#include "fsw/orbit/roe.h"
#include "fsw/packets/messages.h"
#include "fsw/packets/packet.h"

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
    if (!fault->is_present(truth.time)) continue;
    for (twins::SpacecraftTruth& spacecraft : seen.spacecraft) {
      if (spacecraft.name != fault->observed) continue;
      if (fault->kind == mission::FaultKind::kTargetTurned && spacecraft.attitude) {
        Eigen::Quaterniond& q_body_eci = spacecraft.attitude->q_body_eci;
        q_body_eci = Eigen::Quaterniond(Eigen::AngleAxisd(fault->value, fsw::Vector3::UnitX())) * q_body_eci;
      }
      // Behind the camera, in the opposite direction at the same distance.
      const twins::SpacecraftTruth* const carrier = truth.find(fault->spacecraft);
      if (fault->kind == mission::FaultKind::kTargetHidden && carrier != nullptr) {
        fsw::Vector3& position_eci = spacecraft.orbit.position_eci;
        position_eci = 2.0 * carrier->orbit.position_eci - position_eci;
      }
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

FaultyThruster::FaultyThruster(std::unique_ptr<twins::Actuator> thruster, std::shared_ptr<FaultSchedule> schedule)
    : thruster_(std::move(thruster)), schedule_(std::move(schedule)) {}

twins::Execution FaultyThruster::execute(const vbar::maneuver_command& command, fsw::GpsTime burn_time,
                                         fsw::GpsTime now) {
  if (command.maneuver_id < kFirstUncommanded && burn_time >= now) schedule_->on_ignition(burn_time);
  double scale = 1.0;
  bool is_reported = true;
  for (const mission::Fault& fault : schedule_->faults()) {
    if (!fault.is_present(burn_time)) continue;
    if (fault.kind == mission::FaultKind::kThrustScale && command.maneuver_id < kFirstUncommanded) {
      scale *= fault.value;
      is_reported = is_reported && fault.is_reported;
    }
  }
  if (command.maneuver_id >= kFirstUncommanded) {
    twins::Execution execution = thruster_->leak(command, burn_time);
    const bool is_told = std::ranges::any_of(schedule_->faults(), [&](const mission::Fault& fault) {
      return fault.kind == mission::FaultKind::kThrustUncommanded && fault.is_present(burn_time) && fault.is_reported;
    });
    if (!is_told) execution.packet.clear();
    return execution;
  }
  if (scale == 1.0) return thruster_->execute(command, burn_time, now);
  vbar::maneuver_command scaled = command;
  for (double& dv : scaled.dv_rtn) dv *= scale;
  twins::Execution execution = thruster_->execute(scaled, burn_time, now);
  if (!is_reported) execution.packet = thruster_->pretended_report(command, burn_time);
  return execution;
}

UncommandedImpulses::UncommandedImpulses(std::shared_ptr<const FaultSchedule> schedule)
    : schedule_(std::move(schedule)), is_taken_(schedule_->faults().size(), false) {}

std::vector<UncommandedImpulse> UncommandedImpulses::take() {
  std::vector<UncommandedImpulse> impulses;
  for (std::size_t k = 0; k < is_taken_.size(); ++k) {
    const mission::Fault& fault = schedule_->faults()[k];
    if (is_taken_[k] || fault.awaited || fault.kind != mission::FaultKind::kThrustUncommanded) continue;
    is_taken_[k] = true;
    const double total_s = fsw::seconds(*fault.duration);
    for (double from_s = 0.0; from_s < total_s; from_s += 1.0) {
      const double span_s = std::min(1.0, total_s - from_s);
      impulses.push_back({.time = fault.begin + fsw::nearest_duration(from_s + 0.5 * span_s),
                          .dv_rtn = fault.value * span_s * fault.direction_rtn,
                          .id = next_id_++});
    }
  }
  return impulses;
}

namespace {

using fsw::packets::Apid;

fsw::Vector3 vector(const double (&values)[3]) {
  return fsw::Vector3(values);
}

}  // namespace

std::optional<vbar::target_apriori> apriori_of(const vbar::telemetry_navigation& reported) {
  const auto servicer =
      fsw::orbit::qns_from_cartesian({vector(reported.servicer_position_eci), vector(reported.servicer_velocity_eci)});
  if (!servicer.ok()) return std::nullopt;
  fsw::Vector6 sigma_a_roe_m = fsw::Vector6::Zero();
  for (Eigen::Index k = 0; k < 6; ++k) {
    const fsw::Vector6 error = reported.sigma_rtn[k] * fsw::Vector6::Unit(k);
    sigma_a_roe_m += servicer.value().a * fsw::orbit::roe_from_rtn_linear(servicer.value(), error).cwiseAbs();
  }
  vbar::target_apriori apriori{};
  apriori.kind = vbar::target_apriori::kKindRoe;
  std::ranges::copy(reported.a_roe_mean_m, apriori.mean_a_roe_m);
  std::ranges::copy(sigma_a_roe_m, apriori.sigma_a_roe_m);
  return apriori;
}

void ReportedState::take(std::span<const pil::Packet> packets) {
  for (const pil::Packet& packet : packets) {
    if (const auto control = message_in<vbar::telemetry_control>(packet)) {
      is_retreating_ = control->second.mode == vbar::mode_command::kModeRetreat;
    } else if (const auto navigation = message_in<vbar::telemetry_navigation>(packet);
               navigation && navigation->second.valid != 0) {
      last_ = {navigation->first.header.time, navigation->second};
    }
  }
}

std::vector<pil::Packet> ReportedState::applied_to(std::vector<pil::Packet> telecommands, fsw::GpsTime now) const {
  const bool is_recent = last_ && now - last_->time <= kOldestReport;
  const auto apriori = is_recent ? apriori_of(last_->navigation) : std::nullopt;
  for (pil::Packet& packet : telecommands) {
    const auto view = fsw::packets::parse_packet(packet);
    if (!view.ok()) continue;
    fsw::packets::PacketHeader header = view.value().header;
    if (header.apid == Apid::kModeCommand && is_retreating_) {
      packet = packet_of(header, vbar::mode_command{.mode = vbar::mode_command::kModeRetreat});
    }
    if (header.apid != Apid::kTargetApriori || !apriori) continue;
    header.time = last_->time;
    pil::Packet reported(fsw::packets::kMaxPacketBytes);
    const auto size = fsw::packets::encode(header, *apriori, reported);
    if (!size.ok()) continue;  // not finite
    reported.resize(size.value());
    packet = std::move(reported);
  }
  return telecommands;
}

namespace {

using mission::FaultKind;

bool is_of_computer(const mission::Fault& fault) {
  return fault.kind == FaultKind::kComputerSilent || fault.kind == FaultKind::kComputerReboot;
}

}  // namespace

bool concern_computer(const std::vector<mission::Fault>& faults) {
  return std::ranges::any_of(faults, is_of_computer);
}

FaultyComputer::FaultyComputer(pil::FlightComputer& computer, std::shared_ptr<const FaultSchedule> schedule,
                               Start start, std::vector<pil::Packet> telecommands)
    : computer_(computer),
      schedule_(std::move(schedule)),
      start_(std::move(start)),
      telecommands_(std::move(telecommands)) {}

pil::StepResult FaultyComputer::step(std::uint32_t step, std::span<const pil::Packet> packets) {
  const auto tick = packets.empty() ? fsw::Result<fsw::packets::PacketView>(fsw::Status::kNotReady)
                                    : fsw::packets::parse_packet(packets.back());
  if (tick.ok()) {
    for (const mission::Fault& fault : schedule_->faults()) {
      if (!is_of_computer(fault) || !fault.is_present(tick.value().header.time)) continue;
      const bool begins = fault.kind == FaultKind::kComputerReboot && !must_restart_;
      if (begins && fault.keeps_state) snapshot_ = present().snapshot();
      must_restart_ = must_restart_ || fault.kind == FaultKind::kComputerReboot;
      pil::StepResult off;
      off.has_flown = false;
      return off;
    }
  }
  if (!must_restart_) return step_of(present(), step, packets);
  must_restart_ = false;
  present().close();
  restarted_ = start_();
  if (!snapshot_.empty()) {
    restarted_->restore(snapshot_);
    snapshot_.clear();
    return step_of(*restarted_, step, packets);
  }
  std::vector<pil::Packet> first =
      tick.ok() ? reported_.applied_to(telecommands_, tick.value().header.time) : telecommands_;
  first.insert(first.end(), packets.begin(), packets.end());
  return step_of(*restarted_, step, first);
}

pil::StepResult FaultyComputer::step_of(pil::FlightComputer& computer, std::uint32_t step,
                                        std::span<const pil::Packet> packets) {
  pil::StepResult result = computer.step(step, packets);
  reported_.take(result.packets);
  return result;
}

}  // namespace vbar::faults
