#pragma once
// Choice of the source of sACN that controls the lights, by the rules of ANSI E1.31-2018: priority (6.2.3), sequence
// (6.7.2), termination (6.2.6) and loss of a source (6.7.1). Of sources of the same priority the one that was first
// controls. Time is bench time.

#include <cstdint>
#include <span>
#include <vector>

#include "hil_drivers/tron/sacn/wire/data_packet.h"

namespace vbar::tron::bench {

struct SourceCounts {
  std::uint64_t accepted = 0;
  std::uint64_t unreadable = 0;
  std::uint64_t of_other_universes = 0;
  std::uint64_t previews = 0;
  std::uint64_t of_other_start_codes = 0;
  std::uint64_t out_of_sequence = 0;
  std::uint64_t refused_sources = 0;  ///< packets of sources beyond kMaxSources
  std::uint64_t terminations = 0;
  std::uint64_t losses = 0;  ///< sources that fell silent
};

class SourceArbiter {
 public:
  static constexpr double kLossSeconds = 2.5;
  static constexpr std::size_t kMaxSources = 16;

  explicit SourceArbiter(std::uint16_t universe) : universe_(universe) {}

  void accept(const sacn::DataPacket& packet, double bench_s);
  void count_unreadable() { ++counts_.unreadable; }
  /// Drops sources that are silent.
  void advance(double bench_s);

  /// Returns the slots of the source that controls; empty if there is none.
  [[nodiscard]] std::span<const std::uint8_t> slots() const;
  [[nodiscard]] bool is_controlled() const { return !sources_.empty(); }
  [[nodiscard]] const SourceCounts& counts() const { return counts_; }

 private:
  struct Source {
    sacn::Cid cid{};
    std::uint8_t priority = 0, sequence = 0;
    double heard_s = 0.0;
    std::vector<std::uint8_t> slots = {};
  };
  [[nodiscard]] bool is_for_us(const sacn::DataPacket& packet);

  std::uint16_t universe_;
  std::vector<Source> sources_;  ///< in the order of their first packets
  SourceCounts counts_;
};

}  // namespace vbar::tron::bench
