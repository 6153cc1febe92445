#include "hil_drivers/grand/bench/generator/line_impairment.h"

#include <string>

namespace vbar::grand::bench {
namespace {

constexpr std::uint64_t kRun = 200;               ///< bytes of a message that pass, then as many that are missing
constexpr std::size_t kGarbageBytes = 40;         ///< added every 100 ms
constexpr double kGarbageProbability = 0.01;      ///< probability that a byte is replaced
constexpr std::size_t kFloodBytes = 20'000;       ///< every 100 ms
constexpr double kSyncProbability = 1.0 / 300.0;  ///< probability of a sync pattern in random bytes

}  // namespace

LineImpairment::LineImpairment(std::uint64_t seed, std::string_view name)
    : stream_(seed, "grand/line/" + std::string(name)) {}

std::vector<std::uint8_t> LineImpairment::to_host(std::vector<std::uint8_t> bytes) {
  if (on_[kGarbage]) {
    for (std::uint8_t& byte : bytes) {
      if (stream_.uniform() >= kGarbageProbability) continue;
      byte = random_byte();
      ++counts_[kGarbage];
    }
    add_random(bytes, kGarbageBytes, kGarbage);
  }
  if (on_[kHalfMessages]) {
    std::vector<std::uint8_t> passed;
    for (const std::uint8_t byte : bytes) {
      if (position_++ / kRun % 2 == 0)
        passed.push_back(byte);
      else
        ++counts_[kHalfMessages];
    }
    bytes = std::move(passed);
  }
  if (on_[kFlood]) add_random(bytes, kFloodBytes, kFlood);
  return bytes;
}

std::vector<std::uint8_t> LineImpairment::from_host(std::span<const std::uint8_t> bytes) {
  std::vector<std::uint8_t> heard(bytes.begin(), bytes.end());
  if (on_[kRefuses]) {
    // Letters of the next alphabet: lines keep their ends, binary commands lose their check sum.
    for (std::uint8_t& byte : heard) {
      if (byte < 0x40U) continue;
      byte ^= 0x15U;
      ++counts_[kRefuses];
    }
  }
  if (on_[kUnanswered]) {
    counts_[kUnanswered] += heard.size();
    heard.clear();
  }
  return heard;
}

// Beginnings of binary messages are among them, so that a decoder has something to reject.
void LineImpairment::add_random(std::vector<std::uint8_t>& bytes, std::size_t count, Kind kind) {
  while (count > 0) {
    const bool sync = count >= 4 && stream_.uniform() < kSyncProbability;
    if (sync) {
      for (const std::uint8_t byte : {0xAA, 0x44, 0x12, 0x1C}) bytes.push_back(byte);
      count -= 4;
      counts_[kind] += 4;
      continue;
    }
    bytes.push_back(random_byte());
    --count;
    ++counts_[kind];
  }
}

}  // namespace vbar::grand::bench
