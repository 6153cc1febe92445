#pragma once
// The radio between two spacecraft: whole messages arrive late or not at all.

#include <cstdint>
#include <optional>
#include <string_view>

#include "fsw/core/gps_time.h"
#include "host_sim/engine/link_model.h"

namespace vbar::twins::gnss {

/// Settings of the link and an interruption, during which no message arrives.
struct CrosslinkSettings {
  engine::LinkSettings link{.latency = {.kind = engine::LatencyKind::kUniform, .minimum_s = 0.05, .maximum_s = 0.5},
                            .loss_probability = 0.0};
  double silence_begin_s = 0.0;     ///< after the first message
  double silence_duration_s = 0.0;  ///< 0: none
  friend bool operator==(const CrosslinkSettings&, const CrosslinkSettings&) = default;
};

/// Throws std::invalid_argument: the setting, what was found, what is accepted.
void check(const CrosslinkSettings& settings);

class Crosslink {
 public:
  /// Draws from the stream "crosslink/<name>" of `seed`. Throws as check().
  Crosslink(const CrosslinkSettings& settings, std::uint64_t seed, std::string_view name);

  /// Sends one message; times must not decrease. Returns the time of its arrival, complete, or nothing if it is lost.
  /// Messages may overtake one another. The caller keeps them until then.
  std::optional<fsw::GpsTime> send(fsw::GpsTime now);

  [[nodiscard]] const engine::LinkCounters& counters() const { return counters_; }

 private:
  [[nodiscard]] bool silent(fsw::GpsTime now) const;

  CrosslinkSettings settings_;
  engine::LinkModel link_;
  engine::LinkCounters counters_;  ///< silence counted as loss
  std::optional<fsw::GpsTime> first_;
};

}  // namespace vbar::twins::gnss
