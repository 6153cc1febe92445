#pragma once
// Knowledge of the ground about the target's orbit when a flight computer has lost its state: the relative orbit that
// its telemetry reported last. It takes the place of the a-priori orbit among the telecommands of the start, which may
// be older than a day.

#include <optional>
#include <span>
#include <vector>

#include "fsw/core/gps_time.h"
#include "fsw/packets/messages.h"
#include "pil_bridge/flight_computer.h"

namespace vbar::faults {

/// Oldest relative orbit that is sent, as mean ROE are valid for ten minutes in the flight software.
inline constexpr fsw::Duration kOldestReport = fsw::duration_of_seconds(540);

class ReportedOrbit {
 public:
  /// Packets from the flight software; the last valid estimate of a source that measures is kept.
  void take(std::span<const pil::Packet> packets);

  /// The telecommands with a target_apriori that states the relative orbit reported last. Unchanged without
  /// target_apriori among them, and if no report is younger than kOldestReport at `now`.
  [[nodiscard]] std::vector<pil::Packet> applied_to(std::vector<pil::Packet> telecommands, fsw::GpsTime now) const;

 private:
  struct Report {
    fsw::GpsTime time;
    vbar::telemetry_navigation navigation;
  };
  std::optional<Report> last_;
};

/// Mean ROE times a with 1 sigma, of a reported estimate; nothing if the servicer's state is not an orbit. Telemetry
/// has the sigmas of position and velocity without their correlation: those of the ROE are their linear map with the
/// magnitudes of all terms added, an upper bound.
[[nodiscard]] std::optional<vbar::target_apriori> apriori_of(const vbar::telemetry_navigation& reported);

}  // namespace vbar::faults
