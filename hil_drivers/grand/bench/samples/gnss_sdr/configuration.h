#pragma once
// Configuration of gnss-sdr (0.0.17) for a receiver in a low orbit on the samples of ../baseband.h.

#include <cstdint>
#include <filesystem>
#include <string>

#include "host_sim/twins/gnss/gnss_settings.h"

namespace vbar::grand::bench {

struct GnssSdrConfiguration {
  std::filesystem::path samples{};   ///< FIFO
  std::filesystem::path output{};    ///< directory of its files
  std::int64_t rate_hz = 2'600'000;  ///< rate of the samples
  int channels = 10;
  int observable_interval_ms = 20;
  bool rinex = false;                 ///< observations once a second
  std::uint16_t monitor_port = 0;     ///< UDP on 127.0.0.1, observables; 0: none
  std::uint16_t navigation_port = 0;  ///< UDP on 127.0.0.1, subframes; 0: none
};

/// Returns the text of the file.
std::string text_of(const GnssSdrConfiguration& configuration);

/// Loops of that configuration once bits are synchronised, for the formulas of signal_noise. gnss-sdr's correlators are
/// a quarter of a chip apart, 2.5 times the spacing that those formulas assume for L1: the bandwidth is larger by this
/// factor.
inline constexpr twins::gnss::TrackingSettings kGnssSdrTracking{
    .code_loop_bandwidth_hz = 0.5 * 2.5, .carrier_loop_bandwidth_hz = 15.0, .integration_s = 0.010};

}  // namespace vbar::grand::bench
