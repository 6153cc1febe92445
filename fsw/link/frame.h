#pragma once
// Link frames between a host and a flight computer. They carry space packets through a step barrier: the packets of
// step N are sent as one numbered batch, the answer to step N is returned as one numbered batch, and frames lost,
// corrupted, duplicated or delayed on the way are retransmitted, so that link errors do not affect the experiment.
//
//   byte  0      protocol version (kProtocolVersion)
//   byte  1      FrameType
//   bytes 2-5    session, a number the host draws at each start: frames of an older run are rejected
//   bytes 6-9    step
//   bytes 10-11  index: kData, position of this packet in its batch; kAck and kPoll, packets received without a gap
//   byte  12     flags: bit 0, last packet of the batch; bit 1, answer with kAck at once
//   byte  13     0
//   14 ...       kData: one space packet; kHello: the spacecraft's number (1 byte); then, if the board has its
//                GNSS receiver on a line of its own or a budget follows, the rate of that line in baud (4 bytes, 0:
//                no such line); then the budget of a step (8 bytes), in the unit in which the board counts the cost of
//                a step, if it is not the board's own; kHelloAck: the board's name in ASCII, or "error: " and why it
//                does not fly this session; kReceiverCount: the bytes that this line has brought since the hello (8
//                bytes)
//   last 4       CRC-32 (IEEE 802.3, little-endian) over everything before it
//
// All but the CRC big-endian. Over a byte stream a frame is COBS-coded and ends with a zero byte; over UDP one frame is
// one datagram.
//
// The exchange (go-back-N, window kWindow, both ways):
//   host  kHello (repeated until answered)         board  resets the flight software, kHelloAck
//   host  kData 0..n-1 of step N, the last one flagged; after kWindow unacknowledged ones it waits for kAck
//   board accepts kData only in order (others are counted and dropped; kAck every kWindow/2 or on demand);
//         once the flagged one is in: runs the step, keeps its answer, sends it as kData 0..m-1 of step N, last flagged
//   host  acknowledges the answer the same way; after a time without reception: kPoll(N, packets received).
//   board on kPoll: if its inputs of N are incomplete, kAck with their number; else its answer again from that index
//         on. kData of a step already run is a duplicate: the answer is on its way or will be polled for
//   host  before a step, kReceiverPoll: the board answers kReceiverCount at once. In lock-step the host begins the step
//         when the board has all that the receiver has sent.
//   board that no longer flies the session, after a reset or a step beyond its budget: answers kData, and kPoll of a
//        step that it has not run, with the kHelloAck that states the reason
//   host  between two steps, kSnapshotPoll (offset in bytes): the board saves its flight software, once until the next
//         step, and answers kSnapshotPiece (size of the snapshot, offset, bytes from there on; size 0: there is none)
//   host  before the first step, kSnapshotPiece, each beginning where the last has ended: the board answers
//         kSnapshotHeld (bytes that it holds, status); with the last one it restores its flight software. Status is a
//         fsw::Status; these numbers have 4 bytes
//   host  kGoodbye ends the run: the board stops.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "fsw/core/result.h"
#include "fsw/packets/packet.h"

namespace vbar::fsw::link {

inline constexpr std::uint8_t kProtocolVersion = 1;
inline constexpr std::size_t kFrameHeaderBytes = 14;
inline constexpr std::size_t kFrameCrcBytes = 4;
inline constexpr std::size_t kMaxFrameBytes = 1400;
/// COBS adds one byte in 254 and a leading code byte, plus the final zero.
inline constexpr std::size_t kMaxCobsFrameBytes = kMaxFrameBytes + kMaxFrameBytes / 254 + 2;
inline constexpr std::uint16_t kWindow = 32;
static_assert(packets::kMaxPacketBytes + kFrameHeaderBytes + kFrameCrcBytes <= kMaxFrameBytes);

/// Payload of a kHello without and with the rate of the receiver's line, and with that and a budget; then that of a
/// kReceiverCount.
inline constexpr std::size_t kHelloBytes = 1;
inline constexpr std::size_t kHelloWithReceiverBytes = 5;
inline constexpr std::size_t kHelloWithBudgetBytes = 13;
inline constexpr std::size_t kReceiverCountBytes = 8;

/// Payload of a kSnapshotPoll and of a kSnapshotHeld; header and largest content of a kSnapshotPiece.
inline constexpr std::size_t kSnapshotPollBytes = 4;
inline constexpr std::size_t kSnapshotHeldBytes = 8;
inline constexpr std::size_t kSnapshotPieceHeaderBytes = 8;
inline constexpr std::size_t kSnapshotPieceBytes = 1280;
static_assert(kSnapshotPieceHeaderBytes + kSnapshotPieceBytes + kFrameHeaderBytes + kFrameCrcBytes <= kMaxFrameBytes);

enum class FrameType : std::uint8_t {
  kHello = 1,
  kHelloAck = 2,
  kData = 3,
  kAck = 4,
  kPoll = 5,
  kGoodbye = 6,
  kReceiverPoll = 7,
  kReceiverCount = 8,
  kSnapshotPoll = 9,
  kSnapshotPiece = 10,
  kSnapshotHeld = 11
};

struct FrameHeader {
  FrameType type = FrameType::kHello;
  std::uint32_t session = 0;
  std::uint32_t step = 0;
  std::uint16_t index = 0;
  bool last = false;
  bool acknowledge_now = false;
};

struct FrameView {
  FrameHeader header;
  std::span<const std::uint8_t> payload;
};

/// Writes a frame (not COBS-coded); returns its length. kTooLong if `out` is too small.
Result<std::size_t> write_frame(const FrameHeader& header, std::span<const std::uint8_t> payload,
                                std::span<std::uint8_t> out);

/// Parses a frame after checks of length, CRC, version and type. kTooShort, kTooLong, kBadChecksum, kWrongType.
Result<FrameView> parse_frame(std::span<const std::uint8_t> bytes);

// Consistent Overhead Byte Stuffing (Cheshire & Baker 1999): a zero byte occurs only between frames.

/// Writes the COBS image of `data` followed by the zero delimiter; returns its length. kTooLong if `out` is too small.
Result<std::size_t> cobs_encode(std::span<const std::uint8_t> data, std::span<std::uint8_t> out);

/// Decodes a byte stream incrementally. Resynchronises at the next zero after anything malformed or oversized.
class CobsDecoder {
 public:
  /// Processes one byte. Returns true when it completes a well-formed frame, which `frame()` then returns until the
  /// next push.
  bool push(std::uint8_t byte);
  [[nodiscard]] std::span<const std::uint8_t> frame() const { return {buffer_.data(), frame_size_}; }
  /// Number of frames dropped so far: malformed (a code that runs past its zero) or oversized.
  [[nodiscard]] std::uint32_t rejected() const { return rejected_; }

 private:
  void append(std::uint8_t byte);
  void restart();
  std::array<std::uint8_t, kMaxFrameBytes> buffer_{};
  std::size_t size_ = 0;
  std::size_t frame_size_ = 0;
  std::uint8_t remaining_ = 0;     ///< literal bytes left in the current group
  bool zero_after_group_ = false;  ///< the current group ends in an implied zero
  bool in_frame_ = false;
  bool bad_ = false;
  std::uint32_t rejected_ = 0;
};

}  // namespace vbar::fsw::link
