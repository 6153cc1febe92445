#include "host_sim/faults/fault_log.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>
#include <utility>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "fsw/orbit/rtn.h"
#include "fsw/packets/messages.h"
#include "host_sim/faults/fault_injection.h"
#include "host_sim/faults/fault_schedule.h"
#include "host_sim/mission/mission.h"
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

bool is_upset_of_receiver(FaultKind kind) {
  return kind == FaultKind::kCycleSlip || kind == FaultKind::kClockJump || kind == FaultKind::kReceiverReset;
}

}  // namespace

FaultLog::FaultLog(const mission::Mission& mission, const FaultSchedule& schedule, std::string servicer,
                   std::string target, report::RunRecord& record)
    : mission_(mission), servicer_(std::move(servicer)), target_(std::move(target)), record_(record) {
  for (const mission::Fault& fault : schedule.faults()) {
    looks_at_receivers_ = looks_at_receivers_ || is_upset_of_receiver(fault.kind);
    states_.push_back(
        State{.fault = fault, .effect_s = {}, .over = {}, .witnessed = 0, .evidence = {}, .at_effect = {}});
  }
}

void FaultLog::observe_effect(State& state, GpsTime time, const std::string& evidence) {
  ++state.witnessed;
  if (!state.effect_s) state.effect_s = fsw::seconds(time - mission_.epoch);
  state.evidence = evidence;
}

void FaultLog::observe_end(State& state, GpsTime time) {
  if (state.effect_s && !state.over) state.over = time;
}

void FaultLog::on_truth(const twins::TruthSnapshot& truth) {
  const twins::SpacecraftTruth* const servicer = truth.find(servicer_);
  const twins::SpacecraftTruth* const target = truth.find(target_);
  if (servicer != nullptr) truth_ = *servicer;
  if (target != nullptr) target_truth_ = *target;
  truth_time_ = truth.time;
  const auto has_begun = [&](const State& state) { return state.fault.has_begun(truth.time); };
  if (servicer == nullptr || target == nullptr || std::ranges::none_of(states_, has_begun)) return;
  const double distance_m = (target->orbit.position_eci - servicer->orbit.position_eci).norm();
  min_distance_m_ = min_distance_m_ && *min_distance_m_ <= distance_m ? *min_distance_m_ : distance_m;
}

void FaultLog::on_step(std::uint32_t /*step*/, GpsTime time, std::span<const pil::Packet> inputs,
                       std::span<const pil::Packet> outputs) {
  look_at_packets(time, inputs);
  look_at_outputs(time, outputs);
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
      case FaultKind::kReceiverReset:
        look_at_silence(state, time);
        [[fallthrough]];
      case FaultKind::kCycleSlip:
      case FaultKind::kClockJump:
        look_at_receiver(state, time);
        break;
      case FaultKind::kThrustScale:
      case FaultKind::kThrustUncommanded:
        break;  // on_execution
      case FaultKind::kTargetTurned:
      case FaultKind::kTargetHidden:
        break;  // finish
      case FaultKind::kComputerSilent:
      case FaultKind::kComputerReboot:
        if (state.fault.has_begun(time) && outputs.empty()) {
          observe_effect(state, time, fmt::format("{} steps without an answer", state.witnessed + 1));
        } else if (!state.fault.is_present(time) && !outputs.empty()) {
          observe_end(state, time);
        }
        break;
    }
  }
}

void FaultLog::look_at_outputs(GpsTime time, std::span<const pil::Packet> outputs) {
  for (const pil::Packet& bytes : outputs) {
    const auto packet = fsw::packets::parse_packet(bytes);
    if (!packet.ok()) continue;
    aids_.take(time, packet.value());
    if (const auto command = fsw::packets::decode<maneuver_command>(packet.value()); command.ok()) {
      commanded_dv_[command.value().maneuver_id] = norm(command.value().dv_rtn);
    } else if (const auto telemetry = fsw::packets::decode<telemetry_gnss>(packet.value()); telemetry.ok()) {
      carrier_phase_ = telemetry.value();
    } else if (const auto estimate = fsw::packets::decode<telemetry_navigation>(packet.value()); estimate.ok()) {
      look_at_estimate(time, estimate.value());
    }
  }
}

