#include "hil_drivers/external/external_source.h"

#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "host_sim/twins/packet_source.h"

namespace vbar::external {
namespace {

/// A sensor whose packets leave it later than this after their epoch states another unit of time.
constexpr fsw::Duration kLongestDelay = fsw::duration_of_seconds(86400);

/// Tolerance for the time of a measurement, for a clock that is not exact.
constexpr fsw::Duration kClockMargin = fsw::duration_of_seconds(1);

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
  last_epoch_ = first_epoch;
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
    measurement.notes = reject(answer.packets, answer.available);
    last_epoch_ = truth.time;
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

std::string ExternalSource::fault_of_measurement(const fsw::packets::PacketView& packet, fsw::GpsTime available) const {
  const fsw::GpsTime time = packet.header.time, earliest = last_epoch_ - kClockMargin,
                     latest = available + kClockMargin;
  if (time < earliest || time > latest)
    return fmt::format(
        "a packet of GPS time {} ns; accepted: {} to {} ns, the last epoch to the time when the packets leave the "
        "sensor, "
        "and a second",
        time.ns, earliest.ns, latest.ns);
  return plan_.fault_of_value ? plan_.fault_of_value(packet) : std::string();
}

std::vector<twins::Note> ExternalSource::reject(std::vector<twins::Packet>& packets, fsw::GpsTime available) {
  std::string reason;
  double rejected = 0.0;
  std::size_t kept = 0;
  std::erase_if(packets, [&](const twins::Packet& bytes) {
    std::string fault = kept < plan_.packets_max
                            ? fault_of_measurement(fsw::packets::parse_packet(bytes).value(), available)
                            : fmt::format("more than {} packets of one epoch", plan_.packets_max);
    if (fault.empty()) {
      ++kept;
      return false;
    }
    rejected += 1.0;
    if (reason.empty()) reason = std::move(fault);
    return true;
  });
  if (rejected == 0.0) return {};
  packets_rejected_ += static_cast<std::uint64_t>(rejected);
  return {{std::string(twins::kPacketsRejected), rejected, reason}};
}

std::vector<twins::Note> ExternalSource::statistics() const {
  if (packets_rejected_ == 0) return {};
  return {{std::string(twins::kPacketsRejected), static_cast<double>(packets_rejected_)}};
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
