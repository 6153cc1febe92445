#pragma once
// The motion of a spacecraft by a published orbit, as a receiver and an evaluation need it.

#include <filesystem>
#include <memory>
#include <string>

#include "fsw/orbit/earth_rotation.h"
#include "host_sim/orbit_files/orbit_file.h"
#include "host_sim/truth/earth/earth_rotation.h"
#include "host_sim/twins/gnss/receiver_bytes.h"

namespace vbar::flown_gnss {

class GivenOrbit {
 public:
  /// Reads the orbit of `object` (empty: the only one of the file). Throws std::runtime_error.
  GivenOrbit(const std::filesystem::path& orbit, const std::string& object,
             std::shared_ptr<const truth::EarthOrientationSeries> earth_orientation);

  /// Returns the body at a time of the orbit: the centre of mass at its position, axes along track, across it (in the
  /// direction of the angular momentum) and to the zenith. Throws std::out_of_range.
  [[nodiscard]] twins::gnss::BodyTruth at(fsw::GpsTime time);

  [[nodiscard]] fsw::GpsTime first() const { return file_.tracks.front().states.front().time; }
  [[nodiscard]] fsw::GpsTime last() const { return file_.tracks.back().states.back().time; }

  /// Returns the Earth orientation as it is telecommanded for the begin of the orbit.
  [[nodiscard]] fsw::orbit::EarthOrientation on_board() const;

 private:
  orbit_files::OrbitFile file_;
  std::shared_ptr<const truth::EarthOrientationSeries> series_;
  truth::EarthRotation earth_;
};

}  // namespace vbar::flown_gnss