void FaultLog::look_at_packets(GpsTime /*time*/, std::span<const pil::Packet> inputs) {
  std::map<std::uint8_t, std::uint64_t> sums;
  epochs_.clear();
  for (const pil::Packet& bytes : inputs) {
    const auto packet = fsw::packets::parse_packet(bytes);
    if (!packet.ok()) continue;
    const fsw::packets::PacketHeader& header = packet.value().header;
    Stream& stream = streams_[{header.apid, header.unit}];
    if (stream.last.ns > 0 && header.time > stream.last) stream.interval = header.time - stream.last;
    stream.last = std::max(stream.last, header.time);
    if (looks_at_receivers_ && (header.apid == Apid::kGnssBytes || header.apid == Apid::kCrosslinkGnssBytes)) {
      std::ranges::move(receivers_[header.apid].take(packet.value()), std::back_inserter(epochs_[header.apid]));
    }
    if (header.apid != Apid::kImageTile) continue;
    const auto tile = fsw::packets::decode<image_tile>(packet.value());
    if (!tile.ok()) continue;
    const auto known = sums.emplace(header.unit, kEmptySum).first;
    known->second = add_to_sum(known->second, tile.value().data);
  }
  for (const auto& [unit, sum] : sums) image_sums_[unit] = {image_sums_[unit][1], sum};
}

void FaultLog::look_at_receiver(State& state, GpsTime time) {
  const auto key = stream_of(mission_, state.fault);
  const auto epochs = key ? epochs_.find(key->first) : epochs_.end();
  if (epochs != epochs_.end() && state.fault.has_begun(time)) {
    for (const ReceiverEpoch& epoch : epochs->second) {
      if (state.fault.kind == FaultKind::kCycleSlip) look_for_slip(state, epoch, time);
      if (state.fault.kind == FaultKind::kClockJump && !state.over && epoch.clock_jump_s &&
          std::abs(*epoch.clock_jump_s - state.fault.value) < 0.2 * std::abs(state.fault.value)) {
        observe_effect(state, time, fmt::format("pseudoranges jump by {:.3g} s", *epoch.clock_jump_s));
        observe_end(state, time);
      }
      // No carrier of before goes on.
      if (state.fault.kind == FaultKind::kReceiverReset && !state.over && epoch.known > 0 &&
          epoch.restarted == epoch.known) {
        observe_effect(state, time, fmt::format("{} carriers, all locked again", epoch.carriers));
        observe_end(state, time);
      }
    }
  }
  if (state.fault.kind == FaultKind::kCycleSlip) look_for_reaction(state, time);
}

/// One satellite slips by the commanded cycles; with all satellites, most slip by a multiple.
void FaultLog::look_for_slip(State& state, const ReceiverEpoch& epoch, GpsTime time) {
  std::set<fsw::gnss::SatelliteId> satellites;
  std::size_t as_commanded = 0;
  const bool is_of_all = state.fault.satellite == "all";
  for (const ReceiverEpoch::Slip& slip : epoch.slips) {
    const double ratio = slip.cycles / state.fault.value;
    const double nearest = is_of_all ? std::round(ratio) : 1.0;
    satellites.insert(slip.satellite);
    if (std::abs(ratio - nearest) * std::abs(state.fault.value) < 0.3) ++as_commanded;
  }
  const bool is_seen = as_commanded == epoch.slips.size() && as_commanded > 0 &&
                       (is_of_all ? 2 * as_commanded > epoch.carriers : satellites.size() == 1);
  if (state.effect_s || !is_seen) return;
  observe_effect(state, time,
                 fmt::format("{} carriers of {} satellites jump, the first by {:.2f} cycles", as_commanded,
                             satellites.size(), epoch.slips.front().cycles));
  state.at_effect = carrier_phase_;
}

/// The flight software has refused the phase or given up integers, and holds integers again.
void FaultLog::look_for_reaction(State& state, GpsTime time) {
  if (!state.at_effect || !carrier_phase_ || state.over) return;
  const telemetry_gnss& now = *carrier_phase_;
  const telemetry_gnss& then = *state.at_effect;
  const bool has_reacted = now.slips != then.slips || now.releases != then.releases ||
                           now.phases_refused != then.phases_refused || now.restarts != then.restarts;
  if (has_reacted && now.fixed > 0) observe_end(state, time);
}

