#pragma once
// The host's side of the step barrier, written from the text of frame.h alone (it shares no state machine with the
// board), over a fake line that spoils what it carries. Time is the number of rounds that were played.

#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <random>
#include <vector>

#include "boards/common/flight_executive.h"
#include "fsw/link/frame.h"
#include "tests/unit/boards/common/fake_gnc.h"

namespace vbar::testing {

/// One frame, uncoded.
Bytes make_frame(const fsw::link::FrameHeader& header, const Bytes& payload = {});

/// A tick packet at `time_ns`.
Bytes tick_packet(std::int64_t step, std::int64_t time_ns);

/// Chances, out of 1000, of what happens to a frame on a line.
struct Faults {
  unsigned lost = 0;
  unsigned duplicated = 0;
  unsigned bit_flipped = 0;
  unsigned byte_dropped = 0;
  unsigned delayed = 0;         ///< overtaken by frames sent later
  unsigned stale = 0;           ///< an old frame comes again, from this session or one before
  unsigned noise_inserted = 0;  ///< random bytes between frames
};

/// One direction of a serial line: frames in, bytes through, frames out.
class Line {
 public:
  Line(const Faults& faults, std::uint32_t seed) : faults_(faults), random_(seed) {}
  void send(const Bytes& frame);
  /// Frames that have arrived since the last call.
  std::vector<Bytes> receive();
  /// Malformed frames that the COBS decoder refused since the last call.
  std::uint32_t take_rejected();
  /// `frame` may come again at any time, as one that a buffer of an earlier run gives up late.
  void remember(const Bytes& frame) { past_.push_back(frame); }

 private:
  bool happens(unsigned per_mille) { return random_() % 1000 < per_mille; }
  void put(const Bytes& frame);

  Faults faults_;
  std::mt19937 random_;
  Bytes bytes_;
  std::vector<Bytes> late_;
  std::deque<Bytes> past_;
  fsw::link::CobsDecoder decoder_;
  std::uint32_t rejected_seen_ = 0;
};

/// A flight computer at the far end of two lines.
class ReferenceHost {
 public:
  ReferenceHost(boards::FlightExecutive& board, Line& to_board, Line& from_board, std::uint32_t session);
  /// Says hello until it is answered; the board's text, or nothing after too many rounds.
  std::optional<std::string> hello(std::uint8_t spacecraft);
  /// One step; the packets of the answer, report last, or nothing after too many rounds.
  std::optional<std::vector<Bytes>> step(std::uint32_t step, const std::vector<Bytes>& packets);
  [[nodiscard]] int polls() const { return polls_; }

 private:
  void send(fsw::link::FrameType type, std::uint32_t step, std::uint16_t index, const Bytes& payload = {},
            bool last = false);
  /// Lets the lines and the board work once; the host's frames of this session.
  std::vector<Bytes> play_round();

  boards::FlightExecutive& board_;
  Line& to_board_;
  Line& from_board_;
  std::uint32_t session_;
  int polls_ = 0;
};

/// A platform whose frames go into `line`.
boards::Platform platform_on(Line& line);

}  // namespace vbar::testing
