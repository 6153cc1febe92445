#pragma once
// The commands that configure a NovAtel OEM628 for a run (OEM6 Family Firmware Reference Manual).

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
  fsw::GpsTime approximate_time;  ///< of the first epoch
  fsw::Vector3 approximate_position_ecef_m = fsw::Vector3::Zero();
  bool clock_adjust = true;
  double period_s = 10.0;     ///< of RANGE, BESTXYZ and TIME
  double log_offset_s = 0.0;  ///< of these in GPS time, below the period
  /// The receiver's port to which the logs go besides, "COM2"; empty: none.
  std::string board_port = {};
};

/// The rates of a port, as asked: the configured one, the factory's, the others.
[[nodiscard]] std::vector<unsigned> rates_to_ask(unsigned configured);

/// The rates are equal afterwards; the answer may come at either of the old and the new one.
[[nodiscard]] std::string rate_command(unsigned baud);

/// After a cold start and the change of the rate, in this order.
[[nodiscard]] std::vector<std::string> configuration_commands(const ReceiverConfiguration& configuration);

}  // namespace vbar::grand