/// Detects that a stream has been silent for more than two intervals.
void FaultLog::look_at_silence(State& state, GpsTime time) {
  const auto key = stream_of(mission_, state.fault);
  const auto stream = key ? streams_.find(*key) : streams_.end();
  if (stream == streams_.end() || time < state.fault.begin) return;
  const fsw::Duration silent = time - stream->second.last;
  if (state.fault.is_present(time) && silent > stream->second.interval + stream->second.interval) {
    observe_effect(state, time, fmt::format("no packet for {:.0f} s", fsw::seconds(silent)));
  } else if (!state.fault.is_present(time) && stream->second.last >= state.fault.begin + *state.fault.duration) {
    observe_end(state, stream->second.last);
  }
}

void FaultLog::look_at_images(State& state, GpsTime time) {
  const auto key = stream_of(mission_, state.fault);
  if (!key || time < state.fault.begin) return;
  const auto stream = streams_.find(*key);
  const auto sums = image_sums_.find(key->second);
  if (stream == streams_.end() || sums == image_sums_.end()) return;
  const bool is_same = sums->second[0] == sums->second[1];
  if (is_same && stream->second.last >= state.fault.begin) {
    observe_effect(state, time, "two images in a row with the same pixels");
  } else if (!is_same && state.fault.duration && stream->second.last >= state.fault.begin + *state.fault.duration) {
    observe_end(state, stream->second.last);
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
    if (is_wrong) observe_effect(state, packet.value().header.time, fmt::format("off by {:.3f} deg", error / kDegree));
    if (!is_wrong && !state.fault.is_present(packet.value().header.time)) {
      observe_end(state, packet.value().header.time);
    }
  }
}

void FaultLog::on_execution(GpsTime time, const executed_maneuver& executed) {
  const double dv = norm(executed.dv_rtn);
  for (State& state : states_) {
    const bool is_uncommanded = executed.maneuver_id >= kFirstUncommanded;
    if (state.fault.kind == FaultKind::kThrustUncommanded && is_uncommanded && state.fault.is_present(time)) {
      observe_effect(state, time, fmt::format("{} impulses, the last of {:.3g} mm/s", state.witnessed + 1, 1e3 * dv));
    }
    if (state.fault.kind == FaultKind::kThrustUncommanded && !is_uncommanded && !state.fault.is_present(time) &&
        time > state.fault.begin) {
      observe_end(state, time);
    }
    const auto commanded = commanded_dv_.find(executed.maneuver_id);
    if (state.fault.kind != FaultKind::kThrustScale || commanded == commanded_dv_.end()) continue;
    const double ratio = dv / commanded->second;
    const bool is_off = std::abs(ratio - 1.0) > 0.5 * std::abs(state.fault.value - 1.0);
    if (is_off && state.fault.is_present(time)) {
      observe_effect(state, time, fmt::format("{} burns, the last at {:.3f} of its size", state.witnessed + 1, ratio));
    }
    if (!is_off && time > state.fault.begin && !state.fault.is_present(time)) observe_end(state, time);
  }
}

/// Poses that the flight software found in the images, against the truth.
void FaultLog::look_at_poses(State& state) {
  for (const sensors::PoseRow& pose : record_.tables.rows<sensors::PoseRow>()) {
    const GpsTime time = mission_.epoch + fsw::nearest_duration(pose.time_s);
    if (!pose.pnp_error_deg || time < state.fault.begin) continue;
    const bool is_off = *pose.pnp_error_deg > 0.5 * state.fault.value / kDegree;
    if (is_off && state.fault.is_present(time)) {
      observe_effect(state, time, fmt::format("pose off by {:.0f} deg", *pose.pnp_error_deg));
    } else if (!is_off && !state.fault.is_present(time)) {
      observe_end(state, time);
    }
  }
}

/// Images of an illuminated target in which no object is where the target is.
void FaultLog::look_for_target(State& state) {
  int without = 0;
  const auto look = [&](GpsTime time, bool is_seen) {
    if (state.fault.is_present(time) && !is_seen) {
      observe_effect(state, time, fmt::format("{} images without the illuminated target", ++without));
    } else if (state.fault.has_begun(time) && !state.fault.is_present(time) && is_seen) {
      observe_end(state, time);
    }
  };
  for (const sensors::ImageRow& image : record_.tables.rows<sensors::ImageRow>())
    if (image.sunlit.value_or(0.0) > 0.5)
      look(mission_.epoch + fsw::nearest_duration(image.time_s), image.true_object >= 0);
  for (const sensors::PoseRow& pose : record_.tables.rows<sensors::PoseRow>())
    if (pose.sunlit.value_or(0.0) > 0.5)
      look(mission_.epoch + fsw::nearest_duration(pose.time_s), pose.status == telemetry_pose::kStatusPose);
}

