#include "hil_drivers/external/source_server.h"

#include <iterator>
#include <limits>
#include <stdexcept>

#include <fmt/format.h>

#include "fsw/packets/messages.h"
#include "fsw/packets/packet.h"

namespace vbar::external {

using fsw::link::BatchReceiver;
using fsw::link::FrameHeader;
using fsw::link::FrameType;
using fsw::link::FrameView;

void BatchServer::run(std::chrono::milliseconds patience) {
  for (;;) {
    const auto frame = transport_.receive(pil::Clock::now() + patience);
    if (frame.empty())
      throw pil::LinkError(
          fmt::format("the run has sent nothing for {} s", std::chrono::duration<double>(patience).count()));
    if (!take(frame)) return;
  }
}

bool BatchServer::take(std::span<const std::uint8_t> bytes) {
  const auto parsed = fsw::link::parse_frame(bytes);
  if (!parsed.ok()) return true;  // the host repeats what it needs
  const FrameView& frame = parsed.value();
  const FrameHeader& header = frame.header;
  if (header.type == FrameType::kHello && !session_) session_ = header.session;
  if (header.session != session_) return true;
  switch (header.type) {
    case FrameType::kHello:
      on_hello(frame);
      break;
    case FrameType::kData:
      on_data(frame);
      break;
    case FrameType::kPoll:
      on_poll(header);
      break;
    case FrameType::kAck:
      if (has_answer_ && header.step == outputs_.step()) {
        outputs_.acknowledge(header.index);
        send_answer();
      }
      break;
    case FrameType::kGoodbye:
      return false;
    default:
      break;  // frames of a flight computer, or of the host's side
  }
  return true;
}

void BatchServer::on_hello(const FrameView& frame) {
  FrameHeader header;
  header.type = FrameType::kHelloAck;
  header.session = frame.header.session;
  send(header, {reinterpret_cast<const std::uint8_t*>(name_.data()), name_.size()});  // NOLINT: ASCII on the wire
}

void BatchServer::on_data(const FrameView& frame) {
  const FrameHeader& header = frame.header;
  if (inputs_.is_open() && (header.step < inputs_.step() || (has_answer_ && header.step == inputs_.step()))) return;
  if (!inputs_.is_open() || has_answer_) {
    inputs_.open(*session_, header.step);
    batch_.clear();
    has_answer_ = false;
  }
  const BatchReceiver::Decision decision = inputs_.offer(header);
  if (decision.acknowledge) send(inputs_.acknowledgement());
  if (decision.verdict != BatchReceiver::Verdict::kTaken) return;
  batch_.emplace_back(frame.payload.begin(), frame.payload.end());
  if (!inputs_.complete()) return;
  answer_ = serve_(batch_);
  if (answer_.empty() || answer_.size() > std::numeric_limits<std::uint16_t>::max())
    throw std::length_error(fmt::format("an answer of {} packets", answer_.size()));
  outputs_.open(*session_, header.step, static_cast<std::uint16_t>(answer_.size()));
  has_answer_ = true;
  send_answer();
}

void BatchServer::on_poll(const FrameHeader& header) {
  if (has_answer_ && header.step == outputs_.step()) {
    outputs_.rewind(header.index);
    send_answer();
    return;
  }
  FrameHeader acknowledgement;
  acknowledgement.type = FrameType::kAck;
  acknowledgement.session = *session_;
  acknowledgement.step = header.step;
  acknowledgement.index = inputs_.is_open() && header.step == inputs_.step() ? inputs_.held() : std::uint16_t{0};
  send(acknowledgement);
}

void BatchServer::send_answer() {
  while (outputs_.can_send()) {
    const FrameHeader header = outputs_.next_header();
    send(header, answer_[header.index]);
    outputs_.sent();
  }
}

void BatchServer::send(const FrameHeader& header, std::span<const std::uint8_t> payload) {
  const auto size = fsw::link::write_frame(header, payload, frame_);
  if (!size.ok()) throw std::length_error(fmt::format("a packet of {} bytes", payload.size()));
  transport_.send(std::span(frame_).first(size.value()));
}

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
