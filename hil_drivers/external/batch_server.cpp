#include "hil_drivers/external/batch_server.h"

#include <limits>
#include <stdexcept>

#include <fmt/format.h>

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

}  // namespace vbar::external
