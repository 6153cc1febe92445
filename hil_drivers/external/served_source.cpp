#include "hil_drivers/external/served_source.h"

#include <iterator>
#include <stdexcept>

#include "fsw/packets/packet.h"

namespace vbar::external {
namespace {

/// Only what the source would receive in the process of the run.
void remove_accelerations(twins::TruthSnapshot& truth) {
  for (twins::SpacecraftTruth& one : truth.spacecraft) {
    one.acceleration_eci.reset();
    one.angular_acceleration_body.reset();
  }
}

}  // namespace

ServedSource::~ServedSource() {
  if (!source_) return;
  try {
    source_->stop(twins::StopReason::kCompleted);
  } catch (...) {
    // The run is over; an error has no receiver.
  }
}

std::vector<twins::Packet> ServedSource::answer(const Batch& batch) {
  Answer answer;
  answer.available = batch.time;
  if (batch.opening) {
    start(batch);
    answer.next_epoch = source_->next_epoch(batch.time);
  } else {
    answer = measure(batch);
    answer.next_epoch = source_->next_epoch(batch.time + fsw::Duration{1});
  }
  return packets_of(std::move(answer), batch.time);
}

void ServedSource::start(const Batch& batch) {
  if (source_) throw std::runtime_error("a second start of the sensor");
  source_ = make_(*batch.opening);
  source_->start(batch.time);
}

Answer ServedSource::measure(const Batch& batch) {
  if (!source_ || !batch.truth) throw std::runtime_error("a batch before the start of the sensor, or without truth");
  for (const Command& command : batch.commands)
    if (const auto packet = fsw::packets::parse_packet(command.packet); packet.ok())
      source_->command(packet.value(), command.effective);
  twins::TruthSnapshot truth = *batch.truth;
  if (source_->truth_detail() == twins::TruthDetail::kStates) remove_accelerations(truth);
  twins::Measurement measurement = source_->measure(truth);
  if (measurement.pending.valid()) {
    twins::Completion completion = measurement.pending.get();
    std::ranges::move(completion.packets, std::back_inserter(measurement.packets));
    if (!completion.failure.empty()) measurement.status = twins::MeasurementStatus::kFailed;
  }
  Answer answer;
  answer.is_failed = measurement.status == twins::MeasurementStatus::kFailed;
  answer.available = answer.is_failed ? batch.time : measurement.available;
  if (!answer.is_failed) answer.packets = std::move(measurement.packets);
  return answer;
}

}  // namespace vbar::external
