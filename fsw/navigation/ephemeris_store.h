#pragma once
// The broadcast ephemerides delivered by the receivers: the two latest sets of each satellite, so that a new set
// does not replace the one that applies to an epoch still being processed.

#include <array>
#include <cstddef>

#include "fsw/gnss/ephemeris.h"

namespace vbar::fsw::navigation {

class EphemerisStore {
 public:
  /// Files a set. The status of gnss::check() if it is not a valid set; kOutOfRange for a satellite
  /// number outside the constellation. The same set again has no effect.
  Status put(const gnss::Ephemeris& ephemeris);

  /// The healthy set whose reference time is nearest to `time`, at most kLongestAge from it; nullptr if there is none.
  [[nodiscard]] const gnss::Ephemeris* find(gnss::SatelliteId satellite, GpsTime time) const;

  /// GPS sets are valid for two hours about their reference time, Galileo's and BeiDou's for one or more; an hour of
  /// margin, since an older set has errors of metres, which cancel in differences between two receivers.
  static constexpr Duration kLongestAge = duration_of_seconds(std::int64_t{3} * 3600);
  static constexpr std::size_t kSatellites = 32 + 36 + 63;

 private:
  struct Sets {
    std::array<gnss::Ephemeris, 2> set{};
    std::size_t count = 0;
  };
  std::array<Sets, kSatellites> satellites_{};
};

}  // namespace vbar::fsw::navigation
