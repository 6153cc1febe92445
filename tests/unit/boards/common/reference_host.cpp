#include "tests/unit/boards/common/reference_host.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "fsw/packets/messages.h"

namespace vbar::testing {

using fsw::link::FrameHeader;
using fsw::link::FrameType;

namespace {

/// Bounds a failing test. A step on the worst line here takes some 60 rounds: 6 windows, each spoilt a few times, and
/// 3 rounds to notice.
constexpr int kMaxRounds = 500;
constexpr int kRoundsBeforePoll = 3;
constexpr std::size_t kWindow = 32;
constexpr std::size_t kPastFrames = 200;

}  // namespace

Bytes make_frame(const FrameHeader& header, const Bytes& payload) {
  Bytes frame(fsw::link::kMaxFrameBytes);
  frame.resize(fsw::link::write_frame(header, payload, frame).value());
  return frame;
}

Bytes tick_packet(std::int64_t step, std::int64_t time_ns) {
  vbar::tick tick{};
  tick.step = step;
  fsw::packets::PacketHeader header;
  header.time.ns = time_ns;
  Bytes packet(fsw::packets::kMaxPacketBytes);
  packet.resize(fsw::packets::encode(header, tick, packet).value());
  return packet;
}

void Line::send(const Bytes& frame) {
  if (happens(faults_.stale) && !past_.empty()) put(past_[random_() % past_.size()]);
  if (happens(faults_.noise_inserted)) {
    for (std::uint32_t i = random_() % 40; i > 0; --i) bytes_.push_back(static_cast<std::uint8_t>(random_()));
  }
  if (faults_.stale > 0) past_.push_back(frame);
  if (past_.size() > kPastFrames) past_.pop_front();
  if (happens(faults_.delayed)) {
    late_.push_back(frame);
    return;
  }
  if (!happens(faults_.lost)) put(frame);
  if (happens(faults_.duplicated)) put(frame);
}

void Line::put(const Bytes& frame) {
  Bytes code(fsw::link::kMaxCobsFrameBytes);
  code.resize(fsw::link::cobs_encode(frame, code).value());
  if (happens(faults_.bit_flipped)) code[random_() % code.size()] ^= static_cast<std::uint8_t>(1U << (random_() % 8));
  if (happens(faults_.byte_dropped)) code.erase(code.begin() + static_cast<std::ptrdiff_t>(random_() % code.size()));
  bytes_.insert(bytes_.end(), code.begin(), code.end());
}

std::vector<Bytes> Line::receive() {
  std::vector<Bytes> frames;
  for (const std::uint8_t byte : bytes_) {
    if (decoder_.push(byte)) frames.emplace_back(decoder_.frame().begin(), decoder_.frame().end());
  }
  bytes_.clear();
  for (const Bytes& frame : late_) put(frame);
  late_.clear();
  return frames;
}

std::uint32_t Line::take_rejected() {
  const std::uint32_t fresh = decoder_.rejected() - rejected_seen_;
  rejected_seen_ = decoder_.rejected();
  return fresh;
}

ReferenceHost::ReferenceHost(boards::FlightExecutive& board, Line& to_board, Line& from_board, std::uint32_t session)
    : board_(board), to_board_(to_board), from_board_(from_board), session_(session) {}

void ReferenceHost::send(FrameType type, std::uint32_t step, std::uint16_t index, const Bytes& payload, bool last) {
  FrameHeader header;
  header.type = type;
  header.session = session_;
  header.step = step;
  header.index = index;
  header.last = last;
  to_board_.send(make_frame(header, payload));
}

std::vector<Bytes> ReferenceHost::play_round() {
  for (const Bytes& frame : to_board_.receive()) board_.on_frame(frame);
  board_.count_rejected(to_board_.take_rejected());
  std::vector<Bytes> mine;
  for (Bytes& frame : from_board_.receive()) {
    const auto view = fsw::link::parse_frame(frame);
    if (view.ok() && view.value().header.session == session_) mine.push_back(std::move(frame));
  }
  return mine;
}

std::optional<std::string> ReferenceHost::hello(std::uint8_t spacecraft) {
  for (int round = 0; round < kMaxRounds; ++round) {
    send(FrameType::kHello, 0, 0, {spacecraft});
    for (const Bytes& frame : play_round()) {
      const auto view = fsw::link::parse_frame(frame);
      if (view.value().header.type != FrameType::kHelloAck) continue;
      return std::string(view.value().payload.begin(), view.value().payload.end());
    }
  }
  return std::nullopt;
}

std::optional<std::vector<Bytes>> ReferenceHost::step(std::uint32_t step, const std::vector<Bytes>& packets) {
  std::vector<Bytes> answer;
  std::size_t acknowledged = 0;
  std::size_t next = 0;
  int silent_rounds = 0;
  bool polled = false;
  for (int round = 0; round < kMaxRounds; ++round) {
    while (next < packets.size() && next < acknowledged + kWindow) {
      send(FrameType::kData, step, static_cast<std::uint16_t>(next), packets[next], next + 1 == packets.size());
      ++next;
    }
    ++silent_rounds;
    for (const Bytes& frame : play_round()) {
      const auto view = fsw::link::parse_frame(frame);
      const FrameHeader& header = view.value().header;
      if (header.step != step) continue;
      if (header.type == FrameType::kAck && header.index >= acknowledged && header.index <= next) {
        silent_rounds = 0;
        acknowledged = header.index;
        if (polled) next = acknowledged;  // what is not held by now was lost
        polled = false;
      }
      if (header.type != FrameType::kData || header.index != answer.size()) continue;
      silent_rounds = 0;
      answer.emplace_back(view.value().payload.begin(), view.value().payload.end());
      if (header.last) return answer;
      if (answer.size() % (kWindow / 2) == 0) {
        send(FrameType::kAck, step, static_cast<std::uint16_t>(answer.size()));
      }
    }
    if (silent_rounds < kRoundsBeforePoll) continue;
    send(FrameType::kPoll, step, static_cast<std::uint16_t>(answer.size()));
    ++polls_;
    polled = true;
    silent_rounds = 0;
  }
  return std::nullopt;
}

boards::Platform platform_on(Line& line) {
  boards::Platform platform;
  platform.context = &line;
  platform.name = "test board";
  platform.send = [](void* context, std::span<const std::uint8_t> frame) {
    static_cast<Line*>(context)->send(Bytes(frame.begin(), frame.end()));
  };
  return platform;
}

}  // namespace vbar::testing
