#pragma once
// Samples of an RF output at baseband: the GPS L1 C/A signals of RfBlocks in white noise, I and Q interleaved as 8-bit
// numbers.
//
// The carrier's phase against the generator's own oscillator is -carrier_m(t)/lambda cycles, without an offset of its
// own at the start, so that double differences between receivers are integers. Carrier and code phase are evaluated
// from the quintics of the block at every whole millisecond and are linear in between: a line of sight acceleration of
// 8 m/s^2 departs from that by a T^2/8 = 1 um. Within the millisecond they are accumulated in 64 bits.

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "emulators/grand/radio_field/rf_block.h"
#include "emulators/grand/samples/l1_ca_signal.h"
#include "host_sim/engine/random_stream.h"

namespace vbar::grand::bench {

struct BasebandSettings {
  std::int64_t rate_hz = 2'600'000;  ///< whole number of samples per ms, at least the code's bandwidth
  double noise_lsb = 20.0;           ///< standard deviation of I and of Q, least significant bits
  bool noise = true;                 ///< without it the signals keep their amplitude
};

/// Throws std::invalid_argument for invalid settings: one sentence with the setting, the value found and those
/// accepted.
void check(const BasebandSettings& settings);

class Baseband {
 public:
  /// The noise is the stream "grand/samples/<name>" of `seed`, addressed by GPS time: a block has the same noise
  /// whatever was generated before it.
  Baseband(const BasebandSettings& settings, std::shared_ptr<const twins::gnss::Constellation> constellation,
           std::uint64_t seed, const std::string& name);
  ~Baseband();
  Baseband(const Baseband&) = delete;
  Baseband& operator=(const Baseband&) = delete;

  /// Returns the samples of one block, valid until the next call. Signals other than GPS L1 are not radiated. Throws
  /// std::invalid_argument for a block that does not begin at a whole millisecond.
  std::span<const std::int8_t> samples(const RfBlock& block);

  [[nodiscard]] const BasebandSettings& settings() const { return settings_; }

 private:
  struct Tables;
  struct Chunk;
  void add_signal(const RfSignal& signal, std::int64_t begin_ms);
  void add_chunk(const Chunk& chunk);
  void add_noise_and_quantise(std::int64_t begin_ms);

  BasebandSettings settings_;
  LnavBits messages_;
  engine::RandomStream noise_;
  std::unique_ptr<Tables> tables_;
  std::size_t samples_per_ms_;
  std::vector<std::uint32_t> sums_;  ///< sums of a block: I above Q, 16 bits each
  std::vector<std::int8_t> output_;
};

}  // namespace vbar::grand::bench
