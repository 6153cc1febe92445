#pragma once
// The paper's ideal navigation: the true states of servicer and target, as a sensor.

#include <cstdint>
#include <string>

#include "host_sim/twins/packet_encoder.h"
#include "host_sim/twins/packet_source.h"

namespace vbar::twins {

class IdealNavigation final : public PacketSource {
 public:
  struct Settings {
    std::string servicer;  ///< name of the spacecraft that carries the sensor
    std::uint8_t servicer_number = 0;
    std::uint8_t unit = 0;
    std::string target;    ///< name of the observed spacecraft
    fsw::GpsTime start;    ///< first epoch
    fsw::Duration period;  ///< > 0
  };

  explicit IdealNavigation(const Settings& settings);

  [[nodiscard]] std::optional<fsw::GpsTime> next_epoch(fsw::GpsTime from) const override;

  /// Measures one ideal_navigation packet. kFailed if the truth lacks a spacecraft or holds a NaN.
  Measurement measure(const TruthSnapshot& truth) override;

 private:
  Settings settings_;
  PacketEncoder encoder_;
};

}  // namespace vbar::twins
