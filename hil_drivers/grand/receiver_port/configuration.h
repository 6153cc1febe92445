#pragma once
// Commands that configure a NovAtel OEM628 for a run (OEM6 Family Firmware Reference Manual).

#include <optional>
#include <string>
#include <vector>

#include "fsw/core/gps_time.h"
#include "fsw/core/types.h"
#include "host_sim/twins/gnss/gnss_settings.h"

namespace vbar::grand {

struct ReceiverConfiguration {
  unsigned baud = 115200;
  twins::gnss::StartMode start = twins::gnss::StartMode::kWarm;
  fsw::GpsTime approximate_time;  ///< time of the first epoch
  fsw::Vector3 approximate_position_ecef_m = fsw::Vector3::Zero();
  bool clock_adjust = true;
  double period_s = 10.0;     ///< period of RANGE, BESTXYZ and TIME
  double log_offset_s = 0.0;  ///< offset of these logs in GPS time, below the period
  /// Receiver's second port to which the logs go, "COM2"; empty: none.
  std::string board_port = {};
};

/// Returns the rates of a port in the order of search: the configured one, the factory's, the others.
[[nodiscard]] std::vector<unsigned> rates_to_ask(unsigned configured);

/// Returns the command that changes the rate; the answer may come at the old or the new rate.
[[nodiscard]] std::string rate_command(unsigned baud);

/// Returns the commands after a cold start and the change of the rate, in this order.
[[nodiscard]] std::vector<std::string> configuration_commands(const ReceiverConfiguration& configuration);

}  // namespace vbar::grand
