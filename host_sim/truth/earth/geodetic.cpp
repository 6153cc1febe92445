// GeographicLib's conversion differs in the last bit, which drag carries into the truth: the output hashes of
// experiment 3 would change. The test compares this one with that library.

#include "host_sim/truth/earth/geodetic.h"

#include <cmath>

namespace vbar::truth {
namespace {

constexpr double kEquatorialRadius = 6378137.0;  // m
constexpr double kFlattening = 1.0 / 298.257223563;
constexpr double kPolarRadius = kEquatorialRadius * (1.0 - kFlattening);
constexpr double kE2 = kFlattening * (2.0 - kFlattening);                   // first eccentricity squared
constexpr double kEp2 = kE2 / ((1.0 - kFlattening) * (1.0 - kFlattening));  // second

/// An angle in the meridian, by sine and cosine.
struct Direction {
  double sin, cos;

  Direction(double rise, double run) {
    const double length = std::sqrt(rise * rise + run * run);
    sin = rise / length;
    cos = run / length;
  }
};

}  // namespace

GeodeticPosition geodetic_from_itrf(const fsw::Vector3& position_itrf) {
  const double z = position_itrf.z();
  const double axis_distance = std::hypot(position_itrf.x(), position_itrf.y());
  const double distance = std::hypot(axis_distance, z);

  // Reduced latitude, from the geocentric one for a point near the ellipsoid at first.
  Direction reduced((1.0 - kFlattening) * (1.0 + kEp2 * kPolarRadius / distance) * z, axis_distance);
  Direction latitude(0.0, 1.0);
  for (int pass = 0; pass < 2; ++pass) {
    const double sin3 = reduced.sin * reduced.sin * reduced.sin;
    const double cos3 = reduced.cos * reduced.cos * reduced.cos;
    latitude = Direction(z + kEp2 * kPolarRadius * sin3, axis_distance - kE2 * kEquatorialRadius * cos3);
    reduced = Direction((1.0 - kFlattening) * latitude.sin, latitude.cos);
  }

  GeodeticPosition geodetic;
  geodetic.latitude = std::atan2(latitude.sin, latitude.cos);
  geodetic.longitude = std::atan2(position_itrf.y(), position_itrf.x());
  geodetic.altitude = axis_distance * latitude.cos + z * latitude.sin -
                      kEquatorialRadius * std::sqrt(1.0 - kE2 * latitude.sin * latitude.sin);
  return geodetic;
}

}  // namespace vbar::truth
