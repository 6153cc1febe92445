#include "emulators/grand/receiver/serial_line.h"

#include <algorithm>
#include <utility>

namespace vbar::grand::bench {
namespace {

constexpr std::int64_t kBitsPerByte = 10;

/// Time of `count` bytes; rounded up to a nanosecond.
std::int64_t line_time_ns(std::size_t count, unsigned baud) {
  const std::int64_t bit_ns = static_cast<std::int64_t>(count) * kBitsPerByte * 1'000'000'000;
  return (bit_ns + baud - 1) / baud;
}

/// Bytes that have passed completely after `elapsed_ns`.
std::size_t bytes_passed(std::int64_t elapsed_ns, unsigned baud, std::size_t most) {
  if (elapsed_ns <= 0) return 0;
  const std::int64_t all_ns = line_time_ns(most, baud);
  if (elapsed_ns >= all_ns) return most;
  return static_cast<std::size_t>(elapsed_ns * baud / (kBitsPerByte * 1'000'000'000));
}

}  // namespace

SerialLine::SerialLine(unsigned baud, int buffer_bytes, engine::RandomStream garbage)
    : baud_(baud), buffer_bytes_(static_cast<std::size_t>(buffer_bytes)), garbage_(garbage) {}

std::size_t SerialLine::waiting_at(std::int64_t ns) const {
  std::size_t waiting = 0;
  for (const Message& message : queue_)
    waiting += message.bytes.size() - bytes_passed(ns - message.begin_ns, message.baud, message.bytes.size());
  return waiting;
}

bool SerialLine::queue(std::span<const std::uint8_t> message, std::int64_t ready_ns) {
  if (message.empty()) return true;
  if (waiting_at(ready_ns) + message.size() > buffer_bytes_) return false;
  forget_unheard(ready_ns);
  const std::int64_t begin_ns = std::max(ready_ns, free_ns_);
  queue_.push_back({{message.begin(), message.end()}, 0, begin_ns, baud_});
  free_ns_ = begin_ns + line_time_ns(message.size(), baud_);
  return true;
}

// Without a listener the bytes that have left are lost.
void SerialLine::forget_unheard(std::int64_t ns) {
  constexpr std::size_t kMaxUnheard = 4096;
  while (queue_.size() > kMaxUnheard) {
    const Message& oldest = queue_.front();
    if (bytes_passed(ns - oldest.begin_ns, oldest.baud, oldest.bytes.size()) < oldest.bytes.size()) return;
    queue_.pop_front();
  }
}

void SerialLine::clear() {
  queue_.clear();
  free_ns_ = 0;
}

Bytes SerialLine::take(std::int64_t now_ns, unsigned host_baud) {
  Bytes taken;
  while (!queue_.empty()) {
    Message& message = queue_.front();
    const std::size_t passed = bytes_passed(now_ns - message.begin_ns, message.baud, message.bytes.size());
    const std::span<const std::uint8_t> sent = std::span(message.bytes).subspan(message.left, passed - message.left);
    if (host_baud == 0 || host_baud == message.baud) {
      taken.insert(taken.end(), sent.begin(), sent.end());
    } else {
      const Bytes heard = garbage(sent, message.baud, host_baud);
      taken.insert(taken.end(), heard.begin(), heard.end());
    }
    message.left = passed;
    if (passed < message.bytes.size()) break;
    queue_.pop_front();
  }
  return taken;
}

Bytes SerialLine::garbage(std::span<const std::uint8_t> bytes, unsigned sent_baud, unsigned heard_baud) {
  const std::uint64_t count =
      std::min<std::uint64_t>(static_cast<std::uint64_t>(bytes.size()) * heard_baud / std::max(1U, sent_baud),
                              4 * static_cast<std::uint64_t>(bytes.size()));
  Bytes heard(std::max<std::uint64_t>(count, bytes.empty() ? 0 : 1));
  for (std::uint8_t& byte : heard) byte = static_cast<std::uint8_t>(garbage_.bits() >> 56U);
  return heard;
}

}  // namespace vbar::grand::bench
