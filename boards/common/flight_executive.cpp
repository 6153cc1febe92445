#include "boards/common/flight_executive.h"

#include <algorithm>
#include <cstring>
#include <limits>

#include "fsw/packets/messages.h"

namespace vbar::boards {
namespace {

using fsw::link::BatchReceiver;
using fsw::link::FrameHeader;
using fsw::link::FrameType;
using fsw::link::FrameView;

/// Longest text in a kHelloAck, bytes.
constexpr std::size_t kMaxHelloText = 120;

template <class Integer>
constexpr Integer saturated(std::uint64_t value) {
  constexpr auto kMax = static_cast<std::uint64_t>(std::numeric_limits<Integer>::max());
  return static_cast<Integer>(std::min(value, kMax));
}

std::span<const std::uint8_t> bytes_of(const char* text) {
  std::size_t length = 0;
  while (length < kMaxHelloText && text[length] != '\0') ++length;
  return {reinterpret_cast<const std::uint8_t*>(text), length};  // NOLINT: ASCII on the wire
}

bool alignment_fits(std::size_t alignment) {
  return alignment != 0 && kGncStateAlignment % alignment == 0;
}

}  // namespace

Activity FlightExecutive::on_frame(std::span<const std::uint8_t> bytes) {
  ++counters_.received;
  const fsw::Result<FrameView> parsed = fsw::link::parse_frame(bytes);
  if (!parsed.ok()) {
    ++counters_.rejected;
    return Activity::kIdle;
  }
  const FrameView& frame = parsed.value();
  if (frame.header.type == FrameType::kHello) {
    on_hello(frame);
    return Activity::kIdle;
  }
  if (!has_session_ || frame.header.session != session_) {
    ++counters_.rejected;
    return Activity::kIdle;
  }
  switch (frame.header.type) {
    case FrameType::kData:
      return on_data(frame);
    case FrameType::kPoll:
      on_poll(frame.header);
      return Activity::kIdle;
    case FrameType::kAck:
      if (has_answer_ && frame.header.step == answer_.step()) {
        answer_.acknowledge(frame.header.index);
        send_answer();
      }
      return Activity::kIdle;
    case FrameType::kGoodbye:
      return Activity::kGoodbye;
    case FrameType::kHello:
    case FrameType::kHelloAck:
      break;  // the first was handled above, the second is never sent to a board
  }
  ++counters_.rejected;
  return Activity::kIdle;
}

void FlightExecutive::on_hello(const FrameView& frame) {
  if (!has_session_ || frame.header.session != session_) begin_session(frame.header.session, frame.payload);
  FrameHeader header;
  header.type = FrameType::kHelloAck;
  header.session = session_;
  send_frame(header, bytes_of(hello_text_));
}

void FlightExecutive::begin_session(std::uint32_t session, std::span<const std::uint8_t> hello_payload) {
  has_session_ = true;
  session_ = session;
  counters_ = Counters{.received = 1};  // the hello itself
  has_answer_ = false;
  report_count_ = 0;
  step_time_ = fsw::GpsTime{};
  inputs_ = BatchReceiver{};
  answer_ = fsw::link::BatchSender{};
  outbox_.clear();
  const char* const error = start_flight_software(hello_payload);
  can_fly_ = error == nullptr;
  hello_text_ = can_fly_ ? platform_.name : error;
}

const char* FlightExecutive::start_flight_software(std::span<const std::uint8_t> hello_payload) {
  if (hello_payload.size() != 1) return "error: a hello carries one byte, the spacecraft number";
  spacecraft_ = hello_payload[0];
  if (vbar_gnc_abi_version() != VBAR_GNC_ABI_VERSION) return "error: the flight software has another interface version";
  if (vbar_gnc_state_size() > gnc_state_.size())
    return "error: the flight software's state is larger than the board allows";
  if (!alignment_fits(vbar_gnc_state_alignment())) return "error: the flight software's state needs another alignment";
  // Padding included, the state is a function of what the flight software received.
  std::memset(gnc_state_.data(), 0, vbar_gnc_state_size());
  if (vbar_gnc_init(gnc_state_.data(), spacecraft_, &FlightExecutive::sink, this) != 0) {
    return "error: the flight software refused to start";
  }
  return nullptr;
}

Activity FlightExecutive::on_data(const FrameView& frame) {
  const FrameHeader& header = frame.header;
  if (!can_fly_) {
    ++counters_.rejected;
    return Activity::kIdle;
  }
  if (already_run(header.step)) {
    ++counters_.duplicated;  // the answer is on its way or will be polled for
    return Activity::kIdle;
  }
  if (!inputs_.is_open() || has_answer_) begin_step(header.step);
  const BatchReceiver::Decision decision = inputs_.offer(header);
  if (decision.acknowledge) send_frame(inputs_.acknowledgement(), {});
  switch (decision.verdict) {
    case BatchReceiver::Verdict::kTaken:
      break;
    case BatchReceiver::Verdict::kDuplicate:
      ++counters_.duplicated;
      return Activity::kIdle;
    case BatchReceiver::Verdict::kOutOfOrder:
    case BatchReceiver::Verdict::kForeign:
      ++counters_.rejected;
      return Activity::kIdle;
  }
  // A packet that the flight software refuses is in its own counters; for the barrier it has arrived.
  static_cast<void>(vbar_gnc_receive(gnc_state_.data(), frame.payload.data(), frame.payload.size()));
  if (!inputs_.complete()) return Activity::kIdle;
  close_step(frame.payload);
  send_answer();
  return Activity::kStepped;
}

bool FlightExecutive::already_run(std::uint32_t step) const {
  return inputs_.is_open() && (step < inputs_.step() || (has_answer_ && step == inputs_.step()));
}

void FlightExecutive::on_poll(const FrameHeader& header) {
  if (has_answer_ && header.step == answer_.step()) {
    answer_.rewind(header.index);
    send_answer();
    return;
  }
  if (already_run(header.step)) {
    ++counters_.duplicated;
    return;
  }
  if (!can_fly_) {
    ++counters_.rejected;
    return;
  }
  const bool is_open_step = inputs_.is_open() && !has_answer_ && header.step == inputs_.step();
  FrameHeader acknowledgement;
  acknowledgement.type = FrameType::kAck;
  acknowledgement.session = session_;
  acknowledgement.step = header.step;
  acknowledgement.index = is_open_step ? inputs_.held() : std::uint16_t{0};
  send_frame(acknowledgement, {});
}

void FlightExecutive::begin_step(std::uint32_t step) {
  inputs_.open(session_, step);
  // The first step keeps the output of the flight software from its construction.
  if (has_answer_) outbox_.clear();
  has_answer_ = false;
}

void FlightExecutive::close_step(std::span<const std::uint8_t> last_packet) {
  const fsw::Result<fsw::packets::PacketView> packet = fsw::packets::parse_packet(last_packet);
  const bool ends_in_tick = packet.ok() && fsw::packets::decode<vbar::tick>(packet.value()).ok();
  std::uint64_t cost = 0;
  if (ends_in_tick) {
    step_time_ = packet.value().header.time;
    const std::uint64_t before = read_counter();
    // A failed step is reported in the flight software's telemetry; the barrier closes in either case.
    static_cast<void>(vbar_gnc_step(gnc_state_.data(), step_time_.ns));
    cost = read_counter() - before;
  } else {
    ++counters_.ticks_missing;
  }
  append_step_report(cost);
  answer_.open(session_, inputs_.step(), outbox_.count());
  has_answer_ = true;
}

void FlightExecutive::append_step_report(std::uint64_t cost) {
  const std::uint32_t stack_bytes =
      platform_.stack_high_water == nullptr ? 0 : platform_.stack_high_water(platform_.context);
  vbar::step_report report{};
  report.step = inputs_.step();
  report.unit = static_cast<std::int8_t>(platform_.counter == nullptr ? CounterUnit::kNone : platform_.counter_unit);
  report.count = saturated<std::int64_t>(cost);
  report.stack_bytes = saturated<std::int32_t>(stack_bytes);
  report.frames_received = saturated<std::int32_t>(counters_.received);
  report.frames_rejected = saturated<std::int32_t>(counters_.rejected);
  report.frames_duplicated = saturated<std::int32_t>(counters_.duplicated);
  report.frames_resent = saturated<std::int32_t>(answer_.resent());
  report.packets_dropped = saturated<std::int32_t>(counters_.packets_dropped);
  report.ticks_missing = saturated<std::int32_t>(counters_.ticks_missing);

  fsw::packets::PacketHeader header;
  header.sequence_count = report_count_++;
  header.time = step_time_;
  header.spacecraft = spacecraft_;
  std::array<std::uint8_t, fsw::packets::kMaxPacketBytes> packet{};
  // Cannot fail: a report is finite and smaller than a packet may be.
  const fsw::Result<std::size_t> size = fsw::packets::encode(header, report, packet);
  outbox_.append_report(std::span(packet).first(size.value()));
}

void FlightExecutive::send_answer() {
  while (answer_.can_send()) {  // at most kWindow times
    const FrameHeader header = answer_.next_header();
    send_frame(header, outbox_.packet(header.index));
    answer_.sent();
  }
}

void FlightExecutive::send_frame(const FrameHeader& header, std::span<const std::uint8_t> payload) const {
  std::array<std::uint8_t, fsw::link::kMaxFrameBytes> frame{};
  const fsw::Result<std::size_t> size = fsw::link::write_frame(header, payload, frame);
  if (size.ok()) platform_.send(platform_.context, std::span(frame).first(size.value()));
}

std::uint64_t FlightExecutive::read_counter() const {
  return platform_.counter == nullptr ? 0 : platform_.counter(platform_.context);
}

void FlightExecutive::sink(void* context, const std::uint8_t* packet, std::size_t size) {
  auto* const executive = static_cast<FlightExecutive*>(context);
  if (!executive->outbox_.append({packet, size})) ++executive->counters_.packets_dropped;
}

}  // namespace vbar::boards