void FaultLog::finish() {
  for (State& state : states_) {
    if (state.fault.kind == FaultKind::kTargetTurned) look_at_poses(state);
    if (state.fault.kind == FaultKind::kTargetHidden) look_for_target(state);
  }
  if (states_.empty()) return;
  auto& figures = record_.summary.sensor_figures["faults"];
  figures["injected"] = static_cast<double>(states_.size());
  if (min_distance_m_) figures["min_distance_m"] = *min_distance_m_;
  double& without_effect = figures["without_effect"];
  double& not_recovered = figures["not_recovered"];
  for (const State& state : states_) {
    const report::FaultRow row = row_of(state);
    record_.faults.push_back(row);
    if (!row.effect_s) ++without_effect;
    if (!row.effect_s || !row.end_s || *row.end_s > fsw::seconds(mission_.end_time() - mission_.epoch)) continue;
    if (row.recovered_s) {
      double& after_s = figures[row.name + ".recovered_after_s"];
      after_s = std::max(after_s, *row.recovered_s - *row.end_s);  // the last of several faults of one name
    } else {
      ++not_recovered;
    }
  }
}

/// The truth of the step, which precedes its packets, against the estimate: position, root of the sum of squares.
void FaultLog::look_at_estimate(GpsTime time, const telemetry_navigation& estimate) {
  constexpr double kSigmas = 3.0;
  if (states_.empty() || !truth_ || !target_truth_ || truth_time_ != time) return;
  const auto relative = fsw::orbit::relative_state_rtn(truth_->orbit, target_truth_->orbit);
  double error = 0.0, variance = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    const double miss = estimate.relative_position_rtn[axis] - relative.position_rtn(axis);
    error += miss * miss;
    variance += estimate.sigma_rtn[axis] * estimate.sigma_rtn[axis];
  }
  consistency_.push_back({time, estimate.valid != 0 && error <= kSigmas * kSigmas * variance});
}

/// The first step from `from` on at which the estimate is within three sigmas of the truth, as in the steps after it:
/// an estimate that is wrong passes the truth at times. Empty if there is none; `from` without estimates.
std::optional<GpsTime> FaultLog::first_consistent(GpsTime from) const {
  constexpr std::ptrdiff_t kSteps = 10;
  if (consistency_.empty()) return from;
  auto step = std::ranges::lower_bound(consistency_, from, {}, &Consistency::time);
  for (; step != consistency_.end(); ++step) {
    const auto last = step + std::min(kSteps, consistency_.end() - step);
    if (std::all_of(step, last, [](const Consistency& one) { return one.is_consistent; })) return step->time;
  }
  return std::nullopt;
}

/// All sources that aided before the fault aid again, and the estimate is consistent.
std::optional<GpsTime> FaultLog::recovery_of(const State& state) const {
  if (!state.over) return std::nullopt;
  const std::int32_t needed = aids_concerned(mission_, state.fault) & aids_.before(state.fault.begin);
  const std::optional<GpsTime> aided = aids_.first_with(needed, *state.over);
  const auto consistent = aided ? first_consistent(*aided) : std::nullopt;
  return consistent ? std::max(aided, consistent) : std::nullopt;
}

report::FaultRow FaultLog::row_of(const State& state) const {
  const mission::Fault& fault = state.fault;
  const auto seconds_of = [this](GpsTime time) { return fsw::seconds(time - mission_.epoch); };
  report::FaultRow row;
  row.name = fault.name;
  row.kind = std::string(mission::name_of(fault.kind));
  row.unit = fault.unit;
  row.event = fault.start;
  if (!fault.awaited) {
    row.begin_s = seconds_of(fault.begin);
    if (fault.duration) row.end_s = *row.begin_s + fsw::seconds(*fault.duration);
  }
  row.effect_s = state.effect_s;
  if (const auto recovery = recovery_of(state)) row.recovered_s = seconds_of(*recovery);
  row.witnessed = state.witnessed;
  row.evidence = state.evidence;
  return row;
}

}  // namespace vbar::faults
