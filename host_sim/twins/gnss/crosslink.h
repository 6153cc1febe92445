#pragma once
// The radio between two spacecraft: carries whole messages of bytes, late or not at all.

#include <cstdint>
#include <map>
#include <optional>
#include <string_view>
#include <vector>

#include "fsw/core/gps_time.h"
#include "host_sim/engine/link_model.h"

namespace vbar::twins::gnss {

/// Beside the link's own settings: a silence, during which nothing that is sent arrives.
struct CrosslinkSettings {
  engine::LinkSettings link{.latency = {.kind = engine::LatencyKind::kUniform, .minimum_s = 0.05, .maximum_s = 0.5},
                            .loss_probability = 0.0};
  double silence_begin_s = 0.0;     ///< after the first message
  double silence_duration_s = 0.0;  ///< 0: none
  friend bool operator==(const CrosslinkSettings&, const CrosslinkSettings&) = default;
};

/// Throws std::invalid_argument: the setting, what was found, what is accepted.
void check(const CrosslinkSettings& settings);

/// A message that arrives.
struct CrosslinkDelivery {
  fsw::GpsTime sent;
  fsw::GpsTime arrival;
  std::vector<std::uint8_t> bytes;
};

class Crosslink {
 public:
  /// Draws from the stream "crosslink/<name>" of `seed`. Throws as check().
  Crosslink(const CrosslinkSettings& settings, std::uint64_t seed, std::string_view name);

  /// Sends one message; times must not go back. Messages may overtake one another. Returns when it will arrive, or
  /// nothing if it never will.
  std::optional<fsw::GpsTime> send(fsw::GpsTime now, std::vector<std::uint8_t> bytes);

  /// Takes what has arrived by `now`, in order of arrival (of sending, where two arrive at once).
  std::vector<CrosslinkDelivery> take_arrived(fsw::GpsTime now);

  [[nodiscard]] const engine::LinkCounters& counters() const { return counters_; }

 private:
  [[nodiscard]] bool silent(fsw::GpsTime now) const;

  CrosslinkSettings settings_;
  engine::LinkModel link_;
  engine::LinkCounters counters_;  ///< silence counted as loss
  std::optional<fsw::GpsTime> first_;
  std::multimap<fsw::GpsTime, CrosslinkDelivery> under_way_;
};

}  // namespace vbar::twins::gnss
