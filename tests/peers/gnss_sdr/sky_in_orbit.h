#pragma once
// What the RF outputs of a generator radiate for antennas on the test orbit (tests/support/gnss_scene.h): the digital
// twin's path, ionosphere, clock errors and power of GPS L1, with quintics through six points of each 100 ms.

#include <memory>

#include "emulators/grand/radio_field/rf_block.h"
#include "fsw/core/types.h"
#include "host_sim/twins/gnss/constellation.h"
#include "host_sim/twins/gnss/gnss_settings.h"
#include "host_sim/twins/gnss/tracking.h"

namespace vbar::test {

class SkyInOrbit {
 public:
  explicit SkyInOrbit(std::shared_ptr<const twins::gnss::Constellation> constellation,
                      const fsw::Vector3& offset_rtn_m);

  /// The block that begins number * 100 ms after kGnssStart.
  grand::bench::RfBlock block(int number);

  /// The antenna, ECEF.
  [[nodiscard]] fsw::Vector3 antenna_ecef(double t_s) const;

 private:
  struct Ranges {
    double carrier_m = 0.0, code_m = 0.0, cn0_dbhz = 0.0;
    bool visible = false;
  };
  [[nodiscard]] Ranges ranges(std::size_t index, double t_s) const;

  std::shared_ptr<const twins::gnss::Constellation> constellation_;
  fsw::Vector3 offset_rtn_m_;
  twins::gnss::GnssReceiverSettings settings_;
  twins::gnss::AntennaPattern pattern_;
};

}  // namespace vbar::test
