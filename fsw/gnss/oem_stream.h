#pragma once
// Finds the binary messages of a NovAtel OEM6/OEM7 receiver in a stream of bytes that may contain arbitrary other data
// (OEM7 Commands and Logs Reference Manual, 1.1.3 "Binary", 1.1.6 "Binary short headers", 1.7 "32-bit CRC").
//
//   long header   AA 44 12, header length, ..., 2 bytes body length at 8; the header's own length is honoured, not 28
//   short header  AA 44 13, 1 byte body length at 3; 12 bytes
//   then the body and a CRC-32 (reflected polynomial EDB88320h, start 0, no final XOR; little-endian) over all before
//
// A sync pattern may be coincidental or the remains of a broken message. Every sync pattern opens a candidate,
// and all open candidates are followed in parallel, each with a CRC of its own: a message is reported with its last
// byte, and no false start before it can mask or delay it. The contents of a reported message are not searched for
// further messages; candidates that began before it are discarded as false. (A log that the receiver wraps in
// another, as RXCONFIG does, has its CRC complemented, so it does not disprove what wraps it.)
//
// Bounds for any input: memory is sizeof(OemStream); a byte costs at most kMaxOpenCandidates CRC steps and,
// averaged over the stream, less than one moved byte. More candidates at once do not arise by coincidence (a sync
// pattern is one in 2^23 bytes); if they do, the oldest is dropped.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace vbar::fsw::gnss {

/// Length of the longest message accepted, header, body and CRC: a RANGE of 185 signals fits, more than an OEM628 has
/// channels (120).
inline constexpr std::size_t kMaxOemMessageBytes = 8192;

/// One message with valid CRC; its contents are not checked.
struct OemMessage {
  std::uint16_t id = 0;
  bool is_response = false;      ///< answer to a command, not a log
  std::uint8_t format = 0;       ///< 0: binary. A binary header may also wrap ASCII
  std::uint8_t source = 0;       ///< 1: the receiver's second antenna. Older receivers leave other numbers in it
  std::uint8_t time_status = 0;  ///< 0 with a short header, which has none
  std::uint16_t week = 0;        ///< GPS week, counted from 1980 without rollover
  std::uint32_t time_of_week_ms = 0;
  std::span<const std::uint8_t> body;
};

struct OemStreamCounters {
  std::uint64_t bytes = 0;          ///< received
  std::uint64_t message_bytes = 0;  ///< bytes received in reported messages
  std::uint32_t messages = 0;
  std::uint32_t bad_checksum = 0;  ///< candidates that were complete and had a wrong CRC
  std::uint32_t bad_header = 0;    ///< candidates with an invalid header length
  std::uint32_t oversized = 0;     ///< candidates longer than kMaxOemMessageBytes
  std::uint32_t disproved = 0;     ///< candidates that contained a complete message
  std::uint32_t given_up = 0;      ///< candidates dropped in favour of newer ones
};

class OemStream {
 public:
  static constexpr std::size_t kMaxOpenCandidates = 16;

  /// Processes one byte. Returns true when it completes a message, which message() returns until the next push.
  [[nodiscard]] bool push(std::uint8_t byte);

  /// Returns the message that push reported; empty if it reported none.
  [[nodiscard]] OemMessage message() const;

  [[nodiscard]] const OemStreamCounters& counters() const { return counters_; }

  /// Number of bytes that belong to no message.
  [[nodiscard]] std::uint64_t skipped_bytes() const { return counters_.bytes - counters_.message_bytes - size_; }

 private:
  struct Candidate {
    std::size_t start = 0;   ///< position of its sync pattern, in buffer_
    std::size_t length = 0;  ///< length of the complete message; 0 until its header has arrived
    std::uint32_t crc = 0;   ///< CRC over the bytes so far
  };
  enum class Verdict : std::uint8_t { kOpen, kWhole, kFalse };

  Verdict evaluate(Candidate& candidate);
  Verdict read_length(Candidate& candidate);
  void report(std::size_t index);
  void open_at_sync();
  void drop_what_no_candidate_holds();
  void make_room();
  [[nodiscard]] std::size_t sync_prefix_length() const;

  // Twice the longest message: the bytes of the oldest candidate are moved to the front once per kMaxOemMessageBytes
  // bytes.
  std::array<std::uint8_t, 2 * kMaxOemMessageBytes> buffer_{};
  std::size_t size_ = 0;
  std::array<Candidate, kMaxOpenCandidates> open_{};  ///< in order of their starts
  std::size_t open_count_ = 0;
  std::size_t message_start_ = 0;
  std::size_t message_length_ = 0;
  OemStreamCounters counters_;
};

}  // namespace vbar::fsw::gnss
