#include "hil_drivers/external/served_truth.h"

#include <stdexcept>

#include <fmt/format.h>

#include "fsw/packets/messages.h"

namespace vbar::external {
namespace {

using fsw::packets::Apid;

fsw::Vector3 vector_of(const double (&numbers)[3]) {
  return {numbers[0], numbers[1], numbers[2]};
}

bool is_same_orbit(const fsw::orbit::CartesianState& a, const fsw::orbit::CartesianState& b) {
  return a.position_eci == b.position_eci && a.velocity_eci == b.velocity_eci;
}

}  // namespace

std::vector<twins::Packet> ServedTruth::answer(const Batch& batch) {
  Answer answer;
  answer.available = batch.time;
  if (batch.opening) {
    start(batch);
  } else {
    if (!world_) throw std::runtime_error("a batch before the start of the truth");
    for (const Command& command : batch.commands) apply(command);
    world_->advance_to(batch.time);
    answer.packets = packets_of(world_->snapshot(twins::TruthDetail::kAccelerations), numbers_);
  }
  return packets_of(std::move(answer), batch.time);
}

void ServedTruth::start(const Batch& batch) {
  if (world_) throw std::runtime_error("a second start of the truth");
  if (!batch.truth) throw std::runtime_error("a start of the truth without states");
  world_ = make_();
  const twins::TruthSnapshot own = world_->snapshot(twins::TruthDetail::kStates);
  for (const twins::SpacecraftTruth& one : own.spacecraft) {
    const twins::SpacecraftTruth* const of_run = batch.truth->find(one.name);
    if (of_run == nullptr || own.time != batch.time || !is_same_orbit(of_run->orbit, one.orbit))
      throw std::runtime_error(
          fmt::format("the run starts the spacecraft {} elsewhere than the mission that is served", one.name));
  }
}

void ServedTruth::apply(const Command& command) {
  const auto packet = fsw::packets::parse_packet(command.packet);
  if (!packet.ok()) throw std::runtime_error("a command that is no packet");
  const fsw::GpsTime time = packet.value().header.time;
  if (packet.value().header.apid == Apid::kExecutedManeuver) {
    const auto maneuver = fsw::packets::decode<vbar::executed_maneuver>(packet.value());
    if (!maneuver.ok()) throw std::runtime_error("an executed_maneuver of another version of vbar.lcm");
    world_->advance_to(time);
    world_->apply_impulse_rtn(vector_of(maneuver.value().dv_rtn));
  } else if (packet.value().header.apid == Apid::kPointingCommand) {
    const auto pointing = fsw::packets::decode<vbar::pointing_command>(packet.value());
    if (!pointing.ok()) throw std::runtime_error("a pointing_command of another version of vbar.lcm");
    world_->point(time, vector_of(pointing.value().boresight_rtn), vector_of(pointing.value().boresight_rate_rtn));
  }
}

}  // namespace vbar::external
