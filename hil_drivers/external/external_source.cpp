#include "hil_drivers/external/external_source.h"

#include <stdexcept>
#include <utility>

#include <fmt/format.h>

namespace vbar::external {
namespace {

/// A sensor whose packets leave it later than this after their epoch states another unit of time.
constexpr fsw::Duration kLongestDelay = fsw::duration_of_seconds(86400);

}  // namespace

void ExternalSource::start(fsw::GpsTime first_epoch) {
  program_ = connect_();
  Batch batch;
  batch.time = first_epoch;
  batch.opening = Opening{plan_.name, seed_, plan_.spacecraft, plan_.unit};
  const Answer answer = exchange(batch);
  if (answer.is_failed) throw std::runtime_error("the program refuses this sensor");
  if (!answer.packets.empty()) throw std::runtime_error("the program sent packets before the first epoch");
  if (!answer.next_epoch || *answer.next_epoch < first_epoch)
    throw std::runtime_error("the program states a first epoch before the start of the run, or none");
  next_epoch_ = answer.next_epoch;
}

void ExternalSource::stop(twins::StopReason /*reason*/) {
  if (program_) program_->close();
  program_.reset();
}

std::optional<fsw::GpsTime> ExternalSource::next_epoch(fsw::GpsTime from) const {
  return next_epoch_ && *next_epoch_ >= from ? next_epoch_ : std::nullopt;
}

twins::Measurement ExternalSource::measure(const twins::TruthSnapshot& truth) {
  try {
    Batch batch;
    batch.time = truth.time;
    batch.commands = std::exchange(commands_, {});
    batch.truth = truth;
    Answer answer = exchange(batch);
    check(answer, truth.time);
    next_epoch_ = answer.next_epoch;
    twins::Measurement measurement;
    measurement.available = answer.available;
    measurement.status = answer.is_failed ? twins::MeasurementStatus::kFailed : twins::MeasurementStatus::kReady;
    if (answer.is_failed) measurement.reason = "the program reports a failure";
    measurement.packets = std::move(answer.packets);
    return measurement;
  } catch (const std::exception& error) {
    throw std::runtime_error(fmt::format("source {}: {}", plan_.name, error.what()));
  }
}

void ExternalSource::command(const fsw::packets::PacketView& packet, fsw::GpsTime effective) {
  if (fsw::packets::is_telemetry(packet.header.apid)) return;
  Command command{twins::Packet(fsw::packets::kMaxPacketBytes), effective};
  const auto size = fsw::packets::write_packet(packet.header, packet.payload, command.packet);
  command.packet.resize(size.value());  // it was parsed from a packet
  commands_.push_back(std::move(command));
}

Answer ExternalSource::exchange(const Batch& batch) {
  const std::uint32_t step = step_++;
  return answer_of(program_->step(step, packets_of(batch, step, numbers_)).packets);
}

void ExternalSource::check(const Answer& answer, fsw::GpsTime now) const {
  if (answer.available < now || answer.available > now + kLongestDelay)
    throw std::runtime_error("its packets leave it before their epoch, or more than a day after it");
  if (answer.next_epoch && *answer.next_epoch <= now)
    throw std::runtime_error("its next epoch is not later than the present one");
  for (const twins::Packet& packet : answer.packets)
    if (const std::string fault = fault_of(packet, plan_.allowed, plan_.spacecraft, plan_.unit); !fault.empty())
      throw std::runtime_error("its answer holds " + fault);
}

}  // namespace vbar::external
