#include "pil_bridge/stream_transport.h"

namespace vbar::pil {

void StreamTransport::send(std::span<const std::uint8_t> frame) {
  // A zero before the very first frame terminates bytes that were on the line before this program opened it.
  const std::size_t lead = first_ ? 1 : 0;
  coded_[0] = 0;
  const auto size = fsw::link::cobs_encode(frame, std::span(coded_).subspan(lead));
  if (!size.ok()) throw LinkError("a frame of " + std::to_string(frame.size()) + " bytes is too long for the link");
  const auto coded = std::span(coded_).first(lead + size.value());
  channel_->write(coded, Clock::now() + kWritePatience);
  first_ = false;
  counters_.bytes_sent += coded.size();
}

std::span<const std::uint8_t> StreamTransport::receive(Clock::time_point deadline) {
  for (bool overdue = false;;) {
    while (!undecoded_.empty()) {
      const std::uint8_t byte = undecoded_.front();
      undecoded_ = undecoded_.subspan(1);
      if (decoder_.push(byte)) return decoder_.frame();
    }
    if (overdue) return {};  // a line that sends bytes without a frame does not extend the wait
    overdue = Clock::now() >= deadline;
    undecoded_ = channel_->read(deadline);
    counters_.bytes_received += undecoded_.size();
    if (undecoded_.empty()) return {};
  }
}

TransportCounters StreamTransport::counters() const {
  TransportCounters counters = counters_;
  counters.frames_rejected = decoder_.rejected();
  return counters;
}

}  // namespace vbar::pil
