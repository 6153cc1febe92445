#include "boards/common/flight_executive.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <optional>

#include "fsw/packets/big_endian.h"
#include "fsw/packets/messages.h"

// Optional functions: an image whose flight software lacks them has null in their place.
extern "C" {
[[gnu::weak]] vbar_status vbar_gnc_authenticate(void* state, const uint8_t* key, uint16_t index, uint64_t sequence);
[[gnu::weak]] uint64_t vbar_gnc_telecommand_sequence(const void* state);
}

namespace vbar::boards {
namespace {

using fsw::link::BatchReceiver;
using fsw::link::FrameHeader;
using fsw::link::FrameType;
using fsw::link::FrameView;

/// Longest text in a kHelloAck, bytes.
constexpr std::size_t kMaxHelloText = 120;

constexpr const char* kOverBudget = "error: a step has exceeded its budget; its report states the cost";

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

/// Returns the time of the step that `packet` starts; a status if it is not a tick.
fsw::Result<fsw::GpsTime> tick_time(std::span<const std::uint8_t> packet) {
  const fsw::Result<fsw::packets::PacketView> view = fsw::packets::parse_packet(packet);
  if (!view.ok()) return view.status();
  const fsw::Result<vbar::tick> tick = fsw::packets::decode<vbar::tick>(view.value());
  if (!tick.ok()) return tick.status();
  return view.value().header.time;
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
      close_receiver();
      return Activity::kGoodbye;
    case FrameType::kReceiverPoll:
      on_receiver_poll();
      return Activity::kIdle;
    case FrameType::kSnapshotPoll:
      on_snapshot_poll(frame);
      return Activity::kIdle;
    case FrameType::kSnapshotPiece:
      on_snapshot_piece(frame);
      return Activity::kIdle;
    case FrameType::kHello:
    case FrameType::kHelloAck:
    case FrameType::kReceiverCount:
    case FrameType::kSnapshotHeld:
      break;  // the first was handled above, the others are never sent to a board
  }
  ++counters_.rejected;
  return Activity::kIdle;
}

void FlightExecutive::on_hello(const FrameView& frame) {
  if (!has_session_ || frame.header.session != session_) begin_session(frame.header.session, frame.payload);
  answer_hello();
}

void FlightExecutive::answer_hello() {
  FrameHeader header;
  header.type = FrameType::kHelloAck;
  header.session = session_;
  // One buffer, of which the text of a board or of an error takes at most kMaxHelloText bytes.
  constexpr std::size_t kSuffixBytes = sizeof(kAuthenticates) - 1;
  std::array<std::uint8_t, kMaxHelloText + kSuffixBytes> text{};
  const std::span<const std::uint8_t> name = bytes_of(hello_text_);
  std::copy(name.begin(), name.end(), text.begin());
  const bool has_suffix = can_fly_ && platform_.telecommand_security != nullptr;
  const std::span<const std::uint8_t> suffix = bytes_of(has_suffix ? kAuthenticates : "");
  std::copy(suffix.begin(), suffix.end(), text.begin() + static_cast<std::ptrdiff_t>(name.size()));
  send_frame(header, std::span(text).first(name.size() + suffix.size()));
}

void FlightExecutive::lose_session(std::uint32_t session, const char* error) {
  has_session_ = true;
  can_fly_ = false;
  session_ = session;
  hello_text_ = error;
}

void FlightExecutive::begin_session(std::uint32_t session, std::span<const std::uint8_t> hello_payload) {
  has_session_ = true;
  session_ = session;
  const std::optional<Hello> hello = Hello::parse(hello_payload);
  step_budget_ = budget_of(hello);
  if (platform_.session_begins != nullptr) platform_.session_begins(platform_.context, session_, step_budget_);
  counters_ = Counters{.received = 1};  // the hello itself
  has_answer_ = false;
  report_count_ = 0;
  step_time_ = fsw::GpsTime{};
  inputs_ = BatchReceiver{};
  snapshot_.clear();
  answer_ = fsw::link::BatchSender{};
  outbox_.clear();
  const char* const error = start(hello);
  can_fly_ = error == nullptr;
  hello_text_ = can_fly_ ? platform_.name : error;
}

std::optional<Hello> Hello::parse(std::span<const std::uint8_t> payload) {
  const bool has_budget = payload.size() == fsw::link::kHelloWithBudgetBytes;
  const bool has_receiver = payload.size() == fsw::link::kHelloWithReceiverBytes;
  if (!has_budget && !has_receiver && payload.size() != fsw::link::kHelloBytes) return std::nullopt;
  Hello hello;
  hello.spacecraft = payload[0];
  if (!has_budget && !has_receiver) return hello;
  const auto baud = fsw::packets::read_big_endian<std::uint32_t>(payload, fsw::link::kHelloBytes);
  // Beside a budget, a rate of 0 states that no receiver is wired to the board.
  if (baud != 0 || has_receiver) hello.receiver_baud = baud;
  if (has_budget)
    hello.step_budget = fsw::packets::read_big_endian<std::uint64_t>(payload, fsw::link::kHelloWithReceiverBytes);
  return hello;
}

std::uint64_t FlightExecutive::budget_of(const std::optional<Hello>& hello) const {
  if (platform_.counter == nullptr) return 0;
  return hello && hello->step_budget != 0 ? hello->step_budget : platform_.step_budget;
}

const char* FlightExecutive::start(const std::optional<Hello>& hello) {
  if (!hello) return "error: a hello carries the spacecraft number, a receiver's rate in baud and the budget of a step";
  const char* const error = start_flight_software(hello->spacecraft);
  return error == nullptr ? open_receiver(hello->receiver_baud) : error;
}

const char* FlightExecutive::start_flight_software(std::uint8_t spacecraft) {
  spacecraft_ = spacecraft;
  if (vbar_gnc_abi_version() != VBAR_GNC_ABI_VERSION) return "error: the flight software has another interface version";
  if (vbar_gnc_state_size() > gnc_state_.size())
    return "error: the flight software's state is larger than the board allows";
  if (!alignment_fits(vbar_gnc_state_alignment())) return "error: the flight software's state needs another alignment";
  if (has_state_ && platform_.telecommand_security != nullptr)
    telecommand_sequence_ = std::max(telecommand_sequence_, vbar_gnc_telecommand_sequence(gnc_state_.data()));
  has_state_ = false;
  // Padding included, the state is a function of what the flight software received.
  std::memset(gnc_state_.data(), 0, vbar_gnc_state_size());
  if (vbar_gnc_init(gnc_state_.data(), spacecraft_, &FlightExecutive::sink, this) != 0) {
    return "error: the flight software refused to start";
  }
  return require_authentication();
}

const char* FlightExecutive::require_authentication() {
  const fsw::packets::TelecommandSecurity* security = platform_.telecommand_security;
  if (security == nullptr) return nullptr;
  if (vbar_gnc_authenticate == nullptr || vbar_gnc_telecommand_sequence == nullptr)
    return "error: the board has a key of telecommands, and its flight software does not authenticate them";
  if (vbar_gnc_authenticate(gnc_state_.data(), security->key.data(), security->index, telecommand_sequence_) != 0)
    return "error: the flight software refused the key of telecommands";
  has_state_ = true;
  return nullptr;
}

const char* FlightExecutive::open_receiver(const std::optional<std::uint32_t>& baud) {
  close_receiver();
  if (!baud) return nullptr;
  const bool is_possible = *baud != 0 && platform_.open_receiver != nullptr && platform_.read_receiver != nullptr;
  if (!is_possible || !platform_.open_receiver(platform_.context, *baud))
    return "error: no line to a receiver at this rate, or the line is the link to the host";
  receiver_.open(spacecraft_);
  return nullptr;
}

void FlightExecutive::close_receiver() {
  receiver_.close();
  if (platform_.open_receiver != nullptr) static_cast<void>(platform_.open_receiver(platform_.context, 0));
}

void FlightExecutive::read_receiver() {
  if (!receiver_.is_open()) return;
  constexpr std::size_t kPiece = 256;
  constexpr std::size_t kMaxPieces =
      ReceiverPort::kRingBytes / kPiece;  // a line that never pauses does not stop a board
  std::array<std::uint8_t, kPiece> bytes{};
  for (std::size_t k = 0; k < kMaxPieces; ++k) {
    const std::size_t count = platform_.read_receiver(platform_.context, bytes);
    if (count == 0) return;
    receiver_.take(std::span(bytes).first(count));
  }
}

void FlightExecutive::on_receiver_poll() {
  if (!receiver_.is_open()) {
    ++counters_.rejected;
    return;
  }
  read_receiver();
  FrameHeader header;
  header.type = FrameType::kReceiverCount;
  header.session = session_;
  std::array<std::uint8_t, fsw::link::kReceiverCountBytes> count{};
  fsw::packets::write_big_endian(receiver_.received(), std::span<std::uint8_t>(count), 0);
  send_frame(header, count);
}

void FlightExecutive::on_snapshot_poll(const FrameView& frame) {
  const bool is_in_step = inputs_.is_open() && !has_answer_;
  if (!can_fly_ || is_in_step || frame.payload.size() != fsw::link::kSnapshotPollBytes) {
    ++counters_.rejected;
    if (!can_fly_) answer_hello();
    return;
  }
  const auto offset = fsw::packets::read_big_endian<std::uint32_t>(frame.payload, 0);
  std::array<std::uint8_t, fsw::link::kSnapshotPieceHeaderBytes + fsw::link::kSnapshotPieceBytes> payload{};
  const std::size_t size = snapshot_.read(gnc_state_.data(), offset, payload);
  FrameHeader header;
  header.type = FrameType::kSnapshotPiece;
  header.session = session_;
  send_frame(header, std::span(payload).first(size));
}

void FlightExecutive::on_snapshot_piece(const FrameView& frame) {
  std::array<std::uint8_t, fsw::link::kSnapshotHeldBytes> payload{};
  const bool is_before_steps = can_fly_ && !inputs_.is_open();
  if (!is_before_steps || !snapshot_.write(gnc_state_.data(), frame.payload, payload).ok()) {
    ++counters_.rejected;
    if (!can_fly_) answer_hello();
    return;
  }
  FrameHeader header;
  header.type = FrameType::kSnapshotHeld;
  header.session = session_;
  send_frame(header, payload);
}

void FlightExecutive::deliver_receiver_bytes(fsw::GpsTime step_time) {
  read_receiver();
  receiver_.begin_step();
  WiredPiece piece;
  for (std::size_t k = 0; k < ReceiverPort::kPacketsPerStep; ++k) {
    receiver_.next_piece(step_time, piece);
    // The flight software receives only bytes that the host receives as well: otherwise the run could not be replayed.
    // Bytes without room in the answer wait for the next step.
    if (piece.count == 0 || !outbox_.append(std::span(piece.mirror).first(piece.mirror_size))) return;
    static_cast<void>(vbar_gnc_receive(gnc_state_.data(), piece.input.data(), piece.input_size));
    receiver_.accept(piece);
  }
}

Activity FlightExecutive::on_data(const FrameView& frame) {
  const FrameHeader& header = frame.header;
  if (already_run(header.step)) {
    ++counters_.duplicated;  // the answer is on its way or will be polled for
    return Activity::kIdle;
  }
  if (!can_fly_) {
    ++counters_.rejected;
    answer_hello();  // with the reason
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
  if (inputs_.complete() && receiver_.is_open()) {
    if (const fsw::Result<fsw::GpsTime> time = tick_time(frame.payload); time.ok())
      deliver_receiver_bytes(time.value());
  }
  // The flight software counts the packets that it rejects; for the barrier they have arrived.
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
    answer_hello();
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
  snapshot_.clear();
  // The first step keeps the output of the flight software from its construction.
  if (has_answer_) outbox_.clear();
  has_answer_ = false;
  if (platform_.step_begins != nullptr) platform_.step_begins(platform_.context, step);
}

void FlightExecutive::close_step(std::span<const std::uint8_t> last_packet) {
  const fsw::Result<fsw::GpsTime> time = tick_time(last_packet);
  std::uint64_t cost = 0;
  if (time.ok()) {
    step_time_ = time.value();
    if (platform_.telecommand_security != nullptr && platform_.telecommands_accepted != nullptr)
      platform_.telecommands_accepted(platform_.context, vbar_gnc_telecommand_sequence(gnc_state_.data()));
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
  const bool within_budget = step_budget_ == 0 || cost <= step_budget_;
  if (!within_budget) {
    can_fly_ = false;
    hello_text_ = kOverBudget;
  }
  if (platform_.step_ends != nullptr) platform_.step_ends(platform_.context, within_budget);
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
