#include "pil_bridge/step_barrier.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "fsw/packets/big_endian.h"

namespace vbar::pil {
namespace {

using fsw::link::BatchReceiver;
using fsw::link::FrameHeader;
using fsw::link::FrameType;
using fsw::link::FrameView;
using fsw::link::kWindow;

/// A board that cannot run its flight software sends the reason in place of its name.
constexpr std::string_view kBoardErrorPrefix = "error: ";

/// The text of a kHelloAck after that prefix; nothing if it is the name of a board.
std::optional<std::string> board_error(const FrameView& frame) {
  const std::string text(frame.payload.begin(), frame.payload.end());
  if (!text.starts_with(kBoardErrorPrefix)) return std::nullopt;
  return text.substr(kBoardErrorPrefix.size());
}

/// Checks an answer of a session that was opened: throws SessionLost if the board says that it has ended.
void check_session(const FrameView& frame) {
  if (frame.header.type != FrameType::kHelloAck) return;
  if (const auto error = board_error(frame)) throw SessionLost("the board has lost its session: " + *error);
}

std::string seconds_text(std::chrono::milliseconds duration) {
  const std::string text = std::to_string(static_cast<double>(duration.count()) * 1e-3);
  return text.substr(0, text.find('.') + 2) + " s";
}

/// Describes what a line gave instead of an answer: a wrong cable, address and rate differ in it.
std::string what_came(const TransportCounters& line, std::uint64_t other_frames) {
  if (line.foreign_datagrams > 0)
    return "; " + std::to_string(line.foreign_datagrams) + " datagrams came from another address";
  if (line.bytes_received == 0) return "; nothing came";
  if (other_frames > 0) return "; " + std::to_string(other_frames) + " frames came, none of them an answer to it";
  return "; " + std::to_string(line.bytes_received) +
         " bytes came that are no frame of the link: another rate, or a console";
}

}  // namespace

StepBarrier::StepBarrier(FrameTransport& transport, std::uint32_t session, const BarrierTiming& timing,
                         std::function<void()> watch)
    : transport_(transport), session_(session), timing_(timing), watch_(std::move(watch)) {}

std::string StepBarrier::connect(std::uint8_t spacecraft, std::uint32_t receiver_baud, std::uint64_t step_budget) {
  std::array<std::uint8_t, fsw::link::kHelloWithBudgetBytes> hello{spacecraft};
  fsw::packets::write_big_endian(receiver_baud, std::span<std::uint8_t>(hello), fsw::link::kHelloBytes);
  fsw::packets::write_big_endian(step_budget, std::span<std::uint8_t>(hello), fsw::link::kHelloWithReceiverBytes);
  const auto payload = std::span(hello).first(step_budget != 0     ? fsw::link::kHelloWithBudgetBytes
                                              : receiver_baud != 0 ? fsw::link::kHelloWithReceiverBytes
                                                                   : fsw::link::kHelloBytes);
  std::uint64_t other_frames = 0;
  const auto give_up = Clock::now() + timing_.boot_limit;
  while (Clock::now() < give_up) {
    send({.type = FrameType::kHello, .session = session_}, payload);
    const auto next_hello = std::min(give_up, Clock::now() + timing_.hello_period);
    while (const auto frame = receive(next_hello)) {
      if (frame->header.type != FrameType::kHelloAck) {
        ++counters_.frames_rejected;
        ++other_frames;
        continue;
      }
      if (const auto error = board_error(*frame))
        throw LinkError("the board cannot run its flight software: " + *error);
      return {frame->payload.begin(), frame->payload.end()};
    }
    watch_();
  }
  throw LinkError("no answer to hello within " + seconds_text(timing_.boot_limit) + " on " + transport_.description() +
                  what_came(transport_.counters(), other_frames));
}

std::optional<std::uint64_t> StepBarrier::receiver_count(Clock::time_point deadline) {
  send({.type = FrameType::kReceiverPoll, .session = session_});
  while (const auto frame = receive(deadline)) {
    if (frame->header.type == FrameType::kReceiverCount && frame->payload.size() == fsw::link::kReceiverCountBytes)
      return fsw::packets::read_big_endian<std::uint64_t>(frame->payload, 0);
    check_session(*frame);
    ++counters_.frames_duplicated;  // frame of a step that has been answered
  }
  watch_();
  return std::nullopt;
}

std::vector<Packet> StepBarrier::exchange(std::uint32_t step, std::span<const Packet> packets) {
  if (packets.empty() || packets.size() > std::numeric_limits<std::uint16_t>::max()) {
    throw LinkError("a step takes 1 to 65535 packets, not " + std::to_string(packets.size()));
  }
  Exchange exchange;
  exchange.step = step;
  exchange.packets = packets;
  inputs_.open(session_, step, static_cast<std::uint16_t>(packets.size()));
  outputs_.open(session_, step);
  auto last_progress = Clock::now();
  auto patience = timing_.poll_after;
  auto next_poll = last_progress + patience;
  send_window(exchange);
  while (!outputs_.complete()) {
    if (const auto frame = receive(next_poll)) {
      if (!take(exchange, *frame)) continue;
      last_progress = Clock::now();
      patience = timing_.poll_after;
    } else {
      watch_();
      if (Clock::now() - last_progress >= timing_.give_up_after) {
        throw LinkError("no answer to step " + std::to_string(step) + " within " + seconds_text(timing_.give_up_after) +
                        " on " + transport_.description());
      }
      poll(exchange);
      patience = std::min(2 * patience, timing_.poll_limit);
    }
    next_poll = std::min(Clock::now() + patience, last_progress + timing_.give_up_after);
  }
  return std::move(exchange.answer);
}

std::vector<std::uint8_t> StepBarrier::read_snapshot() {
  std::vector<std::uint8_t> snapshot;
  for (bool is_complete = false; !is_complete;) {
    std::array<std::uint8_t, fsw::link::kSnapshotPollBytes> poll{};
    fsw::packets::write_big_endian(static_cast<std::uint32_t>(snapshot.size()), std::span<std::uint8_t>(poll), 0);
    ask(FrameType::kSnapshotPoll, poll, FrameType::kSnapshotPiece, [&](std::span<const std::uint8_t> piece) {
      if (piece.size() < fsw::link::kSnapshotPieceHeaderBytes) return false;
      const auto total = fsw::packets::read_big_endian<std::uint32_t>(piece, 0);
      const auto content = piece.subspan(fsw::link::kSnapshotPieceHeaderBytes);
      const bool is_next = fsw::packets::read_big_endian<std::uint32_t>(piece, 4) == snapshot.size();
      const bool fits = total >= snapshot.size() && content.size() <= total - snapshot.size();
      if (!is_next || !fits || (content.empty() && total != 0)) return false;
      snapshot.insert(snapshot.end(), content.begin(), content.end());
      is_complete = snapshot.size() == total;
      return true;
    });
  }
  return snapshot;
}

std::int32_t StepBarrier::write_snapshot(std::span<const std::uint8_t> snapshot) {
  const auto total = static_cast<std::uint32_t>(snapshot.size());
  std::int32_t status = 0;
  for (std::uint32_t held = 0; held < total && status == 0;) {
    const std::size_t count = std::min<std::size_t>(total - held, fsw::link::kSnapshotPieceBytes);
    std::vector<std::uint8_t> piece(fsw::link::kSnapshotPieceHeaderBytes);
    fsw::packets::write_big_endian(total, std::span<std::uint8_t>(piece), 0);
    fsw::packets::write_big_endian(held, std::span<std::uint8_t>(piece), 4);
    const auto content = snapshot.subspan(held, count);
    piece.insert(piece.end(), content.begin(), content.end());
    ask(FrameType::kSnapshotPiece, piece, FrameType::kSnapshotHeld, [&](std::span<const std::uint8_t> answer) {
      if (answer.size() != fsw::link::kSnapshotHeldBytes) return false;
      status = static_cast<std::int32_t>(fsw::packets::read_big_endian<std::uint32_t>(answer, 4));
      const bool is_held = fsw::packets::read_big_endian<std::uint32_t>(answer, 0) == held + count;
      return is_held || status != 0;
    });
    held += static_cast<std::uint32_t>(count);
  }
  return status;
}

void StepBarrier::ask(FrameType question, std::span<const std::uint8_t> payload, FrameType answer,
                      const std::function<bool(std::span<const std::uint8_t>)>& accepts) {
  const auto give_up = Clock::now() + timing_.give_up_after;
  while (Clock::now() < give_up) {
    send({.type = question, .session = session_}, payload);
    const auto next_question = std::min(give_up, Clock::now() + timing_.poll_after);
    while (const auto frame = receive(next_question)) {
      check_session(*frame);
      if (frame->header.type == answer && accepts(frame->payload)) return;
      ++counters_.frames_duplicated;  // frame of a step, or of a question, that has been answered
    }
    watch_();
  }
  throw LinkError("no answer about the snapshot within " + seconds_text(timing_.give_up_after) + " on " +
                  transport_.description());
}

void StepBarrier::goodbye() {
  send({.type = FrameType::kGoodbye, .session = session_});
}

BarrierCounters StepBarrier::counters() const {
  BarrierCounters counters = counters_;
  counters.frames_resent = inputs_.resent();
  return counters;
}

void StepBarrier::send_window(Exchange& exchange) {
  while (inputs_.can_send()) {
    const FrameHeader header = inputs_.next_header();
    send(header, exchange.packets[header.index]);
    inputs_.sent();
    last_sent_ = Clock::now();
    exchange.sent = static_cast<std::uint16_t>(header.index + 1U);
  }
}

void StepBarrier::poll(Exchange& exchange) {
  ++counters_.polls;
  exchange.poll_pending = true;
  exchange.sent_before_poll = exchange.sent;
  send({.type = FrameType::kPoll, .session = session_, .step = exchange.step, .index = outputs_.held()});
}

bool StepBarrier::take(Exchange& exchange, const FrameView& frame) {
  check_session(frame);
  // The board received more than one hello, or more than one question for its count.
  if (frame.header.type == FrameType::kHelloAck || frame.header.type == FrameType::kReceiverCount) {
    ++counters_.frames_duplicated;
    return false;
  }
  if (frame.header.step != exchange.step) {
    // A late repetition of an earlier answer, or an invalid step.
    ++(frame.header.step < exchange.step ? counters_.frames_duplicated : counters_.frames_rejected);
    return false;
  }
  if (frame.header.type == FrameType::kAck) return take_acknowledgement(exchange, frame.header.index);
  if (frame.header.type == FrameType::kData) return take_answer(exchange, frame);
  ++counters_.frames_rejected;  // only a host sends the others
  return false;
}

bool StepBarrier::take_acknowledgement(Exchange& exchange, std::uint16_t held) {
  if (held > exchange.packets.size()) {
    ++counters_.frames_rejected;
    return false;
  }
  const bool progress = held > exchange.acknowledged;
  exchange.acknowledged = std::max(exchange.acknowledged, held);
  // The answer to a poll states how much was received of the frames sent before the poll: the others were lost. An
  // unsolicited acknowledgement, every half window, may have been under way and does not imply this.
  const bool on_own_account = progress && held % (kWindow / 2) == 0;
  const bool answers_poll = exchange.poll_pending && !on_own_account;
  if (answers_poll) exchange.poll_pending = false;
  if (answers_poll && held < exchange.sent_before_poll) {
    inputs_.rewind(held);
  } else {
    inputs_.acknowledge(held);
  }
  send_window(exchange);
  return progress;
}

bool StepBarrier::take_answer(Exchange& exchange, const FrameView& frame) {
  const BatchReceiver::Decision decision = outputs_.offer(frame.header);
  switch (decision.verdict) {
    case BatchReceiver::Verdict::kTaken:
      if (exchange.answer.empty()) first_answer_ = Clock::now();
      exchange.answer.emplace_back(frame.payload.begin(), frame.payload.end());
      exchange.gap_reported = false;
      break;
    case BatchReceiver::Verdict::kDuplicate:
      ++counters_.frames_duplicated;
      break;
    case BatchReceiver::Verdict::kOutOfOrder:
      ++counters_.frames_rejected;
      // The frames before were lost: poll at once, but only once, because more of the same burst is still on its way.
      if (!std::exchange(exchange.gap_reported, true)) poll(exchange);
      break;
    case BatchReceiver::Verdict::kForeign:
      ++counters_.frames_rejected;
      break;
  }
  if (decision.acknowledge && !outputs_.complete()) send(outputs_.acknowledgement());
  return decision.verdict == BatchReceiver::Verdict::kTaken;
}

void StepBarrier::send(const FrameHeader& header, std::span<const std::uint8_t> payload) {
  const auto size = fsw::link::write_frame(header, payload, frame_);
  if (!size.ok()) throw LinkError("a packet of " + std::to_string(payload.size()) + " bytes does not fit a link frame");
  transport_.send(std::span(frame_).first(size.value()));
}

std::optional<FrameView> StepBarrier::receive(Clock::time_point deadline) {
  for (;;) {
    const auto bytes = transport_.receive(deadline);
    if (bytes.empty()) return std::nullopt;
    const auto frame = fsw::link::parse_frame(bytes);
    if (frame.ok() && frame.value().header.session == session_) return frame.value();
    ++counters_.frames_rejected;
    if (Clock::now() >= deadline) return std::nullopt;
  }
}

}  // namespace vbar::pil
