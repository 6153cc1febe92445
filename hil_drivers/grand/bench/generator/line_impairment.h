#pragma once
// Damage to the bytes of one serial line, in both directions.

#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "host_sim/engine/random_stream.h"

namespace vbar::grand::bench {

class LineImpairment {
 public:
  enum Kind : std::size_t { kGarbage, kHalfMessages, kFlood, kUnanswered, kRefuses };
  static constexpr std::size_t kKinds = 5;

  /// Random bytes come from the stream "grand/line/<name>".
  LineImpairment(std::uint64_t seed, std::string_view name);

  void set(Kind kind, bool is_on) { on_[kind] = is_on; }
  /// Number of bytes added, changed or removed so far.
  [[nodiscard]] std::uint64_t count(Kind kind) const { return counts_[kind]; }

  /// Returns the impaired bytes; called every 100 ms with the bytes that the receiver sent.
  [[nodiscard]] std::vector<std::uint8_t> to_host(std::vector<std::uint8_t> bytes);
  [[nodiscard]] std::vector<std::uint8_t> from_host(std::span<const std::uint8_t> bytes);

 private:
  [[nodiscard]] std::uint8_t random_byte() { return static_cast<std::uint8_t>(stream_.bits() >> 56U); }
  void add_random(std::vector<std::uint8_t>& bytes, std::size_t count, Kind kind);

  engine::RandomStream stream_;
  std::array<bool, kKinds> on_{};
  std::array<std::uint64_t, kKinds> counts_{};
  std::uint64_t position_ = 0;  ///< position of the next byte for the host
};

}  // namespace vbar::grand::bench
