#pragma once
// The broadcast ephemerides that receivers have delivered: the two latest sets of each satellite, so that a new set
// does not take away the one that an epoch on its way was measured with.

#include <array>
#include <cstddef>

#include "fsw/gnss/ephemeris.h"

namespace vbar::fsw::navigation {

class EphemerisStore {
 public:
  /// Files a set. The status of gnss::check() if it is not one of a navigation satellite; kOutOfRange for a satellite
  /// number that no constellation has. The same set again changes nothing.
  Status put(const gnss::Ephemeris& ephemeris);

  /// The healthy set whose reference time is nearest to `time`, at most kLongestAge from it; nullptr if there is none.
  [[nodiscard]] const gnss::Ephemeris* find(gnss::SatelliteId satellite, GpsTime time) const;

  /// GPS sets are meant for two hours about their reference time, Galileo's and BeiDou's for one or more; an hour of
  /// grace, since a set that ages costs metres, which differences between two receivers do not see.
  static constexpr Duration kLongestAge = duration_of_seconds(3 * 3600);
  static constexpr std::size_t kSatellites = 32 + 36 + 63;

 private:
  struct Sets {
    std::array<gnss::Ephemeris, 2> set{};
    std::size_t count = 0;
  };
  std::array<Sets, kSatellites> satellites_{};
};

}  // namespace vbar::fsw::navigation
