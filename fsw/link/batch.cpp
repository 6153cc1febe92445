#include "fsw/link/batch.h"

namespace vbar::fsw::link {

void BatchReceiver::open(std::uint32_t session, std::uint32_t step) {
  session_ = session;
  step_ = step;
  held_ = 0;
  open_ = true;
  complete_ = false;
}

BatchReceiver::Decision BatchReceiver::offer(const FrameHeader& frame) {
  if (!open_ || frame.session != session_ || frame.step != step_) return {Verdict::kForeign, false};
  if (frame.index < held_ || complete_) return {Verdict::kDuplicate, frame.acknowledge_now};
  // The last index is not used because its successor exceeds 16 bits.
  if (frame.index > held_ || held_ == UINT16_MAX) return {Verdict::kOutOfOrder, frame.acknowledge_now};
  ++held_;
  complete_ = frame.last;
  return {Verdict::kTaken, frame.acknowledge_now || held_ % (kWindow / 2) == 0};
}

FrameHeader BatchReceiver::acknowledgement() const {
  FrameHeader header;
  header.type = FrameType::kAck;
  header.session = session_;
  header.step = step_;
  header.index = held_;
  return header;
}

void BatchSender::open(std::uint32_t session, std::uint32_t step, std::uint16_t count) {
  session_ = session;
  step_ = step;
  count_ = count;
  next_ = 0;
  acknowledged_ = 0;
  furthest_ = 0;
}

FrameHeader BatchSender::next_header() const {
  FrameHeader header;
  header.type = FrameType::kData;
  header.session = session_;
  header.step = step_;
  header.index = next_;
  header.last = next_ + 1 == count_;
  return header;
}

void BatchSender::sent() {
  if (next_ < furthest_) ++resent_;
  ++next_;
  if (next_ > furthest_) furthest_ = next_;
}

void BatchSender::acknowledge(std::uint16_t held) {
  if (held <= acknowledged_ || held > furthest_) return;
  acknowledged_ = held;
  if (next_ < held) next_ = held;
}

void BatchSender::rewind(std::uint16_t held) {
  if (held < acknowledged_ || held > furthest_) return;
  acknowledged_ = held;
  next_ = held;
}

}  // namespace vbar::fsw::link
