// The board's side of the step barrier on arbitrary frames. The input is a script: a frame a command, with a right CRC
// (a fuzzer does not guess one), or raw bytes. Promises: the board says only well-formed frames of the session it was
// greeted with, and it steps at most once for each batch that was ended.
//
//   byte 0  bits 0-2: frame type (0: raw bytes), bit 3: last, bit 4: acknowledge now, bit 5: another session, bit 6: a
//   tick, bit 7: the payload comes on the line of a wired receiver instead
//   byte 1  step     byte 2  index     byte 3  payload length     then the payload

#include <algorithm>
#include <array>
#include <memory>
#include <new>
#include <span>

#include "boards/common/flight_executive.h"
#include "fsw/packets/messages.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/unit/boards/common/fake_gnc.h"

namespace {

namespace link = vbar::fsw::link;
namespace packets = vbar::fsw::packets;
using vbar::boards::FlightExecutive;

constexpr std::size_t kCommandBytes = 4;

struct Watch {
  std::uint32_t session = 0;
  int batches_ended = 0;
  std::span<const std::uint8_t> line;  ///< what the receiver has sent and the board has not read
};

bool open_receiver(void* context, std::uint32_t baud) {
  static_cast<Watch*>(context)->line = {};
  return baud != 1;  // a rate that the line does not have
}

std::size_t read_receiver(void* context, std::span<std::uint8_t> out) {
  auto& line = static_cast<Watch*>(context)->line;
  const std::size_t count = std::min(out.size(), line.size());
  std::copy_n(line.begin(), count, out.begin());
  line = line.subspan(count);
  return count;
}

void check_sent(void* context, std::span<const std::uint8_t> bytes) {
  const auto* const watch = static_cast<const Watch*>(context);
  const auto frame = link::parse_frame(bytes);
  VBAR_FUZZ_EXPECT(frame.ok());
  VBAR_FUZZ_EXPECT(frame.value().header.session == watch->session);
}

std::size_t tick_payload(std::uint8_t step, std::span<std::uint8_t> out) {
  packets::PacketHeader header;
  header.time.ns = step;
  vbar::tick tick{};
  tick.step = step;
  return packets::encode(header, tick, out).value();
}

void play(FlightExecutive& board, Watch& watch, std::span<const std::uint8_t> command,
          std::span<const std::uint8_t> payload) {
  const std::uint8_t type = command[0] & 7U;
  if ((command[0] & 128U) != 0) {
    watch.line = payload;
    board.read_receiver();
    return;
  }
  if (type == 0) {
    board.on_frame(payload);
    return;
  }
  link::FrameHeader header;
  header.type = static_cast<link::FrameType>(type);
  header.last = (command[0] & 8U) != 0;
  header.acknowledge_now = (command[0] & 16U) != 0;
  header.session = (command[0] & 32U) != 0 ? 2 : 1;
  header.step = command[1];
  header.index = command[2];
  std::array<std::uint8_t, packets::kMaxPacketBytes> tick{};
  if ((command[0] & 64U) != 0) payload = std::span(tick).first(tick_payload(command[1], tick));
  std::array<std::uint8_t, link::kMaxFrameBytes> frame{};
  const auto size = link::write_frame(header, payload, frame);
  VBAR_FUZZ_EXPECT(size.ok());
  if (header.type == link::FrameType::kHello) watch.session = header.session;
  watch.batches_ended += header.type == link::FrameType::kData && header.last ? 1 : 0;
  board.on_frame(std::span(frame).first(size.value()));
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  // Too large to allocate again for every input; its constructor leaves the large arrays alone.
  alignas(FlightExecutive) static std::array<std::byte, sizeof(FlightExecutive)> memory;
  vbar::testing::reset_fake_gnc();
  Watch watch;
  vbar::boards::Platform platform;
  platform.context = &watch;
  platform.send = check_sent;
  platform.open_receiver = open_receiver;
  platform.read_receiver = read_receiver;
  auto* const board = new (memory.data()) FlightExecutive(platform);
  std::span<const std::uint8_t> rest(data, size);
  while (rest.size() >= kCommandBytes) {
    const auto command = rest.first(kCommandBytes);
    rest = rest.subspan(kCommandBytes);
    const auto payload = rest.first(std::min<std::size_t>(command[3], rest.size()));
    rest = rest.subspan(payload.size());
    play(*board, watch, command, payload);
  }
  VBAR_FUZZ_EXPECT(vbar::testing::fake_gnc_steps() <= watch.batches_ended);
  std::destroy_at(board);
  return 0;
}
