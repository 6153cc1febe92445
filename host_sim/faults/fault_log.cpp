#include "host_sim/faults/fault_log.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "fsw/packets/messages.h"
#include "host_sim/faults/faulty_thruster.h"
#include "host_sim/mission/names.h"
#include "host_sim/sensors/camera/camera_rows.h"

namespace vbar::faults {
namespace {

using fsw::GpsTime;
using fsw::packets::Apid;
using mission::FaultKind;

constexpr double kDegree = M_PI / 180.0;

/// Depends on every byte and its place (Fowler, Noll, Vo 1991).
std::uint64_t add_to_sum(std::uint64_t sum, std::span<const std::uint8_t> bytes) {
  for (const std::uint8_t byte : bytes) sum = (sum ^ byte) * 0x100000001B3U;
  return sum;
}
constexpr std::uint64_t kEmptySum = 0xCBF29CE484222325U;

double norm(const double (&v)[3]) {
  return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

/// The messages of a camera, a receiver, a star tracker and a range finder, by the words of their sensor's kind.
std::optional<Apid> message_of(const mission::Mission& mission, const mission::Fault& fault) {
  for (const mission::Spacecraft& spacecraft : mission.spacecraft) {
    if (spacecraft.name != fault.spacecraft) continue;
    for (const mission::Sensor& sensor : spacecraft.sensors) {
      if (sensor.name != fault.unit) continue;
      if (sensor.kind == "camera") return Apid::kImageTile;
      if (sensor.kind == "gnss") return spacecraft.flight_computer ? Apid::kGnssBytes : Apid::kCrosslinkGnssBytes;
      if (sensor.kind == "range_finder") return Apid::kRangeMeasurement;
      return Apid::kIdealNavigation;
    }
  }
  return std::nullopt;
}

/// Header unit of a camera: cameras for navigation are numbered in the order of the sensors.
std::uint8_t unit_of(const mission::Mission& mission, const std::string& name) {
  std::uint8_t unit = 0;
  for (const mission::Spacecraft& spacecraft : mission.spacecraft) {
    if (!spacecraft.flight_computer) continue;
    for (const mission::Sensor& sensor : spacecraft.sensors) {
      if (sensor.name == name) return unit;
      if (sensor.kind == "camera" && sensor.settings->navigation != 0) ++unit;
    }
  }
  return 0;
}

}  // namespace

FaultLog::FaultLog(const mission::Mission& mission, std::string servicer, std::string target, report::RunRecord& record)
    : mission_(mission), servicer_(std::move(servicer)), target_(std::move(target)), record_(record) {
  for (const mission::Fault& fault : mission.faults) {
    State state;
    state.fault = fault;
    states_.push_back(std::move(state));
  }
}

void FaultLog::witness_effect(State& state, GpsTime time, const std::string& evidence) {
  ++state.witnessed;
  if (!state.effect_s) state.effect_s = fsw::seconds(time - mission_.epoch);
  state.evidence = evidence;
}

void FaultLog::witness_recovery(State& state, GpsTime time) {
  if (state.effect_s && !state.recovered_s) state.recovered_s = fsw::seconds(time - mission_.epoch);
}

void FaultLog::on_truth(const twins::TruthSnapshot& truth) {
  const twins::SpacecraftTruth* const servicer = truth.find(servicer_);
  const twins::SpacecraftTruth* const target = truth.find(target_);
  if (servicer != nullptr) truth_ = *servicer;
  truth_time_ = truth.time;
  const auto has_begun = [&](const State& state) { return truth.time >= state.fault.begin; };
  if (servicer == nullptr || target == nullptr || std::ranges::none_of(states_, has_begun)) return;
  const double distance_m = (target->orbit.position_eci - servicer->orbit.position_eci).norm();
  min_distance_m_ = min_distance_m_ && *min_distance_m_ <= distance_m ? *min_distance_m_ : distance_m;
}

void FaultLog::on_step(std::uint32_t /*step*/, GpsTime time, std::span<const pil::Packet> inputs,
                       std::span<const pil::Packet> outputs) {
  look_at_packets(time, inputs);
  for (const pil::Packet& bytes : outputs) {
    const auto packet = fsw::packets::parse_packet(bytes);
    if (!packet.ok() || packet.value().header.apid != Apid::kManeuverCommand) continue;
    const auto command = fsw::packets::decode<maneuver_command>(packet.value());
    if (command.ok()) commanded_dv_[command.value().maneuver_id] = norm(command.value().dv_rtn);
  }
  for (State& state : states_) {
    switch (state.fault.kind) {
      case FaultKind::kSilent:
      case FaultKind::kReceiverSilent:
        look_at_silence(state, time);
        break;
      case FaultKind::kFrozen:
        look_at_images(state, time);
        break;
      case FaultKind::kAttitudeError:
        look_at_attitudes(state, time, inputs);
        break;
      case FaultKind::kThrustScale:
      case FaultKind::kThrustUncommanded:
        break;  // on_execution
      case FaultKind::kTargetTurned:
        break;  // finish
      case FaultKind::kComputerSilent:
      case FaultKind::kComputerReboot:
        if (time >= state.fault.begin && outputs.empty()) {
          witness_effect(state, time, fmt::format("{} steps without an answer", state.witnessed + 1));
        } else if (!state.fault.is_present(time) && !outputs.empty()) {
          witness_recovery(state, time);
        }
        break;
    }
  }
}

void FaultLog::look_at_packets(GpsTime /*time*/, std::span<const pil::Packet> inputs) {
  std::map<std::uint8_t, std::uint64_t> sums;
  for (const pil::Packet& bytes : inputs) {
    const auto packet = fsw::packets::parse_packet(bytes);
    if (!packet.ok()) continue;
    const fsw::packets::PacketHeader& header = packet.value().header;
    Stream& stream = streams_[{header.apid, header.unit}];
    if (stream.last.ns > 0 && header.time > stream.last) stream.interval = header.time - stream.last;
    stream.last = std::max(stream.last, header.time);
    if (header.apid != Apid::kImageTile) continue;
    const auto tile = fsw::packets::decode<image_tile>(packet.value());
    if (!tile.ok()) continue;
    const auto known = sums.emplace(header.unit, kEmptySum).first;
    known->second = add_to_sum(known->second, tile.value().data);
  }
  for (const auto& [unit, sum] : sums) image_sums_[unit] = {image_sums_[unit][1], sum};
}

std::optional<FaultLog::StreamKey> FaultLog::stream_of(const mission::Fault& fault) const {
  const auto apid = message_of(mission_, fault);
  if (!apid) return std::nullopt;
  return StreamKey{*apid, *apid == Apid::kImageTile ? unit_of(mission_, fault.unit) : std::uint8_t{0}};
}

/// Nothing for more than two intervals.
void FaultLog::look_at_silence(State& state, GpsTime time) {
  const auto key = stream_of(state.fault);
  const auto stream = key ? streams_.find(*key) : streams_.end();
  if (stream == streams_.end() || time < state.fault.begin) return;
  const fsw::Duration silent = time - stream->second.last;
  if (state.fault.is_present(time) && silent > stream->second.interval + stream->second.interval) {
    witness_effect(state, time, fmt::format("no packet for {:.0f} s", fsw::seconds(silent)));
  } else if (!state.fault.is_present(time) && stream->second.last >= state.fault.begin + *state.fault.duration) {
    witness_recovery(state, stream->second.last);
  }
}

void FaultLog::look_at_images(State& state, GpsTime time) {
  const auto key = stream_of(state.fault);
  if (!key || time < state.fault.begin) return;
  const auto stream = streams_.find(*key);
  const auto sums = image_sums_.find(key->second);
  if (stream == streams_.end() || sums == image_sums_.end()) return;
  const bool is_same = sums->second[0] == sums->second[1];
  if (is_same && stream->second.last >= state.fault.begin) {
    witness_effect(state, time, "two images in a row with the same pixels");
  } else if (!is_same && state.fault.duration && stream->second.last >= state.fault.begin + *state.fault.duration) {
    witness_recovery(state, stream->second.last);
  }
}

void FaultLog::look_at_attitudes(State& state, GpsTime time, std::span<const pil::Packet> inputs) {
  if (!truth_ || !truth_->attitude || time < state.fault.begin) return;
  for (const pil::Packet& bytes : inputs) {
    const auto packet = fsw::packets::parse_packet(bytes);
    if (!packet.ok() || packet.value().header.apid != Apid::kAttitude) continue;
    const auto measured = fsw::packets::decode<vbar::attitude>(packet.value());
    if (!measured.ok()) continue;
    const double(&q)[4] = measured.value().q_eci_body;
    const truth::AttitudeState& attitude = *truth_->attitude;
    const double back_s = fsw::seconds(packet.value().header.time - truth_time_);
    const double turn = back_s * attitude.rate_body.norm();
    const Eigen::Quaterniond since(
        Eigen::AngleAxisd(turn, turn != 0.0 ? fsw::Vector3(attitude.rate_body.normalized()) : fsw::Vector3::UnitX()));
    const Eigen::Quaterniond q_eci_body = attitude.q_body_eci.conjugate() * since;
    const double error = q_eci_body.angularDistance(Eigen::Quaterniond(q[0], q[1], q[2], q[3]));
    const bool is_wrong = error > 0.5 * state.fault.value;
    if (is_wrong) witness_effect(state, packet.value().header.time, fmt::format("off by {:.3f} deg", error / kDegree));
    if (!is_wrong && !state.fault.is_present(packet.value().header.time)) {
      witness_recovery(state, packet.value().header.time);
    }
  }
}

void FaultLog::on_execution(GpsTime time, const executed_maneuver& executed) {
  const double dv = norm(executed.dv_rtn);
  for (State& state : states_) {
    const bool is_uncommanded = executed.maneuver_id >= kFirstUncommanded;
    if (state.fault.kind == FaultKind::kThrustUncommanded && is_uncommanded && state.fault.is_present(time)) {
      witness_effect(state, time, fmt::format("{} impulses, the last of {:.3g} mm/s", state.witnessed + 1, 1e3 * dv));
    }
    if (state.fault.kind == FaultKind::kThrustUncommanded && !is_uncommanded && !state.fault.is_present(time) &&
        time > state.fault.begin) {
      witness_recovery(state, time);
    }
    const auto commanded = commanded_dv_.find(executed.maneuver_id);
    if (state.fault.kind != FaultKind::kThrustScale || commanded == commanded_dv_.end()) continue;
    const double ratio = dv / commanded->second;
    const bool is_off = std::abs(ratio - 1.0) > 0.5 * std::abs(state.fault.value - 1.0);
    if (is_off && state.fault.is_present(time)) {
      witness_effect(state, time, fmt::format("{} burns, the last at {:.3f} of its size", state.witnessed + 1, ratio));
    }
    if (!is_off && time > state.fault.begin && !state.fault.is_present(time)) witness_recovery(state, time);
  }
}

/// Poses that the flight software found in the images, against the truth.
void FaultLog::look_at_poses(State& state) {
  for (const sensors::PoseRow& pose : record_.tables.rows<sensors::PoseRow>()) {
    const GpsTime time = mission_.epoch + fsw::nearest_duration(pose.time_s);
    if (!pose.pnp_error_deg || time < state.fault.begin) continue;
    const bool is_off = *pose.pnp_error_deg > 0.5 * state.fault.value / kDegree;
    if (is_off && state.fault.is_present(time)) {
      witness_effect(state, time, fmt::format("pose off by {:.0f} deg", *pose.pnp_error_deg));
    } else if (!is_off && !state.fault.is_present(time)) {
      witness_recovery(state, time);
    }
  }
}

void FaultLog::finish() {
  for (State& state : states_)
    if (state.fault.kind == FaultKind::kTargetTurned) look_at_poses(state);
  int without_effect = 0;
  for (const State& state : states_) {
    const mission::Fault& fault = state.fault;
    report::FaultRow row;
    row.name = fault.name;
    row.kind = std::string(mission::name_of(fault.kind));
    row.unit = fault.unit;
    row.begin_s = fsw::seconds(fault.begin - mission_.epoch);
    if (fault.duration) row.end_s = row.begin_s + fsw::seconds(*fault.duration);
    row.effect_s = state.effect_s;
    row.recovered_s = state.recovered_s;
    row.witnessed = state.witnessed;
    row.evidence = state.evidence;
    record_.faults.push_back(row);
    if (!state.effect_s) ++without_effect;
  }
  if (states_.empty()) return;
  auto& figures = record_.summary.sensor_figures["faults"];
  figures["injected"] = static_cast<double>(states_.size());
  figures["without_effect"] = without_effect;
  if (min_distance_m_) figures["min_distance_m"] = *min_distance_m_;
}

}  // namespace vbar::faults
